#pragma once

/// @file
/// What sticks out of the tool: the gripper's ends, things it holds; and which bodies are near a place.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "planning/macros/planning_run.h"

namespace longarm::planning {

/// Links that are the tool: the gripper's where there is one, else all that the arm's last joint moves.
std::vector<std::string> toolLinks(const Workcell& workcell);

/// How far the tool's links reach beyond its origin along tool z at q; 0 when they do not [m].
double toolOverhang(const Workcell& workcell, const Eigen::VectorXd& q);

/// How far what the gripper holds (objects attached to links beyond the arm's last joint) reaches below the tool's
/// origin, in the direction `down` (unit, root frame) at q; 0 when nothing is held [m].
double heldBelow(const PlanContext& context, const Eigen::Vector3d& down);

/// Names of the workcell's and the context's bodies, not carried ones, that come within `distance` of p.
std::vector<std::string> objectsNear(const PlanContext& context, const Eigen::Vector3d& p, double distance);

/// Those that p lies in: a marked thing itself, where the world knows it.
std::vector<std::string> objectsThrough(const PlanContext& context, const Eigen::Vector3d& p);

/// Whether `link` is moved by the arm's last joint.
bool beyondArm(const Workcell& workcell, int link);

}  // namespace longarm::planning
