#include "calibration/pose/loop_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/solve/robust.h"

namespace longarm::calibration {
namespace {

constexpr int kObjLink = 0, kDevLink = 1, kKinLink = 2, kExtLink = 3;

// Index in LoopState::T of a link.
std::size_t stateIndex(int link) { return link == kExtLink ? 0 : link == kDevLink ? 1 : 2; }

bool isUnknown(const std::vector<LoopUnknown>& unknowns, LoopUnknown which) {
  return std::find(unknowns.begin(), unknowns.end(), which) != unknowns.end();
}

}  // namespace

LoopModel::LoopModel(const LoopProblem& problem, const std::vector<LoopUnknown>& unknowns, const LoopState& start,
                     const LensMask& lens, const std::optional<KinPrior>& prior, double sigma_px)
    : m_problem(&problem), m_free(lens.indices()), m_now(start), m_trial(start), m_prior(prior), m_sigma(sigma_px) {
  if (isUnknown(unknowns, LoopUnknown::kExt)) m_poses.push_back(kExtLink);
  if (isUnknown(unknowns, LoopUnknown::kDev)) m_poses.push_back(kDevLink);
  if (isUnknown(unknowns, LoopUnknown::kObj)) m_poses.push_back(kObjLink);
  m_now.T_kin.clear();
  for (const auto& view : problem.views) {
    m_now.T_kin.push_back(view.T_kin);
    m_weights.emplace_back(view.points.size(), 1.0);
  }
  m_trial = m_now;
}

Pose LoopModel::link(const LoopState& state, std::size_t view, int at) const {
  const LoopView& v = m_problem->views[view];
  if (at == kKinLink) return state.T_kin[view];
  if (std::find(m_poses.begin(), m_poses.end(), at) != m_poses.end()) return state.T[stateIndex(at)];
  return at == kExtLink ? v.T_ext : at == kDevLink ? v.T_dev : v.T_obj.inverse();
}

std::array<Eigen::Vector3d, 5> LoopModel::chain(const LoopState& state, std::size_t view, const Eigen::Vector3d& x) const {
  std::array<Eigen::Vector3d, 5> out;
  out[0] = x;
  for (int at = 0; at < 4; ++at) {
    out[static_cast<std::size_t>(at) + 1] = link(state, view, at) * out[static_cast<std::size_t>(at)];
  }
  return out;
}

bool LoopModel::fill(std::size_t view, std::size_t point, Eigen::Vector2d* pixel, Eigen::MatrixXd* J,
                     Eigen::Matrix<double, 2, 6>* J_kin) const {
  const auto places = chain(m_now, view, m_problem->views[view].points[point].xyz);
  LensProjection at;
  if (!projectWithDerivatives(m_now.camera, places[4], &at)) return false;
  *pixel = at.pixel;
  J->resize(2, globals());
  Eigen::Matrix<double, 2, 3> left = at.d_point;     // d pixel / d (coordinates left of the link)
  for (int l = kExtLink; l >= kObjLink; --l) {
    const Eigen::Matrix3d R = link(m_now, view, l).linear();
    Eigen::Matrix<double, 2, 6> own;
    own.leftCols<3>() = -left * skew(R * places[static_cast<std::size_t>(l)]);
    own.rightCols<3>() = left;
    if (l == kKinLink) {
      if (J_kin != nullptr) *J_kin = own;
    } else {
      const auto where = std::find(m_poses.begin(), m_poses.end(), l);
      if (where != m_poses.end()) J->middleCols<6>(6 * (where - m_poses.begin())) = own;
    }
    left = (left * R).eval();
  }
  for (std::size_t i = 0; i < m_free.size(); ++i) {
    J->col(lensOffset() + static_cast<Eigen::Index>(i)) = at.d_lens.col(m_free[i]);
  }
  return true;
}

double LoopModel::loss(double squares, double* weight) const {
  if (m_loss == Loss::kHuber) return huberCost(squares, m_threshold, weight);
  if (m_loss == Loss::kCauchy) {
    const double c2 = m_threshold * m_threshold;
    *weight = 1 / (1 + squares / c2);
    return c2 * std::log1p(squares / c2);
  }
  *weight = 1;
  return squares;
}

double LoopModel::priorCost(const LoopState& state, std::size_t view, Vector6d* residual) const {
  const Pose& given = m_problem->views[view].T_kin;
  Vector6d r;
  r.head<3>() = -logSO3(state.T_kin[view].linear() * given.linear().transpose()) / m_prior->sigma_rad;
  r.tail<3>() = (given.translation() - state.T_kin[view].translation()) / m_prior->sigma_m;
  if (residual != nullptr) *residual = r;
  return r.squaredNorm();
}

double LoopModel::linearise(ArrowNormal* normal) {
  normal->setZero();
  double cost = 0;
  Eigen::MatrixXd J;
  Eigen::Matrix<double, 2, 6> J_kin;
  Eigen::Vector2d pixel;
  const double unit = 1 / (m_sigma * m_sigma);
  for (std::size_t k = 0; k < m_problem->views.size(); ++k) {
    for (std::size_t i = 0; i < m_problem->views[k].points.size(); ++i) {
      if (m_weights[k][i] <= 0 || !fill(k, i, &pixel, &J, &J_kin)) continue;
      const Eigen::Vector2d r = m_problem->views[k].points[i].pixel - pixel;
      double robust = 1;
      cost += m_weights[k][i] * loss(r.squaredNorm() * unit, &robust);
      const double w = m_weights[k][i] * robust * unit;
      normal->G.noalias() += w * J.transpose() * J;
      normal->g.noalias() += w * J.transpose() * r;
      if (!m_prior) continue;
      normal->W[k].noalias() += w * J.transpose() * J_kin;
      normal->B[k].noalias() += w * J_kin.transpose() * J_kin;
      normal->b[k].noalias() += w * J_kin.transpose() * r;
    }
    if (!m_prior) continue;
    Vector6d r, inverse_sigma;
    inverse_sigma << Eigen::Vector3d::Constant(1 / m_prior->sigma_rad), Eigen::Vector3d::Constant(1 / m_prior->sigma_m);
    cost += priorCost(m_now, k, &r);
    normal->B[k].diagonal() += inverse_sigma.cwiseAbs2();
    normal->b[k] += r.cwiseProduct(inverse_sigma);
  }
  return cost;
}

std::optional<double> LoopModel::costAfter(const ArrowStep& step) {
  m_trial = m_now;
  for (std::size_t p = 0; p < m_poses.size(); ++p) {
    auto& T = m_trial.T[stateIndex(m_poses[p])];
    T = moved(T, step.global.segment<6>(6 * static_cast<Eigen::Index>(p)));
  }
  LensVector lens = lensVector(m_now.camera);
  for (std::size_t i = 0; i < m_free.size(); ++i) {
    lens[m_free[i]] += step.global[lensOffset() + static_cast<Eigen::Index>(i)];
  }
  if (!(lens[kFx] > 0 && lens[kFy] > 0)) return std::nullopt;
  setLensVector(lens, &m_trial.camera);
  double cost = 0;
  for (std::size_t k = 0; k < m_problem->views.size(); ++k) {
    if (m_prior) {
      m_trial.T_kin[k] = moved(m_now.T_kin[k], step.blocks[k]);
      cost += priorCost(m_trial, k, nullptr);
    }
    for (std::size_t i = 0; i < m_problem->views[k].points.size(); ++i) {
      if (m_weights[k][i] <= 0) continue;
      const auto& point = m_problem->views[k].points[i];
      Eigen::Vector2d pixel;
      if (!projectPoint(m_trial.camera, chain(m_trial, k, point.xyz)[4], &pixel)) return std::nullopt;
      double robust = 1;
      cost += m_weights[k][i] * loss((point.pixel - pixel).squaredNorm() / (m_sigma * m_sigma), &robust);
    }
  }
  return cost;
}

int LoopModel::observations() const {
  int n = 0;
  for (const auto& view : m_weights) {
    for (const double w : view) n += w > 0 ? 1 : 0;
  }
  return n;
}

void LoopModel::weighPointUncertainty(double sigma_px) {
  for (std::size_t k = 0; k < m_problem->views.size(); ++k) {
    for (std::size_t i = 0; i < m_problem->views[k].points.size(); ++i) {
      const double sigma_m = m_problem->views[k].points[i].sigma_m;
      LensProjection at;
      if (m_weights[k][i] <= 0 || sigma_m <= 0 || !projectWithDerivatives(m_now.camera, pointInCamera(k, i), &at)) continue;
      const double extra = 0.5 * at.d_point.squaredNorm() * sigma_m * sigma_m;  // mean variance of u and v
      m_weights[k][i] = sigma_px * sigma_px / (sigma_px * sigma_px + extra);
    }
  }
}

bool LoopModel::allInFront() const {
  for (std::size_t k = 0; k < m_problem->views.size(); ++k) {
    for (std::size_t i = 0; i < m_problem->views[k].points.size(); ++i) {
      if (m_weights[k][i] > 0 && !(pointInCamera(k, i).z() > 1e-6)) return false;
    }
  }
  return true;
}

Eigen::Vector2d LoopModel::residual(std::size_t view, std::size_t point) const {
  Eigen::Vector2d pixel;
  if (!projectPoint(m_now.camera, pointInCamera(view, point), &pixel)) {
    return Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  }
  return m_problem->views[view].points[point].pixel - pixel;
}

Eigen::MatrixXd LoopModel::jacobian(std::size_t view, std::size_t point) const {
  Eigen::MatrixXd J;
  Eigen::Vector2d pixel;
  if (!fill(view, point, &pixel, &J, nullptr)) return Eigen::MatrixXd::Zero(2, globals());
  return J;
}

}  // namespace longarm::calibration
