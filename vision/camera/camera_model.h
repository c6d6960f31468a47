#pragma once

/// @file
/// Pinhole camera with skew and the lens model k1 k2 p1 p2 k3 ("plumb bob").

#include <array>
#include <string>

#include <Eigen/Core>

#include "core/result.h"

namespace longarm::vision {

/// Pixel and its derivatives.
struct ProjectionWithJacobian {
  Eigen::Vector2d pixel;                    ///< (2) [px]
  Eigen::Matrix<double, 2, 3> d_point;      ///< d pixel / d point in the camera frame [px/m]
};

/// Intrinsics of one camera.  Pixel (0, 0) is the centre of the top-left pixel; x right, y down, z forward.
///
/// The map from ideal to distorted coordinates is equation (1) of SAND2004-6198 with its two printed slips
/// mended (the y row's tangential terms) and OpenCV's sixth-order term k3 added; skew acts on the distorted
/// coordinates, which OpenCV leaves out.
struct CameraModel {
  std::string name;
  int width = 0, height = 0;                 ///< [px]; 0 where the file does not say.
  double fx = 1, fy = 1, skew = 0, cx = 0, cy = 0;   ///< [px]
  std::array<double, 5> distortion{};        ///< k1 k2 p1 p2 k3, OpenCV's order.

  Eigen::Matrix3d K() const;
  bool hasDistortion() const;
  /// Radius in normalised coordinates up to which the distortion is monotone (infinity if always).
  double monotoneRadius() const;
  bool containsPixel(const Eigen::Vector2d& pixel, double margin_px = 0) const;

  /// Distorted, normalised image of ideal normalised coordinates (x, y).
  Eigen::Vector2d distort(const Eigen::Vector2d& n) const;
  /// Pixel of ideal normalised coordinates, no range check.
  Eigen::Vector2d pixelOfNormalised(const Eigen::Vector2d& n) const;
  /// Ideal normalised coordinates of a raw pixel (inverse of the above to < 1e-9 px).
  /// @returns kDegenerate when the pixel has no inverse inside the monotone range.
  Result<Eigen::Vector2d> normalisedOfPixel(const Eigen::Vector2d& pixel) const;

  /// Raw pixel of a point in the camera frame [m].
  /// @returns kDegenerate when the point is behind the camera (z <= 1e-9) or beyond the monotone range.
  Result<Eigen::Vector2d> project(const Eigen::Vector3d& p_C) const;
  Result<ProjectionWithJacobian> projectWithJacobian(const Eigen::Vector3d& p_C) const;
  /// Unit ray in the camera frame through a raw pixel; fails as normalisedOfPixel.
  Result<Eigen::Vector3d> rayOfPixel(const Eigen::Vector2d& pixel) const;
  /// The same camera without distortion and skew (what an undistorted picture has).
  CameraModel undistorted() const;
};

/// Finite, positive focal lengths and plausible numbers; the message names the field and its value.
Status validate(const CameraModel& camera);

}  // namespace longarm::vision
