#include "calibration/solve/lens_parameters.h"

#include <algorithm>

#include "vision/camera/lens.h"

namespace longarm::calibration {
namespace {

constexpr double kNearest = 1e-9;  // [m]

}  // namespace

const char* lensParameterName(int index) {
  static const char* const kNames[kLensParameters] = {"fx", "fy", "skew", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};
  return kNames[index];
}

LensMask LensMask::of(bool skew, int distortion) {
  LensMask mask;
  for (const int i : {kFx, kFy, kCx, kCy}) mask.free[static_cast<std::size_t>(i)] = true;
  mask.free[kSkew] = skew;
  for (int i = 0; i < distortion; ++i) mask.free[static_cast<std::size_t>(kK1 + i)] = true;
  return mask;
}

int LensMask::count() const { return static_cast<int>(std::count(free.begin(), free.end(), true)); }

std::vector<int> LensMask::indices() const {
  std::vector<int> out;
  for (int i = 0; i < kLensParameters; ++i) {
    if (free[static_cast<std::size_t>(i)]) out.push_back(i);
  }
  return out;
}

LensVector lensVector(const vision::CameraModel& camera) {
  LensVector v;
  v << camera.fx, camera.fy, camera.skew, camera.cx, camera.cy, camera.distortion[0], camera.distortion[1],
      camera.distortion[2], camera.distortion[3], camera.distortion[4];
  return v;
}

void setLensVector(const LensVector& v, vision::CameraModel* camera) {
  camera->fx = v[kFx];
  camera->fy = v[kFy];
  camera->skew = v[kSkew];
  camera->cx = v[kCx];
  camera->cy = v[kCy];
  for (int i = 0; i < 5; ++i) camera->distortion[static_cast<std::size_t>(i)] = v[kK1 + i];
}

bool projectWithDerivatives(const vision::CameraModel& c, const Eigen::Vector3d& p, LensProjection* out) {
  if (!(p.z() > kNearest)) return false;
  const double iz = 1 / p.z(), x = p.x() * iz, y = p.y() * iz;
  const auto at = vision::internal::distortWithDerivative(c.distortion, x, y);
  out->pixel = {c.fx * at.x + c.skew * at.y + c.cx, c.fy * at.y + c.cy};
  const Eigen::Matrix2d by_normalised = vision::internal::pixelByNormalised(c, at);
  out->d_point.leftCols<2>() = by_normalised * iz;
  out->d_point.col(2) = -by_normalised * Eigen::Vector2d(x * iz, y * iz);
  const double r2 = x * x + y * y, r4 = r2 * r2;
  auto& J = out->d_lens;
  J.row(0) << at.x, 0, at.y, 1, 0, 0, 0, 0, 0, 0;
  J.row(1) << 0, at.y, 0, 0, 1, 0, 0, 0, 0, 0;
  // d (distorted x, y) / d (k1 k2 p1 p2 k3)
  const double dx[5] = {x * r2, x * r4, 2 * x * y, r2 + 2 * x * x, x * r4 * r2};
  const double dy[5] = {y * r2, y * r4, r2 + 2 * y * y, 2 * x * y, y * r4 * r2};
  for (int i = 0; i < 5; ++i) {
    J(0, kK1 + i) = c.fx * dx[i] + c.skew * dy[i];
    J(1, kK1 + i) = c.fy * dy[i];
  }
  return true;
}

bool projectWithPointDerivative(const vision::CameraModel& c, const Eigen::Vector3d& p, Eigen::Vector2d* pixel,
                                Eigen::Matrix<double, 2, 3>* d_point) {
  if (!(p.z() > kNearest)) return false;
  const double iz = 1 / p.z(), x = p.x() * iz, y = p.y() * iz;
  const auto at = vision::internal::distortWithDerivative(c.distortion, x, y);
  *pixel = {c.fx * at.x + c.skew * at.y + c.cx, c.fy * at.y + c.cy};
  const Eigen::Matrix2d by_normalised = vision::internal::pixelByNormalised(c, at);
  d_point->leftCols<2>() = by_normalised * iz;
  d_point->col(2) = -by_normalised * Eigen::Vector2d(x * iz, y * iz);
  return true;
}

bool projectPoint(const vision::CameraModel& c, const Eigen::Vector3d& p, Eigen::Vector2d* pixel) {
  if (!(p.z() > kNearest)) return false;
  *pixel = c.pixelOfNormalised(p.head<2>() / p.z());
  return pixel->allFinite();
}

Pose moved(const Pose& X, const Vector6d& increment) {
  Pose out = X;
  out.linear() = expSO3(increment.head<3>()) * X.linear();
  out.translation() += increment.tail<3>();
  return out;
}

Matrix6d inverseIncrement(const Pose& X) {
  // X^-1 = (R^T, c), c = -R^T p: R^T <- Exp(-R^T w) R^T, c <- c - R^T d - [c]x (-R^T w) ...
  const Eigen::Matrix3d Rt = X.linear().transpose();
  const Eigen::Vector3d c = -Rt * X.translation();
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = -Rt;
  J.bottomLeftCorner<3, 3>() = longarm::skew(c) * Rt;
  J.bottomRightCorner<3, 3>() = -Rt;
  return J;
}

}  // namespace longarm::calibration
