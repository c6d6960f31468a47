#include "calibration/solve/arrow_solver.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace longarm::calibration {
namespace {

// Solves S x = r for symmetric positive S whose entries have wildly different units (px and dimensionless).
Eigen::VectorXd solveScaled(const Eigen::MatrixXd& S, const Eigen::VectorXd& r) {
  Eigen::VectorXd scale(S.rows());
  for (Eigen::Index i = 0; i < S.rows(); ++i) scale[i] = S(i, i) > 0 ? 1 / std::sqrt(S(i, i)) : 1;
  const Eigen::MatrixXd A = scale.asDiagonal() * S * scale.asDiagonal();
  return scale.asDiagonal() * A.ldlt().solve(Eigen::VectorXd(scale.asDiagonal() * r));
}

template <typename Matrix>
Matrix damped(const Matrix& H, double lambda) {
  Matrix out = H;
  out.diagonal() *= 1 + lambda;
  return out;
}

// Inverse of a 6 x 6 block, scaled as above; a block that nothing determines stays finite.
Matrix6d inverseBlock(const Matrix6d& B) {
  Vector6d scale;
  for (int i = 0; i < 6; ++i) scale[i] = B(i, i) > 0 ? 1 / std::sqrt(B(i, i)) : 1;
  Matrix6d A = scale.asDiagonal() * B * scale.asDiagonal();
  A.diagonal().array() += 1e-15;
  return scale.asDiagonal() * Matrix6d(A.ldlt().solve(Matrix6d::Identity())) * scale.asDiagonal();
}

ArrowStep stepOf(const ArrowNormal& n, double lambda) {
  Eigen::MatrixXd S = damped(n.G, lambda);
  Eigen::VectorXd r = n.g;
  std::vector<Matrix6d> inverses;
  inverses.reserve(n.B.size());
  for (std::size_t k = 0; k < n.B.size(); ++k) {
    inverses.push_back(inverseBlock(damped(n.B[k], lambda)));
    const Eigen::MatrixXd WB = n.W[k] * inverses[k];
    S.noalias() -= WB * n.W[k].transpose();
    r.noalias() -= WB * n.b[k];
  }
  ArrowStep step;
  step.global = n.g.size() > 0 ? solveScaled(S, r) : Eigen::VectorXd();
  for (std::size_t k = 0; k < n.B.size(); ++k) {
    step.blocks.push_back(inverses[k] * (n.b[k] - n.W[k].transpose() * step.global));
  }
  return step;
}

// What the quadratic model promises: step . gradient (full Gauss-Newton step).
double predicted(const ArrowNormal& n, const ArrowStep& step) {
  double sum = n.g.size() > 0 ? step.global.dot(n.g) : 0;
  for (std::size_t k = 0; k < n.b.size(); ++k) sum += step.blocks[k].dot(n.b[k]);
  return sum;
}

bool finite(const ArrowStep& step) {
  if (!step.global.allFinite()) return false;
  for (const auto& block : step.blocks) {
    if (!block.allFinite()) return false;
  }
  return true;
}

}  // namespace

ArrowNormal::ArrowNormal(int globals, int blocks)
    : G(globals, globals),
      g(globals),
      B(static_cast<std::size_t>(blocks)),
      b(static_cast<std::size_t>(blocks)),
      W(static_cast<std::size_t>(blocks), Eigen::MatrixXd(globals, 6)) {
  setZero();
}

void ArrowNormal::setZero() {
  G.setZero();
  g.setZero();
  for (auto& m : B) m.setZero();
  for (auto& v : b) v.setZero();
  for (auto& m : W) m.setZero();
}

ArrowOutcome minimise(ArrowModel& model, const ArrowOptions& options) {
  ArrowNormal normal(model.globals(), model.blocks());
  ArrowOutcome out;
  out.cost = model.linearise(&normal);
  double lambda = 0;
  for (int trial = 0; trial < 4 * options.max_iterations && out.iterations < options.max_iterations; ++trial) {
    const ArrowStep step = stepOf(normal, lambda);
    const double promise = finite(step) ? predicted(normal, step) : std::numeric_limits<double>::infinity();
    if (promise <= options.relative_decrease * out.cost + options.absolute_decrease) {
      out.converged = true;
      return out;
    }
    const auto cost = finite(step) ? model.costAfter(step) : std::nullopt;
    if (cost && *cost <= out.cost) {
      model.accept();
      ++out.iterations;
      out.cost = model.linearise(&normal);
      lambda = lambda < 1e-8 ? 0 : 0.1 * lambda;
    } else {
      lambda = lambda == 0 ? 1e-4 : 8 * lambda;
      if (lambda > 1e12) {  // no downhill step left: at the precision of the numbers
        out.converged = cost && *cost <= out.cost * (1 + 1e-9) + 1e-18;
        return out;
      }
    }
  }
  return out;
}

Eigen::MatrixXd reducedInformation(const ArrowNormal& n) {
  Eigen::MatrixXd S = n.G;
  for (std::size_t k = 0; k < n.B.size(); ++k) {
    S.noalias() -= n.W[k] * inverseBlock(n.B[k]) * n.W[k].transpose();
  }
  return 0.5 * (S + S.transpose());
}

std::optional<ArrowCovariance> inverseOf(const ArrowNormal& n) {
  ArrowCovariance out;
  const Eigen::MatrixXd S = reducedInformation(n);
  out.global.resize(S.rows(), S.cols());
  for (Eigen::Index i = 0; i < S.rows(); ++i) {
    if (!(S(i, i) > 0)) return std::nullopt;
    out.global.col(i) = solveScaled(S, Eigen::VectorXd::Unit(S.rows(), i));
  }
  out.global = 0.5 * (out.global + out.global.transpose()).eval();
  if (!out.global.allFinite() || (S.rows() > 0 && out.global.diagonal().minCoeff() <= 0)) return std::nullopt;
  for (std::size_t k = 0; k < n.B.size(); ++k) {
    const Matrix6d inverse = inverseBlock(n.B[k]);
    const Eigen::MatrixXd WB = n.W[k] * inverse;
    out.cross.push_back(-out.global * WB);
    out.blocks.push_back(inverse + WB.transpose() * out.global * WB);
    if (!out.blocks.back().allFinite()) return std::nullopt;
  }
  return out;
}

}  // namespace longarm::calibration
