#include "calibration/pose/solve_loop.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "calibration/pose/loop_diagnosis.h"
#include "calibration/pose/loop_starts.h"
#include "calibration/pose/observability.h"
#include "calibration/solve/robust.h"
#include "core/text.h"

namespace longarm::calibration {
namespace {

constexpr double kClickSigma = 0.7;        // of a pick by hand [px]
constexpr double kSameAnswer_rad = 0.0175;
constexpr double kDegrees = 180 / 3.14159265358979323846;

std::size_t indexOf(LoopUnknown unknown) {
  return unknown == LoopUnknown::kExt ? 0 : unknown == LoopUnknown::kDev ? 1 : 2;
}

Status checkInput(const LoopProblem& problem, const LoopOptions& options) {
  const auto& unknowns = options.unknowns;
  if (unknowns.empty()) return {ErrorCode::kInvalidInput, "nothing is to be solved; name T_ext, T_dev, T_obj or C_int"};
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    if (std::count(unknowns.begin(), unknowns.end(), unknowns[i]) > 1) {
      return {ErrorCode::kInvalidInput, std::string(toString(unknowns[i])) + " is named twice"};
    }
  }
  for (const auto& view : problem.views) {
    for (const auto& p : view.points) {
      if (!p.xyz.allFinite() || !p.pixel.allFinite()) {
        return {ErrorCode::kInvalidInput, "view " + view.name + ": a coordinate is not a finite number"};
      }
    }
  }
  return {};
}

Status requireEnough(const LoopProblem& problem, int parameters) {
  std::size_t n = 0;
  for (const auto& view : problem.views) n += view.points.size();
  const auto needed = static_cast<std::size_t>(std::max(3, (parameters + 1) / 2));
  if (n >= needed) return {};
  return {ErrorCode::kDegenerate, "only " + std::to_string(n) + (n == 1 ? " correspondence" : " correspondences") + "; at least " +
                                      std::to_string(needed) + " at distinct places, not on one line, are needed. Add points or views"};
}

struct Solved {
  LoopModel model;
  ArrowOutcome outcome;
  LensMask lens;
};

LoopModel startModel(const LoopProblem& problem, const LoopOptions& options, const LoopState& state, double sigma,
                     const LoopStarts& starts) {
  LoopModel model(problem, options.unknowns, state, LensMask{}, options.kin_prior, sigma);
  for (std::size_t k = 0; k < starts.agree.size(); ++k) {
    for (std::size_t i = 0; i < starts.agree[k].size(); ++i) model.weights()[k][i] = starts.agree[k][i] ? 1 : 0;
  }
  return model;
}

ChosenLens solveModel(LoopModel* model, const LoopOptions& options) {
  if (std::count(options.unknowns.begin(), options.unknowns.end(), LoopUnknown::kIntrinsics) > 0) return chooseLens(model, options.lens);
  return {LensMask{}, minimise(*model)};
}

// The best optimum over all starts.
std::optional<Solved> solveFromAll(const LoopProblem& problem, const LoopOptions& options, const LoopStarts& starts, double sigma) {
  std::optional<Solved> best;
  for (const auto& state : starts.states) {
    LoopModel model = startModel(problem, options, state, sigma, starts);
    if (!model.allInFront()) continue;
    const ChosenLens lens = solveModel(&model, options);
    if (!best || lens.outcome.cost < best->outcome.cost) best = Solved{model, lens.outcome, lens.mask};
  }
  return best;
}

// Leaves out what does not belong and solves again, at most a few times.
void dropOutliers(const LoopProblem& problem, const LoopOptions& options, Solved* solved) {
  for (int round = 0; round < 4; ++round) {
    std::vector<double> used, all;
    for (std::size_t k = 0; k < problem.views.size(); ++k) {
      for (std::size_t i = 0; i < problem.views[k].points.size(); ++i) {
        all.push_back(solved->model.residual(k, i).norm());
        if (solved->model.weights()[k][i] > 0) used.push_back(all.back());
      }
    }
    const double limit = outlierLimit(used, options.sigma_px);
    bool changed = false;
    std::size_t kept = 0, at = 0;
    auto weights = solved->model.weights();
    for (auto& view : weights) {
      for (auto& w : view) {
        const double now = all[at++] <= limit ? 1 : 0;
        changed = changed || (now > 0) != (w > 0);
        w = now;
        kept += now > 0 ? 1 : 0;
      }
    }
    if (!changed || kept * 2 < all.size() || kept < 5) return;
    solved->model.weights() = weights;
    if (!solved->model.allInFront()) return;
    const ChosenLens lens = solveModel(&solved->model, options);
    solved->outcome.cost = lens.outcome.cost;
    solved->outcome.iterations += lens.outcome.iterations;
    solved->lens = lens.mask;
  }
}

// Order of parameters: the model's, by the caller's unknowns; and the object's increments from those of its inverse.
Eigen::MatrixXd callersCovariance(const Eigen::MatrixXd& model_covariance, const LoopOptions& options, const LoopModel& model) {
  const Eigen::Index n = model_covariance.rows();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, n);
  Eigen::Index row = 0;
  const auto poses = unknownPoses(options);
  const auto place = [&](LoopUnknown u) {   // model order: T_ext, T_dev, T_obj
    Eigen::Index at = 0;
    for (const LoopUnknown other : poses) at += indexOf(other) < indexOf(u) ? 6 : 0;
    return at;
  };
  for (const LoopUnknown unknown : options.unknowns) {
    if (unknown == LoopUnknown::kIntrinsics) {
      const Eigen::Index lens = n - model.lensOffset();
      J.block(row, model.lensOffset(), lens, lens).setIdentity();
      row += lens;
      continue;
    }
    const bool inverted = unknown == LoopUnknown::kObj;
    J.block<6, 6>(row, place(unknown)) = inverted ? inverseIncrement(model.state().T[2]) : Matrix6d(Matrix6d::Identity());
    row += 6;
  }
  return J * model_covariance * J.transpose();
}

