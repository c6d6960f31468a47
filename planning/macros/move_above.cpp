// move_above: the tool stands over a point, against gravity.
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"
#include "planning/macros/tool_directions.h"

namespace longarm::planning {
namespace {

class MoveAbove final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"move_above", "Move Above", "Holds the tool over the marked point, pointing down.", vision::FeatureKind::kPoint,
            {{"height", "m", 0.15, 0.02, 1, "Of the tool point over the point."},
             {"max_tilt", "rad", 0.5236, 0, 1.5708, "How far the tool may lean from straight down when it must."}},
            0.02,
            true};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const Eigen::Vector3d up = setup.run.up();
    TaskPart part;
    for (const auto& direction : directionsAround(-up, setup.arguments["max_tilt"])) {
      ToolTask task;
      task.X_entry = poseAt(setup.feature.points[0] + setup.arguments["height"] * up,
                            toolRotation(direction.z, setup.X_RT.linear().col(0)));
      task.preference = direction.ring;
      task.roll_free = true;
      part.tasks.push_back(std::move(task));
    }
    setup.job.parts.push_back(std::move(part));
    return {};
  }
};

}  // namespace

std::unique_ptr<Macro> makeMoveAbove() { return std::make_unique<MoveAbove>(); }

}  // namespace longarm::planning
