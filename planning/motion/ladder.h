#pragma once

/// @file
/// Joint paths along a sequence of tool poses, over all branches of the arm and free turns about tool z.

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "planning/robot/ik.h"

namespace longarm::planning {

/// One way up the ladder: a joint configuration and a roll on every rung.
struct LadderPath {
  std::vector<Eigen::VectorXd> joints;   ///< (n) per rung.
  std::vector<double> rolls;             ///< About tool z, added to the rung's pose [rad].
  double cost = 0;                       ///< Joint way [rad], the turn of the roll included.
};

struct LadderOptions {
  double roll_step = 0.2618;             ///< Rolls are multiples of this [rad]; 0: no roll.
  double max_joint_step = 0.6;           ///< Between two rungs: more is another branch [rad].
  double roll_cost = 0.2;                ///< Of one rad of change of the roll [rad].
  std::size_t widest = 48;               ///< Nodes kept per rung, cheapest first.
};

struct LadderAnswer {
  std::vector<LadderPath> paths;         ///< Cheapest first, each with another first node.
  std::size_t furthest = 0;              ///< Last rung that any node reached.
};

/// The rungs' poses and what the nodes must satisfy.
struct Ladder {
  std::vector<Pose> X_RT;                                                    ///< At least one.
  std::function<bool(std::size_t rung, const Eigen::VectorXd& arm)> valid;
  std::function<bool()> stop;                                                ///< Asked once per node.
};

/// Climbs from all `starts` (joints and rolls on the first rung) by dynamic programming over (branch, roll): the graph
/// of Descartes (De Maeyer, Moyaers, Demeester, "Cartesian path planning for arc welding robots", ETFA 2017), grown
/// from the first rung.  Each node is followed to the next rung by warm-started inverse kinematics, at its own roll
/// and the two beside it; nodes that meet are joined at the cheaper way.  Since a path may not change its branch,
/// nothing that does not grow out of the first rung could be used.
/// Pure function of its input; thread-compatible with the solver.
LadderAnswer climb(const IkSolver& solver, const Ladder& ladder, const std::vector<LadderPath>& starts,
                   const LadderOptions& options = {});

/// The pose turned by `roll` about its own z.
Pose rolled(const Pose& X_RT, double roll);

/// Follows one node along all rungs at its own roll, depth first; empty joints at the first rung it cannot reach.
/// @param reached  Rungs reached, for the sentence of a failure.
LadderPath followRungs(const IkSolver& solver, const Ladder& ladder, const Eigen::VectorXd& start, double roll,
                       const LadderOptions& options, std::size_t& reached);

}  // namespace longarm::planning
