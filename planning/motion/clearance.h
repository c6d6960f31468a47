#pragma once

/// @file
/// How near a motion comes to things, over its time.

#include <vector>

namespace longarm::planning {

/// One look at the motion.
struct ClearanceSample {
  double t_s = 0;                        ///< Of the plan's trajectory [s].
  /// Least distance of the robot, and what it holds, from everything else that the motion must keep away from [m]; what may be
  /// touched there does not count.  Its own links count where they come within kTightClearance of one another: most of them are never
  /// far apart, which would hide all else.  From kClearanceTold on it says "at least".
  double distance = 0;
};

/// Distances are measured exactly up to here [m].
constexpr double kClearanceTold = 0.1;

/// What an operator has to make of a distance.
enum class ClearanceBand { kFree, kNear, kTight };
constexpr double kNearClearance = 0.05, kTightClearance = 0.02;    ///< Below these [m].
/// Pure function.
ClearanceBand bandOf(double distance);

/// Samples by rising time.  Between two of them the smaller one is taken: a display never shows more room than was seen.
using ClearanceProfile = std::vector<ClearanceSample>;

/// At a time, clamped to the profile's ends.  @pre the profile is not empty.  Pure function.
double clearanceAt(const ClearanceProfile& profile, double t_s);
/// The sample of least distance.  @pre the profile is not empty.  Pure function.
const ClearanceSample& leastClearance(const ClearanceProfile& profile);

}  // namespace longarm::planning
