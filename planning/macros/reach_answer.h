#pragma once

/// @file
/// What a quick look says about a macro and a feature.

#include <string>

#include <Eigen/Core>

namespace longarm::planning {

/// How it was done a moment ago.
struct ReachSeed {
  int task = -1;                         ///< -1: nothing is known.
  double roll = 0;                       ///< About tool z [rad].
  Eigen::VectorXd entry;                 ///< Arm joints.
};

struct ReachAnswer {
  enum class Level { kUnknown, kReached, kStrained, kNot } level = Level::kUnknown;
  std::string reason;                    ///< A sentence; empty when reached.
  double roll = 0;                       ///< The roll it was reached with, against the macro's own [rad].
  ReachSeed seed;                        ///< For the next look.
};

}  // namespace longarm::planning
