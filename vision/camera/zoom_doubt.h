#pragma once

/// @file
/// How unsure a zoom table is, by what its own settings say of each other.

#include <optional>
#include <vector>

#include "vision/camera/zoom_camera.h"

namespace longarm::vision {

/// One setting, predicted from all others.
struct ZoomPrediction {
  ZoomNode truth, predicted;

  double focalError() const { return predicted.interior[0] / truth.interior[0] - 1; }
  /// Predicted minus true, in pixels at this setting.
  Eigen::Vector2d boresightError() const { return boresightOf(predicted) - boresightOf(truth); }
};

/// Every setting but the first and the last, by zoom; fewer than three settings: none.  Pure function.
std::vector<ZoomPrediction> predictFromOthers(const ZoomCamera& camera);

/// What a table leaves open of its focal lengths (one share for both) and of its principal point, 1 sigma; the rest of
/// the ten numbers of a camera file counts as certain.
/// A setting that lies midway between two others is missed by sqrt(1 + 1/2) of what each of the three is wrong, so that each
/// is wrong by the miss over sqrt(1.5): the root mean square of the three predictions nearest to `node`, nominal nodes
/// (isNominal) apart.
/// @returns 10 x 10 (fx fy skew cx cy k1 k2 p1 p2 k3); empty when nothing was predicted.  Pure function.
std::optional<Eigen::MatrixXd> lensDoubt(const std::vector<ZoomPrediction>& predictions, const ZoomNode& node);

}  // namespace longarm::vision
