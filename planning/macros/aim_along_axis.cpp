// aim_along_axis: the tool points along a line from before one of its ends.
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"

namespace longarm::planning {
namespace {

constexpr double kThick = 0.01;          // radius of the line as an obstacle [m]

class AimAlongAxis final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"aim_along_axis", "Aim Along Axis", "Points the tool along the marked line from before one of its ends.",
            vision::FeatureKind::kLine,
            {{"stand_off", "m", 0.20, 0.01, 2, "Between the tool point and the end of the line."},
             {"end", "choice", 0, 0, 2, "0: whichever end can be reached, 1: the first, 2: the second.", {"either", "first", "second"}}},
            0.01};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto line = axisLineFrom(setup.feature);
    if (!line) return line.error();
    WorldObject body;
    body.name = setup.feature.name;
    body.shape = Cylinder{kThick, line->length};
    body.X_WO = poseAt(line->middle(), rotationWithZ(line->direction));
    setup.job.obstacles.push_back(body);
    const int end = setup.arguments.choice("end");
    TaskPart part;
    for (const bool second : {false, true}) {
      if (end != 0 && second != (end == 2)) continue;
      const Eigen::Vector3d z = second ? Eigen::Vector3d(-line->direction) : line->direction;
      ToolTask task;
      task.X_entry = poseAt((second ? line->second : line->first) - setup.arguments["stand_off"] * z,
                            toolRotation(z, setup.X_RT.linear().col(0)));
      task.roll_free = true;
      if (end == 0) task.note = second ? "Aims from the second end of the line." : "Aims from the first end of the line.";
      part.tasks.push_back(std::move(task));
    }
    setup.job.parts.push_back(std::move(part));
    return {};
  }
};

}  // namespace

std::unique_ptr<Macro> makeAimAlongAxis() { return std::make_unique<AimAlongAxis>(); }

}  // namespace longarm::planning
