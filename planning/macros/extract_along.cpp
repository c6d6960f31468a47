// extract_along: straight back out, against a line's direction.
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"

namespace longarm::planning {
namespace {

class ExtractAlong final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"extract_along", "Extract Along", "Pulls the tool straight out along the marked line, towards and past its first end.",
            vision::FeatureKind::kLine,
            {{"distance", "m", 0.10, 0.005, 1, "How far to pull."}, travelSpeedParameter(0.02)},
            0.006};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto line = axisLineFrom(setup.feature);
    if (!line) return line.error();
    ToolTask task;
    task.X_entry = setup.X_RT;
    ToolPath path(setup.X_RT);
    path.lineTo(Eigen::Vector3d(setup.X_RT.translation() - setup.arguments["distance"] * line->direction));
    task.stages.push_back({"retreat", path, setup.arguments["speed"], true, false});
    setup.job.parts.push_back({"", true, false, {task}});
    setup.job.place = path.end().translation();
    return {};
  }
};

}  // namespace

std::unique_ptr<Macro> makeExtractAlong() { return std::make_unique<ExtractAlong>(); }

}  // namespace longarm::planning
