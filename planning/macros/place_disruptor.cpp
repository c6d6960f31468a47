// place_disruptor: the tool directly in front of a package whose lower front edge is marked.
#include <cmath>

#include "core/text.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"

namespace longarm::planning {
namespace {

constexpr double kSteepest = 0.5;        // sine of the line's slope: 30 degrees
constexpr double kPlate = 0.02;          // thickness of the front as an obstacle [m]

class PlaceDisruptor final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"place_disruptor", "Place Disruptor",
            "Places the tool in front of a package and aims it at the front; the marked line is the front's lower edge.",
            vision::FeatureKind::kLine,
            {{"stand_off", "m", 0.10, 0.02, 1, "Between the tool point and the front when it stands."},
             {"height", "m", 0.08, 0, 1, "Of the place aimed at over the lower edge."},
             {"elevation", "rad", 0, -1.2, 1.2, "Of the aim: positive aims upwards."},
             {"approach", "m", 0.10, 0.02, 0.5, "Length of the straight approach."},
             approachSpeedParameter()},
            0.01,
            true};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto line = axisLineFrom(setup.feature);
    if (!line) return line.error();
    const Eigen::Vector3d vertical = setup.run.up();
    const double slope = std::abs(line->direction.dot(vertical));
    if (slope > kSteepest) {
      return {ErrorCode::kDegenerate, "the line slopes by " + formatFixed(std::asin(slope) * 180 / M_PI, 0) +
                                          " deg; the lower edge of a package lies within 30 deg of level"};
    }
    Eigen::Vector3d outward = line->direction.cross(vertical).normalized();
    if (outward.dot(setup.reach.shoulder - line->middle()) < 0) outward = -outward;
    const Eigen::Vector3d up = (line->direction.cross(outward).dot(vertical) > 0 ? 1 : -1) * line->direction.cross(outward);
    const Eigen::Vector3d target = line->middle() + setup.arguments["height"] * up;
    addFront(setup, *line, outward, up);
    const double e = setup.arguments["elevation"];
    const Eigen::Vector3d z = -std::cos(e) * outward + std::sin(e) * up;
    ToolTask task;
    const Eigen::Vector3d end = target - setup.arguments["stand_off"] * z;
    task.X_entry = poseAt(end - setup.arguments["approach"] * z, toolRotation(z, setup.X_RT.linear().col(0)));
    ToolPath path(task.X_entry);
    path.lineTo(end);
    task.stages.push_back({"approach", path, setup.arguments["approach_speed"], true, false});
    task.roll_free = true;
    TaskPart part;
    part.tasks.push_back(std::move(task));
    setup.job.parts.push_back(std::move(part));
    setup.job.place = end;
    return {};
  }

 private:
  // The front as far as the aim and as much again, which nobody has measured further.
  static void addFront(MacroSetup& setup, const AxisLine& line, const Eigen::Vector3d& outward, const Eigen::Vector3d& up) {
    const double height = std::max(2 * setup.arguments["height"], 0.05);
    WorldObject front;
    front.name = setup.feature.name;
    front.shape = Box{{line.length, height, kPlate}};
    front.X_WO = poseAt(line.middle() + 0.5 * height * up - 0.5 * kPlate * outward, toolRotation(outward, line.direction));
    setup.job.obstacles.push_back(front);
  }
};

}  // namespace

std::unique_ptr<Macro> makePlaceDisruptor() { return std::make_unique<PlaceDisruptor>(); }

}  // namespace longarm::planning
