// wipe: the tool's end goes over a surface in passes, pressed onto it.
#include <algorithm>

#include "core/text.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"
#include "planning/macros/scan_parameters.h"
#include "planning/macros/tool_shape.h"

namespace longarm::planning {
namespace {

constexpr double kLeast = 0.02;          // of a pass [m]

class Wipe final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"wipe", "Wipe", "Goes over the marked surface in parallel passes with the tool's end pressed onto it.", vision::FeatureKind::kPlane,
            {standOffParameter(0.08),
             {"depth", "m", 0.002, -0.02, 0.02, "How far beyond the surface the tool's end is led; negative hovers."},
             {"width", "m", 0.04, 0.005, 0.5, "That the tool's end wipes across its travel."},
             {"overlap", "1", 0.3, 0, 0.9, "Least share of the width that neighbouring passes share."},
             {"inset", "m", 0.02, 0, 0.5, "Kept from the surface's edges."},
             {"direction", "choice", 0, 0, 1, "Passes along the first edge (0) or the second (1).", {"first edge", "second edge"}},
             approachSpeedParameter(),
             travelSpeedParameter(0.05)},
            0.005};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto patch = planePatchFrom(setup.feature, setup.eye);
    if (!patch) return patch.error();
    const auto& a = setup.arguments;
    PlanePatch inside = *patch;
    const double inset = a["inset"];
    inside.corner = patch->at(inset, inset);
    inside.width -= 2 * inset;
    inside.height -= 2 * inset;
    if (std::min(inside.width, inside.height) < kLeast) {
      return {ErrorCode::kOutOfLimits, "within an inset of " + formatFixed(1e3 * inset, 0) + " mm the surface is " + formatFixed(1e3 * inside.width, 0) + " x " +
                                           formatFixed(1e3 * inside.height, 0) + " mm; at least 20 mm are needed"};
    }
    RasterSpec spec;
    spec.swath = a["width"];
    spec.overlap = a["overlap"];
    spec.stand_off = toolOverhang(setup.run.workcell(), setup.run.context().start) - a["depth"];
    spec.speed = a["speed"];
    spec.along_v = a.choice("direction") == 1;
    spec.run_out = false;
    setup.job.obstacles.push_back(patch->slab(setup.feature.name));
    setup.job.touchable = objectsNear(setup.run.context(), patch->center(), 0.02);
    setup.job.touchable.push_back(setup.feature.name);
    auto tasks = scanTasks(inside, spec, true, true);
    if (!tasks) return tasks.error();
    for (ToolTask& task : *tasks) wrap(setup, task);
    setup.job.parts.push_back({"", false, false, *std::move(tasks)});
    setup.measure = [inside, spec](const ArmSpace& space, Plan& plan) {
      for (const PlanStage& stage : plan.stages) {
        if (stage.name == "wipe") plan.figures["coverage"] = scanFigures(space, plan, stage.start_s, stage.end_s, inside, spec).coverage;
      }
    };
    return {};
  }

 private:
  // Down onto the surface before the passes, and off it after them.
  static void wrap(const MacroSetup& setup, ToolTask& task) {
    ToolStage wipe = task.stages.front();
    wipe.name = "wipe";
    wipe.touching = true;
    const Eigen::Vector3d z = task.X_entry.linear().col(2), off = -setup.arguments["stand_off"] * z;
    const Pose X_before = poseAt(task.X_entry.translation() + off, task.X_entry.linear());
    ToolPath approach(X_before), retreat(wipe.path.end());
    approach.lineTo(task.X_entry.translation());
    retreat.lineTo(Eigen::Vector3d(wipe.path.end().translation() + off));
    const double speed = setup.arguments["approach_speed"];
    task.X_entry = X_before;
    task.stages = {{"approach", approach, speed, true, true}, wipe, {"retreat", retreat, speed, true, true}};
  }
};

}  // namespace

std::unique_ptr<Macro> makeWipe() { return std::make_unique<Wipe>(); }

}  // namespace longarm::planning
