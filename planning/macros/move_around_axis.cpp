// move_around_axis: from the present grip along an arc about a line, as a door or a lever goes.
#include <cmath>

#include "core/text.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"

namespace longarm::planning {
namespace {

constexpr double kLeast = 0.01;          // [rad]

class MoveAroundAxis final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"move_around_axis", "Move Around Axis",
            "Turns what is gripped about the marked line, right-handed from its first to its second end: door, lid, valve, lever.",
            vision::FeatureKind::kLine,
            {{"angle", "rad", 0.7854, -6.2832, 6.2832, "How far to turn; negative is left-handed."},
             {"turn_tool", "choice", 1, 0, 1, "1: the grip turns with it; 0: the tool keeps its direction and the handle turns in it.", {"no", "yes"}},
             travelSpeedParameter(0.10)},
            0.006};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto line = axisLineFrom(setup.feature);
    if (!line) return line.error();
    const double angle = setup.arguments["angle"];
    if (std::abs(angle) < kLeast) return {ErrorCode::kOutOfLimits, "the angle is " + formatNumber(angle) + " rad; at least 0.01 rad is needed"};
    const Eigen::Vector3d center = line->nearest(setup.X_RT.translation());
    const double radius = (setup.X_RT.translation() - center).norm();
    const bool turn_tool = setup.arguments.choice("turn_tool") == 1;
    if (radius < 1e-3 && !turn_tool) return {ErrorCode::kDegenerate, "the tool is on the axis: it can only turn with it"};
    ToolTask task;
    task.X_entry = setup.X_RT;
    ToolPath path(setup.X_RT);
    path.arc(center, line->direction, angle, turn_tool);
    task.stages.push_back({"act", path, setup.arguments["speed"], false, false});
    setup.job.parts.push_back({"", true, false, {task}});
    setup.job.place = setup.X_RT.translation();
    setup.measure = [radius](const ArmSpace&, Plan& plan) { plan.figures["radius"] = radius; };
    return {};
  }
};

}  // namespace

std::unique_ptr<Macro> makeMoveAroundAxis() { return std::make_unique<MoveAroundAxis>(); }

}  // namespace longarm::planning
