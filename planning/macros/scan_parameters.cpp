#include "planning/macros/scan_parameters.h"

namespace longarm::planning {

std::vector<MacroParameter> scanParameters() {
  return {{"swath", "m", 0.08, 0.005, 1, "Width the tool covers across its travel."},
          {"overlap", "1", 0.2, 0, 0.9, "Least share of a swath that neighbouring passes share."},
          {"stand_off", "m", 0.10, 0.01, 1, "Between the tool point and the surface, along the tool."},
          {"tilt", "rad", 0, -0.8, 0.8, "Of the tool towards its first direction of travel."},
          travelSpeedParameter(0.05),
          {"direction", "choice", 0, 0, 1, "Passes along the first edge (0) or the second (1).", {"first edge", "second edge"}},
          {"roll_free", "choice", 1, 0, 1, "1: the tool may turn about its own axis; 0: its x stays along the passes.", {"held", "free"}}};
}

RasterSpec scanSpec(const MacroArguments& arguments) {
  RasterSpec spec;
  spec.swath = arguments["swath"];
  spec.overlap = arguments["overlap"];
  spec.stand_off = arguments["stand_off"];
  spec.tilt = arguments["tilt"];
  spec.speed = arguments["speed"];
  spec.along_v = arguments.choice("direction") == 1;
  return spec;
}

Result<std::vector<ToolTask>> scanTasks(const PlanePatch& patch, const RasterSpec& spec, bool roll_free, bool all_corners) {
  std::vector<ToolTask> tasks;
  for (int corner = 0; corner < (all_corners ? 4 : 1); ++corner) {
    RasterSpec mine = spec;
    mine.mirror_travel = corner & 1;
    mine.mirror_step = corner & 2;
    if (mine.mirror_travel) mine.tilt = -mine.tilt;      // towards the same side of the surface
    const auto raster = rasterOf(patch, mine);
    if (!raster) return raster.error();
    ToolTask task;
    task.X_entry = raster->path.start();
    task.stages.push_back({"scan", raster->path, spec.speed, false, false});
    task.preference = corner;
    task.roll_free = roll_free;
    tasks.push_back(task);
  }
  return tasks;
}

}  // namespace longarm::planning
