// surface_scan: a tool or sensor goes over a surface in parallel passes.
#include "core/text.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"
#include "planning/macros/scan_parameters.h"

namespace longarm::planning {
namespace {

constexpr double kUneven = 0.05;         // of the speed asked for

class SurfaceScan final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    std::vector<MacroParameter> parameters = scanParameters();
    parameters.push_back({"first_pass", "choice", 0, 0, 199, "Resume with this pass; those before it are left out."});
    return {"surface_scan", "Surface Scan", "Goes over the marked surface in parallel passes at an even distance and speed.",
            vision::FeatureKind::kPlane, std::move(parameters), 0.01};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto patch = planePatchFrom(setup.feature, setup.eye);
    if (!patch) return patch.error();
    RasterSpec spec = scanSpec(setup.arguments);
    spec.first_pass = setup.arguments.choice("first_pass");
    auto tasks = scanTasks(*patch, spec, setup.arguments.is("roll_free"), spec.first_pass == 0);
    if (!tasks) return tasks.error();
    const auto raster = rasterOf(*patch, spec);
    setup.job.obstacles.push_back(patch->slab(setup.feature.name));
    setup.job.parts.push_back({"", false, false, *std::move(tasks)});
    setup.measure = [patch = *patch, spec, passes = raster->passes, spacing = raster->spacing](const ArmSpace& space, Plan& plan) {
      const PlanStage& scan = plan.stages.back();
      const ScanFigures figures = scanFigures(space, plan, scan.start_s, scan.end_s, patch, spec);
      plan.figures = {{"coverage", figures.coverage}, {"passes", passes}, {"spacing", spacing},
                      {"speed_lowest", figures.slowest}, {"speed_highest", figures.fastest}};
      if (figures.slowest < (1 - kUneven) * spec.speed) {
        plan.notes.push_back("The arm cannot keep " + formatFixed(spec.speed, 3) + " m/s all over the surface: it falls to " +
                             formatFixed(figures.slowest, 3) + " m/s.");
      }
    };
    return {};
  }
};

}  // namespace

std::unique_ptr<Macro> makeSurfaceScan() { return std::make_unique<SurfaceScan>(); }

}  // namespace longarm::planning