void fillObservations(const LoopProblem& problem, const Solved& solved, const Eigen::MatrixXd& covariance, LoopResult* out) {
  const double variance = out->sigma_px * out->sigma_px;
  for (std::size_t k = 0; k < problem.views.size(); ++k) {
    for (std::size_t i = 0; i < problem.views[k].points.size(); ++i) {
      LoopObservation o;
      o.view = static_cast<int>(k);
      o.point = static_cast<int>(i);
      o.residual_px = solved.model.residual(k, i);
      o.used = solved.model.weights()[k][i] > 0;
      const Eigen::MatrixXd J = solved.model.jacobian(k, i);
      const Eigen::Matrix2d h = variance > 0 ? Eigen::Matrix2d(J * covariance * J.transpose() * (solved.model.weights()[k][i] / variance))
                                             : Eigen::Matrix2d(Eigen::Matrix2d::Zero());
      o.leverage = std::clamp(0.5 * h.trace(), 0.0, 1.0);
      const Eigen::Matrix2d left = Eigen::Matrix2d::Identity() - h;
      o.leave_one_out_px = std::abs(left.determinant()) > 1e-9 ? (left.inverse() * o.residual_px).norm() : -1;
      out->observations.push_back(o);
    }
  }
}

// sigma_px as given, unless the residuals contradict it; else from the residuals.
double noiseOf(const LoopOptions& options, double cost_px, int dof, std::vector<std::string>* warnings) {
  if (!options.sigma_px) return std::sqrt(residualVariance(cost_px, dof, kClickSigma));
  const double given = *options.sigma_px;
  const double ratio = dof > 0 ? cost_px / (dof * given * given) : 1;
  if (ratio < 1 + 4 * std::sqrt(2.0 / std::max(1, dof))) return given;
  warnings->push_back("the residuals are " + formatFixed(std::sqrt(ratio), 1) + " times larger than sigma_px " + formatNumber(given) +
                      " px; the covariance is scaled up. Check the transforms, the camera and the points");
  return std::sqrt(cost_px / dof);
}

void warnOfWeakness(const LoopOptions& options, LoopResult* out) {
  Eigen::Index row = 0;
  for (const LoopUnknown unknown : options.unknowns) {
    if (unknown == LoopUnknown::kIntrinsics) break;
    const double turn = kDegrees * std::sqrt(std::max(0.0, out->covariance.block<3, 3>(row, row).trace()));
    const double shift = 1e3 * std::sqrt(std::max(0.0, out->covariance.block<3, 3>(row + 3, row + 3).trace()));
    if (turn > 0.2 || shift > 3) {
      out->warnings.push_back(std::string(toString(unknown)) + " is known only to " + formatFixed(turn, 2) + " degrees and " + formatFixed(shift, 1) +
                              " mm (1 sigma; 0.2 degrees and 3 mm are good); add points or views, farther apart");
    }
    row += 6;
  }
  const double smallest = out->observability.size() > 0 ? out->observability.minCoeff() : 1;
  if (smallest < 3e-3) {
    out->warnings.push_back("nearly unobservable (" + formatFixed(1e3 * smallest, 2) + "e-3): the weakest motion is " + out->weakest);
  }
}

