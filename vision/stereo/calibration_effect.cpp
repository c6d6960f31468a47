#include "vision/stereo/calibration_effect.h"

#include <algorithm>

namespace longarm::vision {
namespace {

bool samePose(const View& a, const View& b) {
  return &a == &b || (!a.name.empty() && a.name == b.name && a.X_WC.matrix() == b.X_WC.matrix() &&
                      a.pose_covariance == b.pose_covariance);
}

bool sameCamera(const View& a, const View& b) {
  const CameraModel& p = a.camera;
  const CameraModel& q = b.camera;
  return &a == &b || (!p.name.empty() && p.name == q.name && p.K() == q.K() && p.distortion == q.distortion &&
                      a.intrinsics_covariance == b.intrinsics_covariance);
}

bool sameCalibration(const CalibrationEffect& a, const View& view, CalibrationPart part) {
  return a.part == part && (part == CalibrationPart::kPose ? samePose(*a.view, view) : sameCamera(*a.view, view));
}

}  // namespace

bool knowsPoseError(const View& view) { return !view.pose_covariance.isZero(0); }
bool knowsIntrinsicsError(const View& view) { return !view.intrinsics_covariance.isZero(0); }

Eigen::Matrix<double, 2, 6> pixelByPose(const Eigen::Matrix<double, 2, 3>& J, const Eigen::Vector3d& from_centre) {
  Eigen::Matrix<double, 2, 6> out;
  out << J * skew(from_centre), -J;
  return out;
}

Eigen::Matrix<double, 2, 10> pixelByIntrinsics(const CameraModel& camera, const Eigen::Vector2d& n) {
  const double x = n.x(), y = n.y(), r2 = n.squaredNorm();
  const Eigen::Vector2d d = camera.distort(n);
  Eigen::Matrix2d A;
  A << camera.fx, camera.skew, 0, camera.fy;
  Eigen::Matrix<double, 2, 5> by_lens;   // of the distorted coordinates
  by_lens << x * r2, x * r2 * r2, 2 * x * y, r2 + 2 * x * x, x * r2 * r2 * r2,  //
      y * r2, y * r2 * r2, r2 + 2 * y * y, 2 * x * y, y * r2 * r2 * r2;
  Eigen::Matrix<double, 2, 10> out;
  out.leftCols<5>() << d.x(), 0, d.y(), 1, 0,  //
      0, d.y(), 0, 0, 1;
  out.rightCols<5>() = A * by_lens;
  return out;
}

void addEffect(const View& view, CalibrationPart part, const Eigen::MatrixXd& d_result,
               std::vector<CalibrationEffect>* effects) {
  const auto known = std::find_if(effects->begin(), effects->end(),
                                  [&](const auto& effect) { return sameCalibration(effect, view, part); });
  if (known == effects->end()) {
    effects->push_back({&view, part, d_result});
  } else {
    known->d_result += d_result;
  }
}

Eigen::MatrixXd sharedCovariance(const std::vector<CalibrationEffect>& a, const std::vector<CalibrationEffect>& b) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(a.front().d_result.rows(), b.front().d_result.rows());
  for (const auto& ea : a) {
    for (const auto& eb : b) {
      if (!sameCalibration(ea, *eb.view, eb.part)) continue;
      if (ea.part == CalibrationPart::kPose) {
        out += ea.d_result * ea.view->pose_covariance * eb.d_result.transpose();
      } else {
        out += ea.d_result * ea.view->intrinsics_covariance * eb.d_result.transpose();
      }
    }
  }
  return out;
}

}  // namespace longarm::vision
