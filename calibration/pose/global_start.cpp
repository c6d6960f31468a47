#include "calibration/pose/global_start.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "calibration/pose/rotation_descent.h"

namespace longarm::calibration {
namespace {

constexpr double kMeeting2 = 2e-5;         // squared difference of rotations 3 mrad apart

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

// r^T M r + 2 g^T r + constant over the column-wise entries r of R; translation = t0 - L r.
struct RotationForm {
  Matrix9 M = Matrix9::Zero();
  Vector9 g = Vector9::Zero();
  double constant = 0;
  Eigen::Vector3d t0 = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 3, 9> L = Eigen::Matrix<double, 3, 9>::Zero();

  double at(const Vector9& r) const { return r.dot(M * r) + 2 * g.dot(r) + constant; }
};

RotationForm formOf(const std::vector<RayToPoint>& observations) {
  RotationForm f;
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d Wc = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 3, 9> K = Eigen::Matrix<double, 3, 9>::Zero();
  for (const auto& o : observations) {
    const Eigen::Matrix3d W = Eigen::Matrix3d::Identity() - o.direction * o.direction.transpose();
    const Eigen::Vector3d wc = W * o.origin;
    A += W;
    Wc += wc;
    f.constant += o.origin.dot(wc);
    for (int a = 0; a < 3; ++a) {
      K.block<3, 3>(0, 3 * a) += o.y[a] * W;
      f.g.segment<3>(3 * a) -= o.y[a] * wc;
      for (int b = 0; b < 3; ++b) f.M.block<3, 3>(3 * a, 3 * b) += o.y[a] * o.y[b] * W;
    }
  }
  const Eigen::Matrix3d Ai = A.ldlt().solve(Eigen::Matrix3d::Identity());
  f.t0 = Ai * Wc;
  f.L = Ai * K;
  f.M -= K.transpose() * f.L;
  f.g += K.transpose() * f.t0;
  f.constant -= Wc.dot(f.t0);
  return f;
}

Vector9 entries(const Eigen::Matrix3d& R) { return Eigen::Map<const Vector9>(R.data()); }

// Levenberg-Marquardt on the sphere of rotations; the cost at the end.
double descend(const RotationForm& f, Eigen::Matrix3d* R) {
  double cost = f.at(entries(*R)), damping = 1e-6;
  const double scale = f.M.trace();
  for (int i = 0; i < 40; ++i) {
    Eigen::Matrix<double, 9, 3> D;
    for (int a = 0; a < 3; ++a) D.block<3, 3>(3 * a, 0) = -skew(R->col(a));
    const Eigen::Vector3d gradient = D.transpose() * (f.M * entries(*R) + f.g);
    Eigen::Matrix3d H = D.transpose() * f.M * D;
    H.diagonal().array() += damping * scale;
    Eigen::Vector3d w = -H.ldlt().solve(gradient);
    if (!w.allFinite()) break;
    if (w.norm() > 0.8) w *= 0.8 / w.norm();
    const Eigen::Matrix3d trial = expSO3(w) * *R;
    const double trial_cost = f.at(entries(trial));
    if (trial_cost <= cost) {
      *R = trial;
      cost = trial_cost;
      damping = std::max(1e-12, 0.1 * damping);
      if (w.norm() < 1e-9) break;
    } else {
      damping *= 10;
      if (damping > 1e3) break;
    }
  }
  return cost;
}

// The 24 descents together until they are nearly there; of those that meet, one goes on.
std::vector<Eigen::Matrix3d> distinctMinima(const RotationForm& form) {
  internal::RotationCost cost;
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) cost.M[i][j] = form.M(i, j);
    cost.g[i] = form.g[i];
  }
  internal::Rotations at;
  const auto& starts = cubeRotations();
  for (int k = 0; k < internal::kDescents; ++k) {
    for (int i = 0; i < 9; ++i) at.R[i][k] = starts[static_cast<std::size_t>(k)].data()[i];
  }
  internal::descendTogether(cost, &at);
  std::vector<Eigen::Matrix3d> out;
  for (int k = 0; k < internal::kDescents; ++k) {
    Eigen::Matrix3d R;
    for (int i = 0; i < 9; ++i) R.data()[i] = at.R[i][k];
    if (!R.allFinite()) continue;
    const bool known = std::any_of(out.begin(), out.end(), [&](const Eigen::Matrix3d& other) { return (other - R).squaredNorm() < kMeeting2; });
    if (!known) out.push_back(R);
  }
  return out;
}

}  // namespace

const std::vector<Eigen::Matrix3d>& cubeRotations() {
  static const std::vector<Eigen::Matrix3d> rotations = [] {
    std::vector<Eigen::Matrix3d> out;
    int order[3] = {0, 1, 2};
    do {
      for (int signs = 0; signs < 8; ++signs) {
        Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
        for (int row = 0; row < 3; ++row) R(row, order[row]) = (signs >> row & 1) != 0 ? -1 : 1;
        if (R.determinant() > 0) out.push_back(R);
      }
    } while (std::next_permutation(order, order + 3));
    return out;
  }();
  return rotations;
}

std::vector<RayFit> fitRays(const std::vector<RayToPoint>& observations) {
  const RotationForm form = formOf(observations);
  std::vector<RayFit> found;
  for (Eigen::Matrix3d R : distinctMinima(form)) {
    const double misses = descend(form, &R);
    if (!R.allFinite() || !std::isfinite(misses)) continue;
    const bool known = std::any_of(found.begin(), found.end(), [&](const RayFit& f) {
      return (f.T.linear() - R).squaredNorm() < 1e-6;
    });
    if (known) continue;
    RayFit fit{Pose::Identity(), misses};
    fit.T.linear() = R;
    fit.T.translation() = form.t0 - form.L * entries(R);
    found.push_back(fit);
  }
  std::stable_sort(found.begin(), found.end(), [](const RayFit& a, const RayFit& b) { return a.misses < b.misses; });
  return found;
}

}  // namespace longarm::calibration