void addAlternatives(const LoopOptions& options, const LoopStarts& starts, const Solved& solved, LoopResult* out) {
  const auto poses = unknownPoses(options);
  if (poses.size() != 1 || options.unknowns.size() != 1 || starts.minima.size() < 2) return;
  const int n = std::max(1, solved.model.observations());
  const double best = starts.minima.front().cost, variance = std::max(out->sigma_px * out->sigma_px, 1e-6);
  const Pose answer = out->T[indexOf(poses.front())];
  for (const auto& minimum : starts.minima) {
    if (minimum.cost - best > 10 * variance) break;
    const Pose T = poses.front() == LoopUnknown::kObj ? minimum.T.inverse() : minimum.T;
    if (angleBetween(T.linear(), answer.linear()) > kSameAnswer_rad) out->alternatives.push_back({T, std::sqrt(minimum.cost / (2.0 * n))});
  }
  if (!out->alternatives.empty()) {
    out->warnings.push_back("ambiguous: " + std::to_string(out->alternatives.size()) + " other pose(s) fit as well (see alternatives); "
                            "compare them with the picture, or add a point off the plane of the others");
  }
}

Result<LoopResult> finish(const LoopProblem& problem, const LoopOptions& options, const LoopStarts& starts, Solved* solved, double sigma) {
  LoopResult out;
  ArrowNormal normal(solved->model.globals(), solved->model.blocks());
  const double cost = solved->model.linearise(&normal) * sigma * sigma;    // in px^2
  const Eigen::MatrixXd information = reducedInformation(normal);
  const Observability seen = observabilityOf(information);
  out.observability = seen.figures;
  out.weakest = weakestInWords(problem, options, solved->model, seen);
  if (seen.rank < information.rows()) return undetermined(options, seen, out.weakest);
  const int n = solved->model.observations(), dof = solved->model.degreesOfFreedom();
  if (dof < 0) return requireEnough(problem, solved->model.globals()).error();
  const auto inverse = inverseOf(normal);
  if (!inverse) return undetermined(options, seen, out.weakest);
  out.sigma_px = noiseOf(options, cost, dof, &out.warnings);
  out.reduced_chi2 = dof > 0 ? cost / (dof * out.sigma_px * out.sigma_px) : 1;
  double squares = 0;
  for (std::size_t k = 0; k < problem.views.size(); ++k) {
    for (std::size_t i = 0; i < problem.views[k].points.size(); ++i) {
      if (solved->model.weights()[k][i] > 0) squares += solved->model.residual(k, i).squaredNorm();
    }
  }
  out.rms_px = std::sqrt(squares / (2.0 * std::max(1, n)));
  const Eigen::MatrixXd covariance = inverse->global * (out.sigma_px * out.sigma_px) / (sigma * sigma);
  out.covariance = callersCovariance(covariance, options, solved->model);
  out.T = solved->model.state().T;
  out.T[2] = out.T[2].inverse();
  out.camera = solved->model.camera();
  out.lens = solved->lens;
  out.iterations = solved->outcome.iterations;
  fillObservations(problem, *solved, covariance, &out);
  warnOfWeakness(options, &out);
  addAlternatives(options, starts, *solved, &out);
  const auto dropped = std::count_if(out.observations.begin(), out.observations.end(), [](const LoopObservation& o) { return !o.used; });
  if (dropped > 0) out.warnings.push_back(std::to_string(dropped) + " observations do not belong and were left out; see per_observation");
  return out;
}

}  // namespace

Result<LoopResult> solveLoop(const LoopProblem& problem, const LoopOptions& options) {
  if (auto status = checkInput(problem, options); !status) return status.error();
  const auto poses = unknownPoses(options);
  const bool lens = poses.size() < options.unknowns.size();
  if (auto status = requireEnough(problem, 6 * static_cast<int>(poses.size()) + (lens ? 4 : 0)); !status) return status.error();
  auto starts = loopStarts(problem, options);
  if (!starts) return explainMisfit(problem, options, starts.error());
  if (options.chosen && poses.size() == 1 && !lens) {
    starts->states.resize(1);
    starts->states.front().T[indexOf(poses.front())] = poses.front() == LoopUnknown::kObj ? Pose(options.chosen->inverse()) : *options.chosen;
  }
  const double sigma = options.kin_prior ? options.sigma_px.value_or(0.5) : 1;
  auto solved = solveFromAll(problem, options, *starts, sigma);
  if (!solved) {
    return explainMisfit(problem, options, {ErrorCode::kNoSolution, "a point would be behind the camera; check the labels and the direction of "
                                                                    "each transform (it maps its right-hand frame into its left-hand one)"});
  }
  if (options.robust) dropOutliers(problem, options, &*solved);
  if (auto status = refuseMislabelled(problem, options, solved->model); !status) return status.error();
  for (int round = 0; round < 2; ++round) {
    bool uncertain = false;
    for (const auto& view : problem.views) {
      for (const auto& p : view.points) uncertain = uncertain || p.sigma_m > 0;
    }
    if (!uncertain) break;
    solved->model.weighPointUncertainty(options.sigma_px.value_or(kClickSigma));
    solved->outcome.cost = minimise(solved->model).cost;
  }
  return finish(problem, options, *starts, &*solved, sigma);
}

}  // namespace longarm::calibration
