#pragma once

/// @file
/// Motions that an operator has recorded: way-points of the arm's joints, replayed through the planner.

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/result.h"
#include "planning/macros/macro.h"

namespace longarm::planning {

struct RecordedWaypoint {
  std::string name;
  Eigen::VectorXd joints;  ///< (n) [rad or m]
};

/// A value.
struct RecordedMotion {
  std::string name;                      ///< As the operator gave it.
  std::vector<std::string> joint_names;  ///< (n)
  std::vector<RecordedWaypoint> waypoints;
};

constexpr std::size_t kMostWaypoints = 2000;

/// @returns kInvalidInput naming what is wrong: no name, no way-point or too many, sizes that differ, numbers
/// not finite.
Status validate(const RecordedMotion& motion);
/// "recorded_" and the name in lower case, whatever is no letter or digit as '_': the name of its macro.
std::string macroName(const RecordedMotion& motion);

/// The way-points without those that the straight way between the rest passes within `tolerance` [rad or m]
/// in every joint (Douglas and Peucker, "Algorithms for the reduction of the number of points ...",
/// Cartographica 10(2), 1973); both ends stay.  Pure function.
std::vector<Eigen::VectorXd> thinned(const std::vector<Eigen::VectorXd>& joints, double tolerance);

/// JSON.  @returns kInvalidInput or kNotFound naming file and what is wrong; a file is written whole or not
/// at all.
Status writeRecordedMotion(const std::string& path, const RecordedMotion& motion);
Result<RecordedMotion> readRecordedMotion(const std::string& path);

/// Takes nothing.  Plans a free motion from where the arm is to the first way-point ("approach"), then
/// through all of them ("replay"), corners rounded, with new times and checked for collisions as everything
/// else.
std::unique_ptr<Macro> makeRecordedMotion(RecordedMotion motion);

}  // namespace longarm::planning
