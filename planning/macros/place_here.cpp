// place_here: what the gripper holds is set down on a point.
#include <cmath>

#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"
#include "planning/macros/tool_directions.h"
#include "planning/macros/tool_shape.h"

namespace longarm::planning {
namespace {

constexpr double kTurnStep = M_PI / 12;
constexpr double kLeanStep = 20 * M_PI / 180;

class PlaceHere final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"place_here", "Place Here", "Lowers what the gripper holds straight down onto the marked point, as upright as it is held now.",
            vision::FeatureKind::kPoint,
            {standOffParameter(0.10),
             {"gap", "m", 0.006, 0, 0.1, "Left between the point and what is held when it is let go."},
             {"max_lean", "rad", 0, 0, 1.5708, "How far it may be leant away from how it is held now when it must."},
             approachSpeedParameter(0.03)},
            0.01,
            true};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const Eigen::Vector3d up = setup.run.up();
    const double below = heldBelow(setup.run.context(), -up);
    const Eigen::Vector3d end = setup.feature.points[0] + (below + setup.arguments["gap"]) * up;
    TaskPart part;
    // Turning about the vertical keeps it as upright as it is; leaning only when it is allowed.
    for (const double lean : anglesAround(setup.arguments["max_lean"], kLeanStep)) {
      for (const double turn : anglesAround(M_PI, kTurnStep)) {
        const Eigen::Matrix3d leant = Eigen::AngleAxisd(lean, setup.X_RT.linear().col(1)).toRotationMatrix() * setup.X_RT.linear();
        ToolTask task;
        task.X_entry = poseAt(end + setup.arguments["stand_off"] * up, Eigen::AngleAxisd(turn, up).toRotationMatrix() * leant);
        ToolPath path(task.X_entry);
        path.lineTo(end);
        task.stages.push_back({"lower", path, setup.arguments["approach_speed"], true, false});
        task.preference = static_cast<int>(std::lround(std::abs(lean) / kLeanStep));
        task.note = below > 0 ? "Open the gripper at its end, then back up." : "Nothing is known to be held: the tool point itself is brought there.";
        part.tasks.push_back(std::move(task));
      }
    }
    setup.job.parts.push_back(std::move(part));
    return {};
  }
};

}  // namespace

std::unique_ptr<Macro> makePlaceHere() { return std::make_unique<PlaceHere>(); }

}  // namespace longarm::planning
