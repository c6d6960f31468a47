#pragma once

/// @file
/// The ten numbers of a camera as parameters of an estimate, in the order of camera files:
/// fx fy skew cx cy k1 k2 p1 p2 k3.

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "vision/camera/camera_model.h"

namespace longarm::calibration {

constexpr int kLensParameters = 10;
using LensVector = Eigen::Matrix<double, kLensParameters, 1>;
using LensMatrix = Eigen::Matrix<double, kLensParameters, kLensParameters>;

enum LensParameter { kFx, kFy, kSkew, kCx, kCy, kK1, kK2, kP1, kP2, kK3 };

/// "fx", "fy", "skew", ...
const char* lensParameterName(int index);

/// Which of the ten are estimated.
struct LensMask {
  std::array<bool, kLensParameters> free{};

  /// fx fy cx cy; skew if wanted; the first `distortion` (0, 2, 4 or 5) of k1 k2 p1 p2 k3.
  static LensMask of(bool skew, int distortion);
  int count() const;
  std::vector<int> indices() const;
};

LensVector lensVector(const vision::CameraModel& camera);
void setLensVector(const LensVector& values, vision::CameraModel* camera);

/// A projection with all its derivatives.
struct LensProjection {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> d_point;                   ///< By the point in the camera's frame [px/m].
  Eigen::Matrix<double, 2, kLensParameters> d_lens;      ///< By the ten parameters.
};

/// Projects without looking at the range of the lens, so that an estimate may pass through odd values.
/// @returns false when the point is not in front of the camera.
bool projectWithDerivatives(const vision::CameraModel& camera, const Eigen::Vector3d& p_C, LensProjection* out);
/// Pixel and derivative by the point alone.
bool projectWithPointDerivative(const vision::CameraModel& camera, const Eigen::Vector3d& p_C, Eigen::Vector2d* pixel,
                                Eigen::Matrix<double, 2, 3>* d_point);
/// Pixel only.
bool projectPoint(const vision::CameraModel& camera, const Eigen::Vector3d& p_C, Eigen::Vector2d* pixel);

/// R <- Exp(w) R, p <- p + d: the split increment (w, d) that all pose covariances of this program use.
Pose moved(const Pose& X, const Vector6d& increment);
/// d (increment of X^-1) / d (increment of X) for split increments.
Matrix6d inverseIncrement(const Pose& X);

}  // namespace longarm::calibration
