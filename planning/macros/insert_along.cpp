// insert_along: into an opening along a line, from its first end.
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"
#include "planning/macros/tool_shape.h"

namespace longarm::planning {
namespace {

constexpr double kNear = 0.03;           // bodies that near the line's first end may be touched [m]

class InsertAlong final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"insert_along", "Insert Along", "Aligns the tool with the marked line and moves it in from the line's first end.",
            vision::FeatureKind::kLine,
            {standOffParameter(0.10),
             {"depth", "m", 0.05, 0.002, 1, "How far the tool point goes beyond the first end."},
             approachSpeedParameter(),
             {"insert_speed", "m/s", 0.02, 0.001, 0.1, "Speed of the tool inside."}},
            0.004};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto line = axisLineFrom(setup.feature);
    if (!line) return line.error();
    const Eigen::Vector3d& z = line->direction;
    setup.job.touchable = objectsNear(setup.run.context(), line->first, kNear);
    ToolTask task;
    task.X_entry = poseAt(line->first - setup.arguments["stand_off"] * z, toolRotation(z, setup.X_RT.linear().col(0)));
    ToolPath approach(task.X_entry);
    approach.lineTo(line->first);
    ToolPath insert(approach.end());
    insert.lineTo(Eigen::Vector3d(line->first + setup.arguments["depth"] * z));
    task.stages.push_back({"approach", approach, setup.arguments["approach_speed"], true, true});
    task.stages.push_back({"insert", insert, setup.arguments["insert_speed"], true, true});
    task.roll_free = true;
    if (setup.arguments["depth"] > line->length) task.note = "The depth asked for is beyond the second end of the line.";
    TaskPart part;
    part.tasks.push_back(std::move(task));
    setup.job.parts.push_back(std::move(part));
    setup.job.place = line->first;
    return {};
  }
};

}  // namespace

std::unique_ptr<Macro> makeInsertAlong() { return std::make_unique<InsertAlong>(); }

}  // namespace longarm::planning
