#pragma once

/// @file
/// The quick way from a pair of clicks to a 3-D point with covariance, for drags and batches.

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "vision/snapshot/view.h"
#include "vision/stereo/pair_kernel.h"

namespace longarm::vision {

/// What one pair of clicks gives.  Frames and units as TriangulatedPoint; pick noise only.
struct PairPoint {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double miss_m = 0;
  double parallax = 0;                   ///< [rad]
};

/// Two views prepared once, then solved for many pairs.  Agrees with triangulate() to far below the noise:
/// the pixel metric is carried to normalised coordinates by the lens' derivative at each click, where one
/// Gauss-Newton step is taken from the middle of the common perpendicular.  Thread-compatible; locate() is const and allocates nothing.
class PairTriangulator {
 public:
  /// @pre Both views have the same parent.
  PairTriangulator(const View& a, const View& b, double refuse_parallax = 0.3 * 0.017453292519943295);

  /// @returns false where triangulate() would refuse (it says why): a pixel has no ray, the rays are too
  ///   nearly parallel, or they meet behind a camera.
  bool locate(const Eigen::Vector2d& pixel_a, const Eigen::Vector2d& pixel_b, PairPoint* point) const;

  /// Places of many pairs without their covariance: several are solved at once.
  /// @param points  One row each; of a refused pair not a number.
  /// @returns how many were located.  @pre both lists are equally long
  std::size_t locateAll(const std::vector<Eigen::Vector2d>& pixels_a, const std::vector<Eigen::Vector2d>& pixels_b,
                        std::vector<Eigen::Vector3d>* points) const;

 private:
  /// For pixels at the edge of what a lens shows, where the quick inversion does not settle.
  internal::PairAnswer solveThoroughly(const Eigen::Vector2d& pixel_a, const Eigen::Vector2d& pixel_b,
                                       internal::PairSolution* solution) const;

  CameraModel m_camera_a, m_camera_b;
  Eigen::Vector3d m_p_WA = Eigen::Vector3d::Zero();
  internal::CameraPair m_pair;
};

}  // namespace longarm::vision
