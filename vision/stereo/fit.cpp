#include "vision/stereo/fit.h"

#include <cmath>

#include <Eigen/Dense>

namespace longarm::vision::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMaxIterations = 60;
constexpr Eigen::Index kMaxRowsForFullChi2 = 600;

VectorXd weights(const FitRows& rows) { return rows.sigma.array().square().inverse(); }

double cost(const FitRows& rows) { return (rows.residual.array() / rows.sigma.array()).square().sum(); }

// Gauss-Newton, damped only where a step fails.
void minimise(const FitProblem& problem, VectorXd* state, FitRows* rows) {
  double damping = 0;
  for (int i = 0; i < kMaxIterations; ++i) {
    const MatrixXd weighted = weights(*rows).asDiagonal() * rows->d_state;
    MatrixXd H = rows->d_state.transpose() * weighted;
    H.diagonal() *= 1 + damping;
    const VectorXd step = H.ldlt().solve(weighted.transpose() * rows->residual);
    if (!step.allFinite()) return;
    const VectorXd moved = problem.plus(*state, step);
    auto next = problem.rows(moved);
    const double before = cost(*rows);
    if (!next || !(cost(*next) <= before + 1e-12 * (1 + before))) {
      damping = damping == 0 ? 1e-3 : damping * 10;
      if (damping > 1e8) return;
      continue;
    }
    *state = moved;
    *rows = std::move(*next);
    damping = damping > 1e-6 ? damping * 0.1 : 0;
    if (step.squaredNorm() * 1e24 < 1 + state->squaredNorm()) return;
  }
}

// Effects of the calibration of each view on the step, gain (n x m) rows at a time.
std::vector<CalibrationEffect> effectsOf(const FitRows& rows, const MatrixXd& gain) {
  std::vector<CalibrationEffect> effects;
  for (Eigen::Index row = 0; row < rows.residual.size(); ++row) {
    const View& view = *rows.views[static_cast<std::size_t>(row)];
    if (knowsPoseError(view)) {
      addEffect(view, CalibrationPart::kPose, gain.col(row) * rows.d_pose.row(row), &effects);
    }
    if (knowsIntrinsicsError(view)) {
      addEffect(view, CalibrationPart::kIntrinsics, gain.col(row) * rows.d_intrinsics.row(row), &effects);
    }
  }
  return effects;
}

// Covariance of the residuals themselves: pick noise and what the calibrations do to all rows together.
MatrixXd residualCovariance(const FitRows& rows) {
  const Eigen::Index m = rows.residual.size();
  MatrixXd V = rows.sigma.array().square().matrix().asDiagonal();
  const auto effects = effectsOf(rows, MatrixXd::Identity(m, m));
  if (!effects.empty()) V += sharedCovariance(effects, effects);
  return V;
}

// The minimum of r^T V^-1 r over the state, linearised: V need not be what the picks were weighted with.
double chiSquare(const FitRows& rows) {
  if (rows.residual.size() > kMaxRowsForFullChi2) return cost(rows);
  const Eigen::LLT<MatrixXd> root(residualCovariance(rows));
  const VectorXd r = root.matrixL().solve(rows.residual);
  const MatrixXd J = root.matrixL().solve(rows.d_state);
  const VectorXd rest = r - J * J.colPivHouseholderQr().solve(r);
  return rest.squaredNorm();
}

}  // namespace

void FitRows::resize(int rows, int states) {
  residual.setZero(rows);
  sigma.setOnes(rows);
  d_state.setZero(rows, states);
  d_pose.setZero(rows, 6);
  d_intrinsics.setZero(rows, 10);
  views.assign(static_cast<std::size_t>(rows), nullptr);
}

MatrixXd FitResult::covariance() const {
  if (effects.empty()) return picks_covariance;
  return picks_covariance + sharedCovariance(effects, effects);
}

double FitResult::rmsPx() const {
  return rows.residual.size() == 0 ? 0 : std::sqrt(rows.residual.squaredNorm() / static_cast<double>(rows.residual.size()));
}

Result<FitResult> fit(const FitProblem& problem, const VectorXd& start) {
  FitResult out;
  out.state = start;
  auto rows = problem.rows(start);
  if (!rows) return rows.error();
  out.rows = std::move(*rows);
  minimise(problem, &out.state, &out.rows);
  const Eigen::Index m = out.rows.residual.size(), n = out.rows.d_state.cols();
  const MatrixXd weighted = weights(out.rows).asDiagonal() * out.rows.d_state;
  const MatrixXd H = out.rows.d_state.transpose() * weighted;
  const VectorXd scale = H.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();   // metres beside radians
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(MatrixXd(scale.asDiagonal() * H * scale.asDiagonal()));
  if (m < n || eigen.info() != Eigen::Success || !(eigen.eigenvalues()[0] > 1e-13 * eigen.eigenvalues()[n - 1])) {
    return Error{ErrorCode::kDegenerate, "the picks do not determine the shape: mark it in another view, taken from the side"};
  }
  const MatrixXd inverse = eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
  out.picks_covariance = scale.asDiagonal() * inverse * scale.asDiagonal();
  out.effects = effectsOf(out.rows, -out.picks_covariance * weighted.transpose());
  out.degrees_of_freedom = static_cast<int>(m - n);
  out.chi2 = chiSquare(out.rows);
  return out;
}

}  // namespace longarm::vision::internal
