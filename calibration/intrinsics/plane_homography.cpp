#include "calibration/intrinsics/plane_homography.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace longarm::calibration {
namespace {

Eigen::Matrix3d normaliser(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& p : points) mean += p / static_cast<double>(points.size());
  double distance = 0;
  for (const auto& p : points) distance += (p - mean).norm() / static_cast<double>(points.size());
  const double scale = distance > 0 ? std::sqrt(2.0) / distance : 1;
  Eigen::Matrix3d T;
  T << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1;
  return T;
}

}  // namespace

CornerPlane planeOf(const std::vector<Corner>& corners) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& c : corners) mean += c.xyz / static_cast<double>(corners.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& c : corners) scatter += (c.xyz - mean) * (c.xyz - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter);  // smallest first
  const Eigen::Vector3d extent = eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
  CornerPlane plane;
  plane.X_KP.translation() = mean;
  plane.X_KP.linear().col(0) = eigen.eigenvectors().col(2);
  plane.X_KP.linear().col(1) = eigen.eigenvectors().col(1);
  plane.X_KP.linear().col(2) = eigen.eigenvectors().col(2).cross(eigen.eigenvectors().col(1));
  plane.flatness = extent[2] > 0 ? extent[0] / extent[2] : 0;
  plane.narrowness = extent[2] > 0 ? extent[1] / extent[2] : 0;
  return plane;
}

Eigen::Matrix3d planeHomography(const std::vector<Corner>& corners, const CornerPlane& plane,
                                const std::vector<Eigen::Vector2d>& points) {
  const Pose X_PK = plane.X_KP.inverse();
  std::vector<Eigen::Vector2d> source;
  for (const auto& c : corners) source.push_back((X_PK * c.xyz).head<2>());
  const Eigen::Matrix3d T = normaliser(points), U = normaliser(source);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(std::max<Eigen::Index>(9, 2 * static_cast<Eigen::Index>(corners.size())), 9);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d X = U * source[i].homogeneous(), q = T * points[i].homogeneous();
    const auto row = static_cast<Eigen::Index>(2 * i);
    A.block<1, 3>(row, 0) = X;
    A.block<1, 3>(row, 6) = -q.x() * X;
    A.block<1, 3>(row + 1, 3) = X;
    A.block<1, 3>(row + 1, 6) = -q.y() * X;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd h = svd.matrixV().col(8);
  Eigen::Matrix3d H;
  H << h.segment<3>(0).transpose(), h.segment<3>(3).transpose(), h.segment<3>(6).transpose();
  return T.inverse() * H * U;
}

Pose poseFromHomography(const Eigen::Matrix3d& raw) {
  const double scale = 2 / (raw.col(0).norm() + raw.col(1).norm());
  const Eigen::Matrix3d H = raw(2, 2) < 0 ? Eigen::Matrix3d(-scale * raw) : Eigen::Matrix3d(scale * raw);
  Eigen::Matrix3d M;
  M.col(0) = H.col(0);
  M.col(1) = H.col(1);
  M.col(2) = H.col(0).cross(H.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Pose X = Pose::Identity();
  X.linear() = svd.matrixU() * svd.matrixV().transpose();  // det M >= 0, so a rotation
  X.translation() = H.col(2);
  return X;
}

}  // namespace longarm::calibration
