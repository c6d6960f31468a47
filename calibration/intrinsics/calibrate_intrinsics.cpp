#include "calibration/intrinsics/calibrate_intrinsics.h"

#include <algorithm>
#include <cmath>

#include "calibration/intrinsics/coverage.h"
#include "calibration/intrinsics/initial_guess.h"
#include "calibration/intrinsics/plane_homography.h"
#include "calibration/intrinsics/reject_outliers.h"
#include "calibration/solve/robust.h"
#include "core/text.h"

namespace longarm::calibration {
namespace {

constexpr double kRefusedFocalSigma = 0.2;   // of the focal length itself: nothing was learned
constexpr double kPriorSigmaPx = 0.7;        // a pick by hand, where the residuals cannot tell

Error refused(const std::string& message) { return {ErrorCode::kDegenerate, message}; }

std::string placeOf(const BoardView& view, const Corner& corner) {
  return (corner.line > 0 ? "line " + std::to_string(corner.line) + ", " : "") + "view " + view.name;
}

Status checkNumbers(const std::vector<BoardView>& views, int width, int height) {
  vision::CameraModel frame;
  frame.width = width;
  frame.height = height;
  for (const auto& view : views) {
    for (const auto& c : view.corners) {
      if (!c.xyz.allFinite() || !c.pixel.allFinite()) {
        return {ErrorCode::kInvalidInput, placeOf(view, c) + ": a coordinate is not a finite number"};
      }
      if (!frame.containsPixel(c.pixel, 1)) {
        return {ErrorCode::kInvalidInput,
                placeOf(view, c) + ": pixel (" + formatFixed(c.pixel.x(), 1) + ", " + formatFixed(c.pixel.y(), 1) +
                    ") lies outside the " + std::to_string(width) + " x " + std::to_string(height) +
                    " picture; check the size and that u counts right and v down"};
      }
    }
  }
  return {};
}

bool isUsed(const std::vector<double>& weights) {
  return std::any_of(weights.begin(), weights.end(), [](double w) { return w > 0; });
}

// One picture of a plane leaves two of the intrinsics free, whatever distortion pretends to tell.
Status requireTwoPlanes(const IntrinsicsModel& model, const std::vector<BoardView>& views) {
  if (model.viewsUsed() != 1) return {};
  for (std::size_t k = 0; k < views.size(); ++k) {
    if (isUsed(model.weights()[k]) && planeOf(views[k].corners).flatness >= 0.02) return {};
  }
  return refused("one view of a flat board does not determine a camera; add views of it at other tilts (8 or more are recommended)");
}

// Rank and absolute size of what is known.
Status requireObservable(const IntrinsicsResult& result, const Eigen::MatrixXd& information, int views) {
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::VectorXd eigen = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues();
  const double sigma = std::sqrt(std::max(result.covariance(kFx, kFx), result.covariance(kFy, kFy)));
  const double part = sigma / std::min(result.camera.fx, result.camera.fy);
  const bool singular = !(eigen.minCoeff() > 1e-12 * eigen.maxCoeff()) || !std::isfinite(part);
  if (!singular && part < kRefusedFocalSigma) return {};
  return refused("the " + std::to_string(views) + (views == 1 ? " view does" : " views do") +
                 " not determine the focal length" +
                 (singular ? "" : " (known only to " + formatFixed(100 * part, 0) + " %)") +
                 ": a board seen square on says nothing about it. Add views with the board tilted 20 to 40 degrees, "
                 "about both axes");
}

void fillCovariance(const IntrinsicsModel& model, const ArrowCovariance& inverse, double variance,
                    IntrinsicsResult* result) {
  const auto free = result->estimated.indices();
  std::size_t first = 0;
  while (first < model.weights().size() && !isUsed(model.weights()[first])) ++first;
  for (std::size_t i = 0; i < free.size(); ++i) {
    for (std::size_t j = 0; j < free.size(); ++j) {
      result->covariance(free[i], free[j]) =
          variance * inverse.global(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
    result->lens_pose.row(free[i]) = variance * inverse.cross[first].row(static_cast<Eigen::Index>(i));
  }
}

void fillViews(const IntrinsicsModel& model, const ArrowCovariance& inverse, double variance,
               const std::vector<BoardView>& views, const std::vector<std::string>& why, IntrinsicsResult* result) {
  const auto residuals = model.residuals();
  for (std::size_t k = 0; k < views.size(); ++k) {
    ViewReport report;
    report.name = views[k].name;
    report.why = why[k];
    report.corners = static_cast<int>(views[k].corners.size());
    report.used = isUsed(model.weights()[k]);
    report.X_CK = model.poses()[k];
    if (report.used) report.covariance = variance * inverse.blocks[k];
    double sum = 0;
    for (std::size_t i = 0; i < residuals[k].size(); ++i) {
      sum += residuals[k][i].squaredNorm();
      report.outliers += report.used && model.weights()[k][i] <= 0 ? 1 : 0;
    }
    if (report.outliers > 0) {
      report.why = std::to_string(report.outliers) + " of " + std::to_string(report.corners) + " corners left out (beyond 4 sigma)";
      if (report.outliers * 20 > report.corners) {
        result->warnings.push_back(report.name + ": " + report.why +
                                   "; look for glare, a bent board, or a refinement window that reaches the neighbouring corners");
      }
    }
    report.rms_px = report.corners > 0 ? std::sqrt(sum / (2.0 * report.corners)) : 0;
    if (!std::isfinite(report.rms_px)) report.rms_px = -1;
    result->views.push_back(report);
  }
}

// Poses and lens of the start, with unusable views switched off.
IntrinsicsModel startModel(const std::vector<BoardView>& views, const InitialGuess& guess, const LensMask& mask) {
  IntrinsicsModel model(views, guess.camera, guess.X_CK, mask);
  for (std::size_t k = 0; k < views.size(); ++k) {
    if (!guess.why_unusable[k].empty()) std::fill(model.weights()[k].begin(), model.weights()[k].end(), 0.0);
  }
  return model;
}

// A view left out still gets the pose that fits it best, so that its residuals can be judged.
void settleUnusedViews(IntrinsicsModel* model, const std::vector<BoardView>& views) {
  for (std::size_t k = 0; k < views.size(); ++k) {
    if (isUsed(model->weights()[k])) continue;
    const std::vector<BoardView> one = {views[k]};
    const auto pose = guessPose(views[k], model->camera());
    if (!pose) continue;
    IntrinsicsModel alone(one, model->camera(), {*pose}, LensMask{});
    minimise(alone);
    model->setPose(k, alone.poses()[0]);
  }
}

Result<IntrinsicsResult> finish(IntrinsicsModel* model, const std::vector<BoardView>& views, const ChosenLens& lens,
                                const std::vector<std::string>& why) {
  IntrinsicsResult result;
  result.camera = model->camera();
  result.estimated = lens.mask;
  result.iterations = lens.outcome.iterations;
  ArrowNormal normal(model->globals(), model->blocks());
  const double cost = model->linearise(&normal);
  const int n = model->observations(), used = model->viewsUsed();
  const int dof = model->degreesOfFreedom();
  const auto inverse = inverseOf(normal);
  if (dof < 0 || !inverse) {
    return refused(std::to_string(n) + " corners in " + std::to_string(used) + " views give " + std::to_string(2 * n) +
                   " measurements that do not determine " + std::to_string(lens.mask.count() + 6 * used) +
                   " unknowns; add views of the board at other tilts");
  }
  const double variance = residualVariance(cost, dof, kPriorSigmaPx);
  result.rms_px = std::sqrt(cost / (2.0 * n));
  result.sigma_px = std::sqrt(variance);
  fillCovariance(*model, *inverse, variance, &result);
  const Eigen::MatrixXd information = reducedInformation(normal);
  if (auto status = requireObservable(result, information, used); !status) return status.error();
  const auto free = lens.mask.indices();
  for (std::size_t i = 0; i < free.size(); ++i) {
    for (std::size_t j = 0; j < free.size(); ++j) {
      result.information(free[i], free[j]) =
          information(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) / std::max(variance, 1e-12);
    }
  }
  settleUnusedViews(model, views);
  fillViews(*model, *inverse, variance, views, why, &result);
  return result;
}

}  // namespace

Result<IntrinsicsResult> calibrateIntrinsics(const std::vector<BoardView>& views, int width, int height,
                                             const IntrinsicsOptions& options) {
  if (views.empty()) return refused("no views were given; add pictures in which the board was found");
  if (auto status = checkNumbers(views, width, height); !status) return status.error();
  const InitialGuess guess = guessCamera(views, width, height);
  if (guess.usable() == 0) {
    return refused("no view can be used: " + views.front().name + ": " + guess.why_unusable.front());
  }
  std::vector<std::string> why = guess.why_unusable;
  IntrinsicsModel model = startModel(views, guess, LensMask::of(options.lens.skew.value_or(false),
                                                                options.lens.distortion.value_or(2)));
  if (options.robust) {
    rejectOutliers(&model, views, &why);
    if (!options.lens.distortion) model.clearDistortion();
  }
  if (auto status = requireTwoPlanes(model, views); !status) return status.error();
  const ChosenLens lens = chooseLens(&model, options.lens);
  auto result = finish(&model, views, lens, why);
  if (!result) return result;
  result->camera.width = width;
  result->camera.height = height;
  if (auto status = vision::validate(result->camera); !status) return refused(status.error().message);
  for (auto& text : swappedLabels(model, views)) result->warnings.push_back(std::move(text));
  appendQualityWarnings(views, &*result);
  return result;
}

}  // namespace longarm::calibration
