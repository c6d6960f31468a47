#pragma once

/// @file
/// Collision-free joint paths from a start to any of several goals.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/cancel.h"
#include "planning/motion/arm_space.h"
#include "planning/motion/plan.h"

namespace longarm::planning {

struct PathRequest {
  Eigen::VectorXd start;
  std::vector<Eigen::VectorXd> goals;    ///< Best first; each must be valid.
  unsigned seed = 1;
  int max_iterations = 20000;            ///< Samples drawn before giving up.
  double deadline_s = 1e300;             ///< On the steady clock.
  CancelToken cancel;
};

struct PathAnswer {
  PlanStatus status = PlanStatus::kNoPath;       ///< kOk, kNoPath, kTimeout, kCancelled.
  std::vector<Eigen::VectorXd> waypoints;        ///< Start to goal; every straight piece is free.
  std::size_t goal = 0;                          ///< Which of the goals.
  int iterations = 0;                            ///< Samples drawn; 0: the straight way was free.
};

/// The straight way if it is free; else RRT-Connect (Kuffner & LaValle, ICRA 2000) as OMPL has it, with every
/// motion checked continuously, which no resolution can miss; then shortcuts.
///
/// Same request, same answer, bit for bit: samples come from a generator of our own and nearest neighbours by
/// plain search, since OMPL's own generators are seeded once per process.  Only running out of time or being
/// cancelled depends on the clock; both are looked at between two motions (a few milliseconds).  Never throws.
PathAnswer planPath(const ArmSpace& space, const PathRequest& request);

/// Shorter path by replacing pieces with straight motions that are free.  Keeps both ends.
std::vector<Eigen::VectorXd> shortcut(const ArmSpace& space, std::vector<Eigen::VectorXd> waypoints, unsigned seed,
                                      const CancelToken& cancel, int tries = 80);

double pathLength(const std::vector<Eigen::VectorXd>& waypoints);

/// Seconds of the steady clock.
double steadyNow();

}  // namespace longarm::planning
