#include "calibration/intrinsics/stereo_model.h"

#include <algorithm>
#include <limits>

namespace longarm::calibration {

StereoModel::StereoModel(const std::vector<BoardPair>& pairs, const vision::CameraModel& left, const vision::CameraModel& right,
                         const LensMask& left_mask, const LensMask& right_mask, const Pose& T_RL, std::vector<Pose> X_LK)
    : m_pairs(&pairs), m_free{left_mask.indices(), right_mask.indices()}, m_now{{left, right}, T_RL, std::move(X_LK)}, m_trial(m_now) {
  for (const auto& pair : pairs) {
    m_weights.push_back({std::vector<double>(pair.left.corners.size(), 1.0), std::vector<double>(pair.right.corners.size(), 1.0)});
  }
}

void StereoModel::addCorner(std::size_t pair, int side, std::size_t corner, ArrowNormal* normal, double* cost) const {
  const auto s = static_cast<std::size_t>(side);
  const double weight = m_weights[pair][s][corner];
  if (weight <= 0) return;
  const Corner& c = corners(pair, side)[corner];
  const Eigen::Vector3d turned = m_now.X_LK[pair].linear() * c.xyz, p_L = turned + m_now.X_LK[pair].translation();
  LensProjection at;
  if (!projectWithDerivatives(m_now.camera[s], side == 0 ? p_L : m_now.T_RL * p_L, &at)) return;
  Eigen::Matrix<double, 2, 3> by_left = at.d_point;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(2, globals());
  if (side == 1) {
    J.leftCols<3>() = -at.d_point * skew(m_now.T_RL.linear() * p_L);
    J.middleCols<3>(3) = at.d_point;
    by_left = at.d_point * m_now.T_RL.linear();
  }
  const Eigen::Index offset = 6 + (side == 1 ? static_cast<Eigen::Index>(m_free[0].size()) : 0);
  for (std::size_t i = 0; i < m_free[s].size(); ++i) J.col(offset + static_cast<Eigen::Index>(i)) = at.d_lens.col(m_free[s][i]);
  Eigen::Matrix<double, 2, 6> J_board;
  J_board.leftCols<3>() = -by_left * skew(turned);
  J_board.rightCols<3>() = by_left;
  const Eigen::Vector2d r = c.pixel - at.pixel;
  *cost += weight * r.squaredNorm();
  normal->G.noalias() += weight * J.transpose() * J;
  normal->g.noalias() += weight * J.transpose() * r;
  normal->W[pair].noalias() += weight * J.transpose() * J_board;
  normal->B[pair].noalias() += weight * J_board.transpose() * J_board;
  normal->b[pair].noalias() += weight * J_board.transpose() * r;
}

double StereoModel::linearise(ArrowNormal* normal) {
  normal->setZero();
  double cost = 0;
  for (std::size_t k = 0; k < m_pairs->size(); ++k) {
    for (int side = 0; side < 2; ++side) {
      for (std::size_t i = 0; i < corners(k, side).size(); ++i) addCorner(k, side, i, normal, &cost);
    }
  }
  return cost;
}

std::optional<double> StereoModel::costAfter(const ArrowStep& step) {
  m_trial = m_now;
  m_trial.T_RL = moved(m_now.T_RL, step.global.head<6>());
  Eigen::Index at = 6;
  for (std::size_t s = 0; s < 2; ++s) {
    LensVector lens = lensVector(m_now.camera[s]);
    for (const int i : m_free[s]) lens[i] += step.global[at++];
    if (!(lens[kFx] > 0 && lens[kFy] > 0)) return std::nullopt;
    setLensVector(lens, &m_trial.camera[s]);
  }
  double cost = 0;
  for (std::size_t k = 0; k < m_pairs->size(); ++k) {
    m_trial.X_LK[k] = moved(m_now.X_LK[k], step.blocks[k]);
    for (int side = 0; side < 2; ++side) {
      const auto s = static_cast<std::size_t>(side);
      for (std::size_t i = 0; i < corners(k, side).size(); ++i) {
        if (m_weights[k][s][i] <= 0) continue;
        const Eigen::Vector3d p_L = m_trial.X_LK[k] * corners(k, side)[i].xyz;
        Eigen::Vector2d pixel;
        if (!projectPoint(m_trial.camera[s], side == 0 ? p_L : m_trial.T_RL * p_L, &pixel)) return std::nullopt;
        cost += m_weights[k][s][i] * (corners(k, side)[i].pixel - pixel).squaredNorm();
      }
    }
  }
  return cost;
}

Eigen::Vector2d StereoModel::residual(std::size_t pair, int side, std::size_t corner) const {
  const Corner& c = corners(pair, side)[corner];
  const Eigen::Vector3d p_L = m_now.X_LK[pair] * c.xyz;
  Eigen::Vector2d pixel;
  if (!projectPoint(m_now.camera[static_cast<std::size_t>(side)], side == 0 ? p_L : m_now.T_RL * p_L, &pixel)) {
    return Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  }
  return c.pixel - pixel;
}

int StereoModel::observations() const {
  int n = 0;
  for (const auto& pair : m_weights) {
    for (const auto& side : pair) n += static_cast<int>(std::count_if(side.begin(), side.end(), [](double w) { return w > 0; }));
  }
  return n;
}

int StereoModel::pairsUsed() const {
  return static_cast<int>(std::count_if(m_weights.begin(), m_weights.end(), [](const auto& pair) {
    return std::any_of(pair[0].begin(), pair[0].end(), [](double w) { return w > 0; });
  }));
}

}  // namespace longarm::calibration
