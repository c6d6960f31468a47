// touch: the tool goes to a point, the last part straight.
#include "core/text.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"
#include "planning/macros/tool_directions.h"
#include "planning/macros/tool_shape.h"

namespace longarm::planning {
namespace {

constexpr double kMostTilt = 75 * M_PI / 180;
constexpr double kNear = 0.02;           // bodies that near the point may be touched [m]

class Touch final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"touch", "Touch", "Brings the tool point to the marked point, straight for the last part.", vision::FeatureKind::kPoint,
            {standOffParameter(0.10),
             {"gap", "m", 0, -0.02, 0.2, "Left between the tool point and the point; negative presses."},
             {"from", "choice", 0, 0, 2, "Side to come from: 0 the arm's, 1 above, 2 level from the arm's side.", {"arm's side", "above", "level"}},
             approachSpeedParameter(0.02)},
            0.006,
            true};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const Eigen::Vector3d p = setup.feature.points[0];
    setup.job.touchable = objectsNear(setup.run.context(), p, kNear);
    const double overhang = toolOverhang(setup.run.workcell(), setup.run.context().start);
    TaskPart part;
    for (const auto& direction : directionsAround(wanted(setup, p), kMostTilt)) {
      part.tasks.push_back(taskTo(setup, direction, setup.arguments["gap"], false));
      if (setup.job.touchable.empty()) continue;
      // The point lies on a known body: then it is the gripper's ends that touch it.
      ToolTask on_body = taskTo(setup, direction, setup.arguments["gap"] + overhang, true);
      if (overhang > 1e-3) {
        on_body.note = "The gripper's ends touch first: the tool point stops " + formatFixed(overhang * 1e3, 1) + " mm before the point.";
      }
      part.tasks.push_back(std::move(on_body));
    }
    setup.job.parts.push_back(std::move(part));
    return {};
  }

 private:
  static Eigen::Vector3d wanted(const MacroSetup& setup, const Eigen::Vector3d& p) {
    Eigen::Vector3d reach = p - setup.reach.shoulder;
    const int from = setup.arguments.choice("from");
    const Eigen::Vector3d up = setup.run.up();
    if (from == 2) reach -= reach.dot(up) * up;
    if (from == 1 || reach.norm() < 1e-3) return -up;
    return reach.normalized();
  }

  static ToolTask taskTo(const MacroSetup& setup, const ToolDirection& direction, double gap, bool on_body) {
    const Eigen::Vector3d end = setup.feature.points[0] - gap * direction.z;
    const Eigen::Matrix3d R = toolRotation(direction.z, setup.X_RT.linear().col(0));
    ToolTask task;
    task.X_entry = poseAt(end - setup.arguments["stand_off"] * direction.z, R);
    ToolPath path(task.X_entry);
    path.lineTo(end);
    task.stages.push_back({"approach", path, setup.arguments["approach_speed"], true, on_body});
    task.preference = 2 * direction.ring + (on_body ? 1 : 0);
    task.roll_free = true;
    return task;
  }
};

}  // namespace

std::unique_ptr<Macro> makeTouch() { return std::make_unique<Touch>(); }

}  // namespace longarm::planning
