// press: onto the middle of a surface, a little into it, and back.
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"
#include "planning/macros/tool_shape.h"

namespace longarm::planning {
namespace {

class Press final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"press", "Press", "Pushes the tool's end onto the middle of the marked surface, square to it, and takes it back.",
            vision::FeatureKind::kPlane,
            {standOffParameter(0.08),
             {"depth", "m", 0.003, -0.05, 0.05, "How far beyond the surface; negative stops before it."},
             {"along_u", "1", 0.5, 0, 1, "Where on the surface, as a share of its first edge."},
             {"along_v", "1", 0.5, 0, 1, "Where on the surface, as a share of its second edge."},
             approachSpeedParameter(),
             {"press_speed", "m/s", 0.01, 0.001, 0.05, "Speed of the last 10 mm and of pressing."}},
            0.005};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto patch = planePatchFrom(setup.feature, setup.eye);
    if (!patch) return patch.error();
    const auto& a = setup.arguments;
    const Eigen::Vector3d z = -patch->normal;
    const double overhang = toolOverhang(setup.run.workcell(), setup.run.context().start);
    const Eigen::Vector3d on = patch->at(a["along_u"] * patch->width, a["along_v"] * patch->height) - overhang * z;
    const Eigen::Vector3d before = on - 0.01 * z, in = on + a["depth"] * z;
    setup.job.obstacles.push_back(patch->slab(setup.feature.name));
    setup.job.touchable = objectsNear(setup.run.context(), on + overhang * z, 0.02);
    setup.job.touchable.push_back(setup.feature.name);
    ToolTask task;
    task.X_entry = poseAt(on - a["stand_off"] * z, toolRotation(z, setup.X_RT.linear().col(0)));
    ToolPath approach(task.X_entry), press(poseAt(before, task.X_entry.linear())), retreat(poseAt(in, task.X_entry.linear()));
    approach.lineTo(before);
    press.lineTo(in);
    retreat.lineTo(task.X_entry);
    task.stages.push_back({"approach", approach, a["approach_speed"], true, true});
    if (!press.empty()) task.stages.push_back({"press", press, a["press_speed"], true, true});
    if (!retreat.empty()) task.stages.push_back({"retreat", retreat, a["approach_speed"], true, true});
    task.roll_free = true;
    TaskPart part;
    part.tasks.push_back(std::move(task));
    setup.job.parts.push_back(std::move(part));
    setup.job.place = on;
    return {};
  }
};

}  // namespace

std::unique_ptr<Macro> makePress() { return std::make_unique<Press>(); }

}  // namespace longarm::planning
