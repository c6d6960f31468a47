#pragma once

/// @file
/// Where something of the workcell was found to stand: a file of its own in the library.

#include <string>

#include "core/pose.h"
#include "core/result.h"

namespace longarm::session {

/// A pan-tilt's first joint in the link that carries it, or an object in its parent.
struct Placement {
  PoseInParent pose;
  Matrix6d covariance = Matrix6d::Zero();  ///< Of its split increment in the parent (turn, then shift).

  /// 1 sigma of a place one metre from its origin [m]: one figure to compare two by.
  double uncertaintyAtOneMetre() const;
};

/// JSON: parent, xyz, quaternion_xyzw, covariance (row-major).
Status writePlacement(const std::string& path, const Placement& placement);
/// @returns kNotFound, or kInvalidInput naming file, key and what was expected.
Result<Placement> readPlacement(const std::string& path);

}  // namespace longarm::session
