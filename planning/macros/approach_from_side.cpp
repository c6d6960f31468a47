// approach_from_side: to the middle of a line, level and square to it.
#include <cmath>

#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"
#include "planning/macros/tool_directions.h"
#include "planning/macros/tool_shape.h"

namespace longarm::planning {
namespace {

constexpr double kStep = 7.5 * M_PI / 180;
constexpr double kMost = 60 * M_PI / 180;
constexpr double kAllowance = 0.005;     // on the radius as an obstacle [m]

class ApproachFromSide final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"approach_from_side", "Approach From Side",
            "Brings the open gripper to the middle of the marked line from the arm's side, square to it.", vision::FeatureKind::kLine,
            {standOffParameter(0.10),
             {"gap", "m", 0, 0, 0.3, "Left between the tool point and the line."},
             {"radius", "m", 0.02, 0.001, 0.045, "Of what the line runs through, as an obstacle."},
             approachSpeedParameter()},
            0.02,
            true};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto line = axisLineFrom(setup.feature);
    if (!line) return line.error();
    WorldObject body;
    body.name = setup.feature.name;
    body.shape = Cylinder{setup.arguments["radius"] + kAllowance, line->length + 2 * kAllowance};
    body.X_WO = poseAt(line->middle(), rotationWithZ(line->direction));
    setup.job.obstacles.push_back(body);
    setup.job.touchable = objectsThrough(setup.run.context(), line->middle());
    setup.job.touchable.push_back(body.name);
    setup.job.open_gripper = true;
    TaskPart part;
    for (const auto& side : sides(*line, setup.reach.shoulder, setup.run.up())) {
      for (const double angle : anglesAround(kMost, kStep)) {
        const Eigen::Vector3d z = Eigen::AngleAxisd(angle, line->direction) * side;
        for (const double sign : {1.0, -1.0}) part.tasks.push_back(taskFrom(setup, *line, z, sign, angle));
      }
    }
    setup.job.parts.push_back(std::move(part));
    return {};
  }

 private:
  // Level directions to come along, square to the line: the arm's side, or both sides of a line that points at the arm.
  static std::vector<Eigen::Vector3d> sides(const AxisLine& line, const Eigen::Vector3d& shoulder, const Eigen::Vector3d& up) {
    Eigen::Vector3d view = line.middle() - shoulder;
    view -= view.dot(up) * up;
    const Eigen::Vector3d square = view - view.dot(line.direction) * line.direction;
    if (square.norm() > 0.3 * view.norm() && square.norm() > 1e-3) return {square.normalized()};
    Eigen::Vector3d across = line.direction.cross(up);
    if (across.norm() < 1e-3) across = Eigen::Vector3d::UnitY();
    return {across.normalized(), -across.normalized()};
  }

  static ToolTask taskFrom(const MacroSetup& setup, const AxisLine& line, const Eigen::Vector3d& z, double sign, double angle) {
    const Eigen::Vector3d end = line.middle() - setup.arguments["gap"] * z;
    ToolTask task;
    task.X_entry = poseAt(end - setup.arguments["stand_off"] * z, toolRotation(z, sign * line.direction));
    ToolPath path(task.X_entry);
    path.lineTo(end);
    task.stages.push_back({"approach", path, setup.arguments["approach_speed"], true, true});
    task.preference = static_cast<int>(std::lround(std::abs(angle) / kStep));
    return task;
  }
};

}  // namespace

std::unique_ptr<Macro> makeApproachFromSide() { return std::make_unique<ApproachFromSide>(); }

}  // namespace longarm::planning
