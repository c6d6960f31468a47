#pragma once

/// @file
/// The lens model's arithmetic, inline: for the room's own kernels.  Others use CameraModel.

#include <Eigen/Core>

#include "vision/camera/camera_model.h"

namespace longarm::vision::internal {

/// Square of CameraModel::monotoneRadius(): first root in s = r^2 of 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3.
double monotoneRadius2(const CameraModel& camera);

/// Distorted coordinates, equation (1) of SAND2004-6198 with its y row mended, and OpenCV's k3.
inline Eigen::Vector2d distort(const std::array<double, 5>& d, double x, double y) {
  const double r2 = x * x + y * y;
  const double g = 1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  return {x * g + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x), y * g + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y};
}

/// The same with its derivative, which is symmetric: [xx xy; xy yy].
struct Distorted {
  double x, y, xx, xy, yy;
};
inline Distorted distortWithDerivative(const std::array<double, 5>& d, double x, double y) {
  const double r2 = x * x + y * y;
  const double g = 1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  const double slope = 2 * (d[0] + r2 * (2 * d[1] + 3 * r2 * d[4]));  // dg/dx = slope x, dg/dy = slope y
  Distorted out;
  out.x = x * g + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x);
  out.y = y * g + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y;
  out.xx = g + x * x * slope + 2 * d[2] * y + 6 * d[3] * x;
  out.xy = x * y * slope + 2 * d[2] * x + 2 * d[3] * y;
  out.yy = g + y * y * slope + 6 * d[2] * y + 2 * d[3] * x;
  return out;
}

/// Ideal coordinates of a raw pixel; `at` receives the lens' derivative there.
/// @returns false when there are none within the monotone range.
bool undistortPixel(const CameraModel& camera, double max_radius2, const Eigen::Vector2d& pixel, Eigen::Vector2d* n,
                    Distorted* at);

/// K2 D: derivative of the pixel by the ideal coordinates.
inline Eigen::Matrix2d pixelByNormalised(const CameraModel& camera, const Distorted& at) {
  Eigen::Matrix2d M;
  M << camera.fx * at.xx + camera.skew * at.xy, camera.fx * at.xy + camera.skew * at.yy, camera.fy * at.xy,
      camera.fy * at.yy;
  return M;
}

}  // namespace longarm::vision::internal
