#include "calibration/pose/observability.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "core/text.h"

namespace longarm::calibration {
namespace {

std::string vectorText(const Eigen::Vector3d& v, int decimals) {
  std::string out = "(";
  for (int i = 0; i < 3; ++i) {
    const double value = std::abs(v[i]) < 0.5 * std::pow(10.0, -decimals) ? 0 : v[i];
    out += (i > 0 ? ", " : "") + formatFixed(value, decimals);
  }
  return out + ")";
}

// The same line either way: the largest component positive.
Eigen::Vector3d pointedUp(const Eigen::Vector3d& v) {
  Eigen::Index largest = 0;
  v.cwiseAbs().maxCoeff(&largest);
  return v[largest] < 0 ? Eigen::Vector3d(-v) : v;
}

}  // namespace

Observability observabilityOf(const Eigen::MatrixXd& information) {
  const Eigen::Index n = information.rows();
  Observability out;
  out.figures = Eigen::VectorXd::Zero(n);
  out.null_direction = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd scale(n);
  const double largest = information.diagonal().maxCoeff();
  for (Eigen::Index i = 0; i < n; ++i) {
    scale[i] = information(i, i) > 1e-18 * largest ? 1 / std::sqrt(information(i, i)) : 0;
  }
  const Eigen::MatrixXd A = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
  const double top = std::max(eigen.eigenvalues()[n - 1], 1e-300);
  for (Eigen::Index i = 0; i < n; ++i) {
    out.figures[i] = std::sqrt(std::max(0.0, eigen.eigenvalues()[n - 1 - i] / top));
    if (out.figures[i] > 1e-6) ++out.rank;
  }
  out.null_direction = scale.asDiagonal() * eigen.eigenvectors().col(0);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (scale[i] == 0) out.null_direction[i] = eigen.eigenvectors()(i, 0);
  }
  return out;
}

std::string motionInWords(const Vector6d& increment, const Pose& T, const Eigen::Vector3d& through) {
  const Eigen::Vector3d w = increment.head<3>(), d = increment.tail<3>();
  // Velocity of a point q in the left-hand frame: w x (q - p) + d, p the translation.
  const Eigen::Vector3d at_points = w.cross(through - T.translation()) + d;
  const double reach = std::max(0.1, (through - T.translation()).norm());
  if (w.norm() * reach < 0.02 * at_points.norm() || w.norm() < 1e-300) {
    return "a shift along " + vectorText(pointedUp(at_points.normalized()), 2);
  }
  const Eigen::Vector3d axis = w.normalized();
  Eigen::Vector3d point = T.translation() + w.cross(d) / w.squaredNorm();
  point += axis * axis.dot(through - point);      // the point of the axis nearest to where the points are
  const std::string turn = "a turn about the axis " + vectorText(pointedUp(axis), 2) + " through the point " + vectorText(point, 3) + " m";
  const double along = std::abs(d.dot(axis)) / w.norm();
  return along > 0.05 * reach ? turn + " together with a shift along it" : turn;
}

}  // namespace longarm::calibration
