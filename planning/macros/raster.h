#pragma once

/// @file
/// Scans of a rectangle in parallel passes, and how much of it a motion has covered.

#include <string>

#include "planning/macros/feature_geometry.h"
#include "planning/motion/arm_space.h"
#include "planning/motion/plan.h"
#include "planning/motion/tool_path.h"

namespace longarm::planning {

struct RasterSpec {
  double swath = 0.08;                   ///< Width that the tool covers across its travel [m].
  double overlap = 0.2;                  ///< Least share of the swath that neighbouring passes share, 0 ... 0.9.
  double stand_off = 0.1;                ///< From the surface to the tool's origin, along tool z [m].
  double tilt = 0;                       ///< Of the tool towards its first direction of travel [rad].
  double speed = 0.05;                   ///< [m/s]
  bool along_v = false;                  ///< Passes run along the second edge.
  bool mirror_travel = false, mirror_step = false;   ///< Start at another corner.
  int first_pass = 0;                    ///< Passes before it are left out.
  bool run_out = true;                   ///< Passes begin and end beyond the edge, so that the speed is even over the surface.
};

/// The raster of a patch: passes back and forth, joined by half circles beyond the edges.  Without run_out all of it stays within the
/// patch: passes end half their spacing before its edges.
///
/// With it each pass runs past the edge by v^2 / 2a and the time that acceleration is smoothed over, so that the speed is even
/// on the surface.  The tool keeps its orientation: z into the surface, x along the passes.
struct Raster {
  ToolPath path;
  int passes = 0;                        ///< In all, those left out included.
  double spacing = 0;                    ///< Between passes [m].
};
/// @returns kOutOfLimits: first_pass is beyond the last, or more than 200 passes.
Result<Raster> rasterOf(const PlanePatch& patch, const RasterSpec& spec);

/// What a scan did, from its timed motion.
struct ScanFigures {
  double coverage = 0;                   ///< Share of the patch within half a swath of a pass, 0 ... 1.
  double slowest = 0, fastest = 0;       ///< Tool speed over the patch [m/s]; 0 when it was never over it.
};
/// @param from_s, to_s  Interval of the plan's trajectory.
ScanFigures scanFigures(const ArmSpace& space, const Plan& plan, double from_s, double to_s, const PlanePatch& patch,
                        const RasterSpec& spec);

}  // namespace longarm::planning
