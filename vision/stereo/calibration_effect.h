#pragma once

/// @file
/// How results move with the calibration they were measured with: an error that picks and features share.

#include <vector>

#include <Eigen/Core>

#include "vision/snapshot/view.h"

namespace longarm::vision {

/// What of a view's calibration.
enum class CalibrationPart { kPose, kIntrinsics };

/// d result / d calibration of one view (pose, 6 columns) or one camera (intrinsics, 10 columns).
struct CalibrationEffect {
  const View* view = nullptr;            ///< Borrowed.
  CalibrationPart part = CalibrationPart::kPose;
  Eigen::MatrixXd d_result;              ///< (n x 6) or (n x 10), in the order of the view's covariances.
};

bool knowsPoseError(const View& view);
bool knowsIntrinsicsError(const View& view);

/// d pixel / d pose, from J = d pixel / d point in the parent frame and the point relative to the camera's centre.
Eigen::Matrix<double, 2, 6> pixelByPose(const Eigen::Matrix<double, 2, 3>& J, const Eigen::Vector3d& from_centre);
/// d pixel / d (fx fy skew cx cy k1 k2 p1 p2 k3) at ideal normalised coordinates n.
Eigen::Matrix<double, 2, 10> pixelByIntrinsics(const CameraModel& camera, const Eigen::Vector2d& n);

/// Adds to the effect of the same calibration where there is one: two views of one camera share its intrinsics.
void addEffect(const View& view, CalibrationPart part, const Eigen::MatrixXd& d_result,
               std::vector<CalibrationEffect>* effects);

/// Covariance between two results from the calibrations they share, (na x nb).  @pre neither list is empty.
Eigen::MatrixXd sharedCovariance(const std::vector<CalibrationEffect>& a, const std::vector<CalibrationEffect>& b);

}  // namespace longarm::vision
