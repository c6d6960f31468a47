#pragma once

/// @file
/// The plane that a line spans with one camera.

#include <Eigen/Core>

#include "core/result.h"
#include "vision/stereo/line.h"

namespace longarm::vision::internal {

/// Planes that meet at a smaller sine than this do not give a line; errors grow as its reciprocal.
constexpr double kMinPlaneQuality = 0.08;

/// In the parent frame; the normal and the rays have unit length.
struct ViewPlane {
  Eigen::Vector3d centre, normal, ray_a, ray_b;
};

/// @returns kInvalidInput: no view, picks less than 2 px apart, or a pick without a ray.
Result<ViewPlane> planeOf(const LineSighting& sighting);

/// The refusal of a line along the baseline, with what to do.
Error alongBaseline(double quality);

}  // namespace longarm::vision::internal
