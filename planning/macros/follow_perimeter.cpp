// follow_perimeter: round the edge of a surface.
#include <algorithm>
#include <array>

#include "core/text.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"

namespace longarm::planning {
namespace {

constexpr double kLeastSide = 0.01;      // of what the inset leaves [m]
constexpr double kWidestBlend = 0.45;    // share of the shorter side

class FollowPerimeter final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"follow_perimeter", "Follow Perimeter", "Goes round the marked surface along its edge, with rounded corners.",
            vision::FeatureKind::kPlane,
            {{"inset", "m", 0.02, -0.2, 0.5, "How far inside the edge; negative is outside."},
             {"blend", "m", 0.02, 0.004, 0.5, "Radius of the corners."},
             {"laps", "choice", 1, 1, 20, "How many times round."},
             {"stand_off", "m", 0.06, 0.005, 1, "Between the tool point and the surface."},
             travelSpeedParameter(0.05),
             {"roll_free", "choice", 1, 0, 1, "1: the tool may turn about its own axis; 0: its x stays along the first edge.", {"held", "free"}}},
            0.008};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto patch = planePatchFrom(setup.feature, setup.eye);
    if (!patch) return patch.error();
    const double inset = setup.arguments["inset"];
    const double width = patch->width - 2 * inset, height = patch->height - 2 * inset;
    if (std::min(width, height) < kLeastSide) {
      return {ErrorCode::kOutOfLimits, "an inset of " + formatFixed(inset * 1e3, 0) + " mm leaves " +
                                           formatFixed(std::min(width, height) * 1e3, 0) + " mm of the surface; 10 mm are needed"};
    }
    TaskPart part;
    for (const bool reversed : {false, true}) {
      ToolTask task;
      const ToolPath path = around(setup, *patch, width, height, reversed);
      task.X_entry = path.start();
      task.stages.push_back({"scan", path, setup.arguments["speed"], false, false});
      task.roll_free = setup.arguments.is("roll_free");
      task.preference = reversed ? 1 : 0;
      part.tasks.push_back(std::move(task));
    }
    setup.job.obstacles.push_back(patch->slab(setup.feature.name));
    setup.measure = [length = part.tasks.front().stages.front().path.length()](const ArmSpace&, Plan& plan) { plan.figures["length"] = length; };
    setup.job.parts.push_back(std::move(part));
    return {};
  }

 private:
  // From the middle of the first edge round all four, or the other way round.
  static ToolPath around(const MacroSetup& setup, const PlanePatch& patch, double width, double height, bool reversed) {
    const double blend = std::min(setup.arguments["blend"], kWidestBlend * std::min(width, height));
    const Eigen::Vector3d u = reversed ? Eigen::Vector3d(-patch.u) : patch.u, v = patch.v;
    const std::array<Eigen::Vector3d, 4> ways{u, v, -u, -v};
    const std::array<double, 4> sides{width, height, width, height};
    const Eigen::Vector3d start = patch.center() - 0.5 * height * v + setup.arguments["stand_off"] * patch.normal;
    ToolPath path(poseAt(start, toolRotation(-patch.normal, patch.u)));
    for (int side = 0; side < 4 * setup.arguments.choice("laps"); ++side) {
      const auto now = static_cast<std::size_t>(side % 4), next = static_cast<std::size_t>((side + 1) % 4);
      const double straight = now == 0 ? 0.5 * width - blend : sides[now] - 2 * blend;
      path.lineTo(Eigen::Vector3d(path.end().translation() + straight * ways[now]));
      path.arc(path.end().translation() + blend * ways[next], ways[now].cross(ways[next]), M_PI / 2, false);
      if (next == 0) path.lineTo(Eigen::Vector3d(path.end().translation() + (0.5 * width - blend) * ways[0]));
    }
    return path;
  }
};

}  // namespace

std::unique_ptr<Macro> makeFollowPerimeter() { return std::make_unique<FollowPerimeter>(); }

}  // namespace longarm::planning
