#pragma once

/// @file
/// Gives a geometric path its times: a trajectory within velocity, acceleration and tool-speed limits.

#include <functional>
#include <string>
#include <vector>

#include "core/motion.h"
#include "core/result.h"
#include "planning/trajectory/joint_path.h"
#include "planning/trajectory/nominal_limits.h"

namespace longarm::planning {

/// Way of the tool per unit of s, |dp/ds| [m], given the path's state there.
using ToolWay = std::function<double(const PathState&)>;

struct TimingOptions {
  double max_tool_speed = 1e9;           ///< [m/s]
  ToolWay tool_way;                      ///< Empty: the tool's speed is not looked at.
  double smoothing_s = 0.08;             ///< Window over which acceleration is averaged; lengthens the motion by as much.
  double point_spacing_s = 0.02;         ///< Of the points; at most this.
  std::function<bool()> stop;            ///< Asked every few points: true ends it.  Empty: never.
};

/// Rest to rest along the path as fast as the limits allow.
///
/// The fastest law (time_law.h) is averaged over a window, so that acceleration is continuous and quintic interpolation
/// between the points follows it; then it is sampled every 0.5 ms as Trajectory::sample() will play it, and slowed
/// down as a whole by what a limit is still passed (a percent or so).
/// @returns kDegenerate when path and limits do not fit together (sizes, zero length, not finite), kCancelled when it was stopped.
Result<Trajectory> parameterize(const JointPath& path, const std::vector<std::string>& joint_names,
                                const NominalLimits& limits, const TimingOptions& options = {});

/// Largest |velocity| / limit and |acceleration| / limit over samples at most 0.5 ms apart, the points among them; of what was
/// looked at before `stop`, asked at every point, said true.
struct LimitRatios {
  double velocity = 0, acceleration = 0;
};
LimitRatios limitRatios(const Trajectory& trajectory, const Eigen::VectorXd& max_velocity,
                        const Eigen::VectorXd& max_acceleration, const std::function<bool()>& stop = {});

/// Appends b, which starts at rest where a ends, to a.  @pre same joints
void append(Trajectory& a, const Trajectory& b);
/// A trajectory that stands still for `seconds`.
Trajectory standStill(const std::vector<std::string>& joint_names, const Eigen::VectorXd& positions, double seconds);

}  // namespace longarm::planning
