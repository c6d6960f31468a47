#pragma once

/// @file
/// The settings of one zoom lens taken together: what a board says weakly at one, the others say better.

#include <string>
#include <vector>

#include "calibration/solve/lens_parameters.h"
#include "vision/camera/zoom_camera.h"

namespace longarm::calibration {

/// One setting as calibrated by itself.
struct ZoomLens {
  vision::ZoomNode node;
  LensMatrix covariance = LensMatrix::Zero();      ///< Of its ten numbers; zero: unknown, the node is taken as it is.
};

struct ZoomJoin {
  std::vector<ZoomLens> lenses;                    ///< In the given order.
  std::vector<std::string> warnings;               ///< Settings whose principal point does not go with the others.
};

/// The narrower the field, the less a board tells of the principal point: a shift of it looks like a turn of the camera,
/// and at eight times the focal length it is uncertain by ten pixels and more.  But the glass moves along one axis in a rigid
/// housing: the principal point wanders by a few pixels over the whole travel (by 1.3 and 2.1 px in SAND2004-6198, Appendix D,
/// once its nodes are brought to one rotation).  So each setting is conditioned on what the others say of it,
///   p_k ~ N(m, wander^2 I),  measured p_k ~ N(p_k, S_k),
/// m unknown; through the covariance the focal lengths and the distortion gain with it.
/// @param wander_px 1 sigma of a setting's principal point about the common one, per axis.
/// Fewer than two settings are returned as they are.  Pure function.
ZoomJoin joinZoom(const std::vector<ZoomLens>& lenses, double wander_px = 3);

}  // namespace longarm::calibration
