// move_parallel: from where the tool is, straight along a line's direction.
#include <cmath>

#include "core/text.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"

namespace longarm::planning {
namespace {

class MoveParallel final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"move_parallel", "Move Parallel", "Moves the tool from where it is straight along the marked line's direction.",
            vision::FeatureKind::kLine,
            {{"distance", "m", 0.10, -2, 2, "How far, from the line's first to its second end; negative is back."},
             travelSpeedParameter(0.10)},
            0.02};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto line = axisLineFrom(setup.feature);
    if (!line) return line.error();
    const double distance = setup.arguments["distance"];
    if (std::abs(distance) < 1e-3) return {ErrorCode::kOutOfLimits, "the distance is " + formatNumber(distance) + " m; at least 1 mm is needed"};
    ToolTask task;
    task.X_entry = setup.X_RT;
    ToolPath path(setup.X_RT);
    path.lineTo(Eigen::Vector3d(setup.X_RT.translation() + distance * line->direction));
    task.stages.push_back({"act", path, setup.arguments["speed"], true, false});
    setup.job.parts.push_back({"", true, false, {task}});
    setup.job.place = path.end().translation();
    return {};
  }
};

}  // namespace

std::unique_ptr<Macro> makeMoveParallel() { return std::make_unique<MoveParallel>(); }

}  // namespace longarm::planning
