#include "calibration/intrinsics/intrinsics_model.h"

#include <algorithm>
#include <limits>

#include "calibration/solve/robust.h"

namespace longarm::calibration {
namespace {

// Everything one view adds, over all ten lens parameters; the free ones are picked afterwards.
struct ViewSums {
  LensMatrix G = LensMatrix::Zero();
  LensVector g = LensVector::Zero();
  Eigen::Matrix<double, kLensParameters, 6> W = Eigen::Matrix<double, kLensParameters, 6>::Zero();
  Matrix6d B = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double cost = 0;
};

// d (point in the camera) / d (increment of X_CK), times d_point.
Eigen::Matrix<double, 2, 6> byPose(const Eigen::Matrix<double, 2, 3>& d_point, const Eigen::Vector3d& turned) {
  Eigen::Matrix<double, 2, 6> J;
  J.leftCols<3>() = -d_point * skew(turned);
  J.rightCols<3>() = d_point;
  return J;
}

ViewSums sumsOf(const BoardView& view, const std::vector<double>& weights, const vision::CameraModel& camera,
                const Pose& X_CK, double huber) {
  ViewSums sums;
  LensProjection projection;
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    if (weights[i] <= 0) continue;
    const Eigen::Vector3d turned = X_CK.linear() * view.corners[i].xyz;
    if (!projectWithDerivatives(camera, turned + X_CK.translation(), &projection)) continue;
    const Eigen::Vector2d r = view.corners[i].pixel - projection.pixel;
    double robust = 1;
    sums.cost += weights[i] * huberCost(r.squaredNorm(), huber, &robust);
    const double w = weights[i] * robust;
    const auto J = byPose(projection.d_point, turned);
    const auto& L = projection.d_lens;
    sums.G.noalias() += w * L.transpose() * L;
    sums.W.noalias() += w * L.transpose() * J;
    sums.B.noalias() += w * J.transpose() * J;
    sums.g.noalias() += w * L.transpose() * r;
    sums.b.noalias() += w * J.transpose() * r;
  }
  return sums;
}

}  // namespace

IntrinsicsModel::IntrinsicsModel(const std::vector<BoardView>& views, const vision::CameraModel& camera,
                                 std::vector<Pose> X_CK, const LensMask& mask)
    : m_views(&views), m_now{camera, std::move(X_CK)}, m_trial(m_now), m_free(mask.indices()) {
  for (const auto& view : views) m_weights.emplace_back(view.corners.size(), 1.0);
}

double IntrinsicsModel::linearise(ArrowNormal* normal) {
  normal->setZero();
  double cost = 0;
  const auto n = static_cast<Eigen::Index>(m_free.size());
  for (std::size_t k = 0; k < m_views->size(); ++k) {
    const ViewSums sums = sumsOf((*m_views)[k], m_weights[k], m_now.camera, m_now.X_CK[k], m_huber);
    cost += sums.cost;
    normal->B[k] = sums.B;
    normal->b[k] = sums.b;
    for (Eigen::Index i = 0; i < n; ++i) {
      const int a = m_free[static_cast<std::size_t>(i)];
      normal->g[i] += sums.g[a];
      normal->W[k].row(i) = sums.W.row(a);
      for (Eigen::Index j = 0; j < n; ++j) normal->G(i, j) += sums.G(a, m_free[static_cast<std::size_t>(j)]);
    }
  }
  return cost;
}

std::optional<double> IntrinsicsModel::costAfter(const ArrowStep& step) {
  m_trial = m_now;
  LensVector lens = lensVector(m_now.camera);
  for (std::size_t i = 0; i < m_free.size(); ++i) lens[m_free[i]] += step.global[static_cast<Eigen::Index>(i)];
  if (!(lens[kFx] > 0 && lens[kFy] > 0)) return std::nullopt;
  setLensVector(lens, &m_trial.camera);
  double cost = 0;
  for (std::size_t k = 0; k < m_views->size(); ++k) {
    m_trial.X_CK[k] = moved(m_now.X_CK[k], step.blocks[k]);
    for (std::size_t i = 0; i < (*m_views)[k].corners.size(); ++i) {
      if (m_weights[k][i] <= 0) continue;
      Eigen::Vector2d pixel;
      if (!projectPoint(m_trial.camera, m_trial.X_CK[k] * (*m_views)[k].corners[i].xyz, &pixel)) return std::nullopt;
      double robust = 1;
      cost += m_weights[k][i] * huberCost(((*m_views)[k].corners[i].pixel - pixel).squaredNorm(), m_huber, &robust);
    }
  }
  return cost;
}

void IntrinsicsModel::accept() { m_now = m_trial; }

std::vector<std::vector<Eigen::Vector2d>> IntrinsicsModel::residuals() const {
  std::vector<std::vector<Eigen::Vector2d>> out;
  for (std::size_t k = 0; k < m_views->size(); ++k) {
    out.emplace_back();
    for (const auto& corner : (*m_views)[k].corners) {
      Eigen::Vector2d pixel(std::numeric_limits<double>::infinity(), 0);
      projectPoint(m_now.camera, m_now.X_CK[k] * corner.xyz, &pixel);
      out.back().push_back(corner.pixel - pixel);
    }
  }
  return out;
}

int IntrinsicsModel::observations() const {
  int n = 0;
  for (const auto& view : m_weights) {
    for (const double w : view) n += w > 0 ? 1 : 0;
  }
  return n;
}

int IntrinsicsModel::viewsUsed() const {
  return static_cast<int>(std::count_if(m_weights.begin(), m_weights.end(), [](const std::vector<double>& view) {
    return std::any_of(view.begin(), view.end(), [](double w) { return w > 0; });
  }));
}

}  // namespace longarm::calibration
