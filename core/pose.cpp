#include "core/pose.h"

#include <algorithm>
#include <cmath>

namespace longarm {

Pose poseFrom(const Eigen::Vector3d& xyz, const Eigen::Vector4d& quaternion_xyzw) {
  Pose X = Pose::Identity();
  const Eigen::Quaterniond q(quaternion_xyzw[3], quaternion_xyzw[0], quaternion_xyzw[1],
                             quaternion_xyzw[2]);
  X.linear() = q.normalized().toRotationMatrix();
  X.translation() = xyz;
  return X;
}

Pose poseFromRpy(const Eigen::Vector3d& xyz, const Eigen::Vector3d& rpy) {
  Pose X = Pose::Identity();
  X.linear() = (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  X.translation() = xyz;
  return X;
}

Eigen::Vector4d quaternionXyzw(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  q.normalize();
  Eigen::Vector4d out = q.coeffs();
  return out[3] < 0 ? Eigen::Vector4d(-out) : out;
}

Eigen::Matrix3d skew(const Eigen::Vector3d& w) {
  Eigen::Matrix3d S;
  S << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return S;
}

Eigen::Matrix3d expSO3(const Eigen::Vector3d& rotvec) {
  const double angle = rotvec.norm();
  const Eigen::Matrix3d W = skew(rotvec);
  // Taylor forms below 1e-5 rad: the closed forms lose digits there.
  const double a = angle < 1e-5 ? 1.0 - angle * angle / 6.0 : std::sin(angle) / angle;
  const double half = std::sin(angle / 2);
  const double b = angle < 1e-5 ? 0.5 - angle * angle / 24.0 : 2.0 * half * half / (angle * angle);
  return Eigen::Matrix3d::Identity() + a * W + b * W * W;
}

Eigen::Vector3d logSO3(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(R).normalized();
  const Eigen::Vector3d v = q.w() < 0 ? Eigen::Vector3d(-q.vec()) : Eigen::Vector3d(q.vec());
  const double s = v.norm();
  const double w = std::abs(q.w());
  if (s < 1e-9) return 2.0 * v;  // w is 1 here
  return v * (2.0 * std::atan2(s, w) / s);
}

double angleBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return logSO3(a.transpose() * b).norm();
}

Pose interpolate(const Pose& a, const Pose& b, double s) {
  Pose X = Pose::Identity();
  X.translation() = a.translation() + s * (b.translation() - a.translation());
  X.linear() = a.linear() * expSO3(s * logSO3(a.linear().transpose() * b.linear()));
  return X;
}

Eigen::Matrix3d rotationWithZ(const Eigen::Vector3d& z) {
  const Eigen::Vector3d n = z.normalized();
  const Eigen::Vector3d seed =
      std::abs(n.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  Eigen::Matrix3d R;
  R.col(2) = n;
  R.col(0) = (seed - seed.dot(n) * n).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

bool isRigid(const Pose& X, double tolerance) {
  if (!X.matrix().allFinite()) return false;
  const Eigen::Matrix3d R = X.linear();
  return (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < tolerance &&
         R.determinant() > 0;
}

}  // namespace longarm
