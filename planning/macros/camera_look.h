#pragma once

/// @file
/// Ways to hold the arm so that its camera looks at a point.

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "planning/macros/tool_task.h"
#include "planning/world/workcell.h"

namespace longarm::planning {

/// What looks: a camera that the arm's last joint moves, or the tool itself along its z.
struct ArmEye {
  Pose X_RC = Pose::Identity();          ///< Optical frame at the start, in the root frame.
  Pose X_CT = Pose::Identity();          ///< The tool, seen from it.
};

/// The first camera beyond the arm's last joint; nothing where there is none.
/// @param q  Full configuration.  @param X_RT  The tool there.
std::optional<ArmEye> armEyeOf(const Workcell& workcell, const Eigen::VectorXd& q, const Pose& X_RT);
bool hasArmCamera(const Workcell& workcell);

/// One task per turn of the picture, level first: the eye stands `distance` [m] before p and looks along `z` (unit) to it.
/// @param up  Unit; both in the root frame.  @param preference  Of the level one; the others get up to three more.
std::vector<ToolTask> lookTasks(const ArmEye& eye, const Eigen::Vector3d& p, const Eigen::Vector3d& z, double distance,
                                const Eigen::Vector3d& up, int preference);

}  // namespace longarm::planning
