#include "calibration/intrinsics/stereo_pair.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

#include "calibration/intrinsics/initial_guess.h"
#include "calibration/intrinsics/intrinsics_model.h"
#include "calibration/intrinsics/stereo_model.h"
#include "calibration/solve/robust.h"
#include "core/text.h"

namespace longarm::calibration {
namespace {

constexpr double kNoiseFloorPx = 0.02;

// Pose of a board seen by one camera, and what the numbering from the other end gives.
struct Seen {
  std::optional<Pose> pose, reversed;
  std::string why;
};

BoardView reversed(const BoardView& view) {
  BoardView out = view;
  const std::size_t n = view.corners.size();
  for (std::size_t i = 0; i < n; ++i) out.corners[i].xyz = view.corners[n - 1 - i].xyz;
  return out;
}

Result<Pose> poseOfBoard(const BoardView& view, const vision::CameraModel& camera) {
  const auto guess = guessPose(view, camera);
  if (!guess) return guess;
  const std::vector<BoardView> one = {view};
  IntrinsicsModel model(one, camera, {*guess}, LensMask{});
  minimise(model);
  return model.poses().front();
}

Seen seenBy(const BoardView& view, const vision::CameraModel& camera, bool both) {
  Seen out;
  const auto pose = poseOfBoard(view, camera);
  if (!pose) {
    out.why = pose.error().message;
    return out;
  }
  out.pose = *pose;
  if (!both) return out;
  if (const auto other = poseOfBoard(reversed(view), camera)) out.reversed = *other;
  return out;
}

double distance(const Pose& a, const Pose& b) {
  return angleBetween(a.linear(), b.linear()) + (a.translation() - b.translation()).norm() / std::max(0.02, a.translation().norm());
}

// Starts of the bundle: T_RL that most pairs agree on, boards in the left camera, and right views renumbered.
struct Starts {
  Pose T_RL = Pose::Identity();
  std::vector<Pose> X_LK;
  std::vector<BoardPair> pairs;
  std::vector<std::string> why;
  int usable = 0;
};

Starts startsOf(const std::vector<BoardPair>& pairs, const vision::CameraModel& left, const vision::CameraModel& right) {
  Starts out;
  out.pairs = pairs;
  std::vector<std::vector<Pose>> candidates;
  for (const auto& pair : pairs) {
    const Seen l = seenBy(pair.left, left, false), r = seenBy(pair.right, right, true);
    candidates.emplace_back();
    out.X_LK.push_back(l.pose.value_or(Pose::Identity()));
    out.why.push_back(l.pose ? r.why : l.why);
    if (!l.pose || !r.pose) continue;
    ++out.usable;
    candidates.back().push_back(*r.pose * l.pose->inverse());
    if (r.reversed) candidates.back().push_back(*r.reversed * l.pose->inverse());
  }
  double best = 1e300;
  for (const auto& own : candidates) {
    for (const Pose& T : own) {
      double sum = 0;
      for (const auto& others : candidates) {
        double nearest = others.empty() ? 0 : 1e9;
        for (const Pose& other : others) nearest = std::min(nearest, distance(T, other));
        sum += std::min(nearest, 0.5);
      }
      if (sum < best) {
        best = sum;
        out.T_RL = T;
      }
    }
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (candidates[k].size() == 2 && distance(out.T_RL, candidates[k][1]) < distance(out.T_RL, candidates[k][0])) {
      out.pairs[k].right = reversed(pairs[k].right);
    }
  }
  return out;
}

LensMask refinedMask(const vision::CameraModel& camera) {
  LensMask mask = LensMask::of(camera.skew != 0, 0);
  for (std::size_t i = 0; i < 5; ++i) mask.free[static_cast<std::size_t>(kK1) + i] = camera.distortion[i] != 0;
  return mask;
}

double rmsOfPair(const StereoModel& model, const BoardPair& pair, std::size_t k) {
  double sum = 0;
  for (std::size_t i = 0; i < pair.left.corners.size(); ++i) sum += model.residual(k, 0, i).squaredNorm();
  for (std::size_t i = 0; i < pair.right.corners.size(); ++i) sum += model.residual(k, 1, i).squaredNorm();
  return std::sqrt(sum / (2.0 * static_cast<double>(std::max<std::size_t>(1, pair.left.corners.size() + pair.right.corners.size()))));
}

void switchOff(StereoModel* model, std::size_t k) {
  for (auto& side : model->weights()[k]) std::fill(side.begin(), side.end(), 0.0);
}

bool isUsed(StereoModel* model, std::size_t k) {
  const auto& side = model->weights()[k][0];
  return std::any_of(side.begin(), side.end(), [](double w) { return w > 0; });
}

// Leaves out pairs that stand out, worst first, then single corners beyond 4 sigma.
void rejectPairs(StereoModel* model, const std::vector<BoardPair>& pairs, std::vector<std::string>* why, int* iterations) {
  for (std::size_t dropped = 0; dropped < pairs.size() / 3; ++dropped) {
    std::vector<double> rms;
    std::size_t worst = 0;
    double largest = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      if (!isUsed(model, k)) continue;
      rms.push_back(rmsOfPair(*model, pairs[k], k));
      if (rms.back() > largest) {
        largest = rms.back();
        worst = k;
      }
    }
    const double usual = std::max(kNoiseFloorPx, median(rms));
    if (rms.size() < 4 || largest < 3 * usual) break;
    (*why)[worst] = "left out: it misses by " + formatFixed(largest, 2) + " px rms where the other pairs have " + formatFixed(usual, 2) +
                    " px; the board moved between the two pictures or was mis-detected";
    switchOff(model, worst);
    *iterations += minimise(*model).iterations;
  }
  std::vector<double> lengths;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!isUsed(model, k)) continue;
    for (std::size_t i = 0; i < pairs[k].left.corners.size(); ++i) lengths.push_back(model->residual(k, 0, i).norm());
    for (std::size_t i = 0; i < pairs[k].right.corners.size(); ++i) lengths.push_back(model->residual(k, 1, i).norm());
  }
  const double limit = 4 * std::max(kNoiseFloorPx, sigmaFromLengths(lengths));
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!isUsed(model, k)) continue;
    for (int side = 0; side < 2; ++side) {
      auto& weights = model->weights()[k][static_cast<std::size_t>(side)];
      for (std::size_t i = 0; i < weights.size(); ++i) {
        if (model->residual(k, side, i).cwiseAbs().maxCoeff() > limit) weights[i] = 0;
      }
    }
  }
  *iterations += minimise(*model).iterations;
}

// How the pose follows the lenses when they are not estimated: adds their covariance.
Matrix6d fromLenses(StereoModel* model, const vision::CameraFile& left, const vision::CameraFile& right) {
  LensMask all;
  all.free.fill(true);
  model->setMasks(all, all);
  ArrowNormal normal(model->globals(), model->blocks());
  model->linearise(&normal);
  const Eigen::MatrixXd S = reducedInformation(normal);
  const Eigen::MatrixXd K = -S.topLeftCorner<6, 6>().ldlt().solve(S.topRightCorner(6, 2 * kLensParameters));
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(2 * kLensParameters, 2 * kLensParameters);
  if (left.covariance) C.topLeftCorner<10, 10>() = left.covariance->topLeftCorner<10, 10>();
  if (right.covariance) C.bottomRightCorner<10, 10>() = right.covariance->topLeftCorner<10, 10>();
  return K * C * K.transpose();
}

LensMatrix lensBlock(const Eigen::MatrixXd& covariance, const LensMask& mask, Eigen::Index offset) {
  LensMatrix out = LensMatrix::Zero();
  const auto free = mask.indices();
  for (std::size_t i = 0; i < free.size(); ++i) {
    for (std::size_t j = 0; j < free.size(); ++j) {
      out(free[i], free[j]) = covariance(offset + static_cast<Eigen::Index>(i), offset + static_cast<Eigen::Index>(j));
    }
  }
  return out;
}

Result<StereoResult> finish(StereoModel* model, const Starts& starts, const vision::CameraFile& left, const vision::CameraFile& right,
                            const StereoOptions& options, const std::vector<std::string>& why, StereoResult out) {
  ArrowNormal normal(model->globals(), model->blocks());
  const double cost = model->linearise(&normal);
  const auto inverse = inverseOf(normal);
  const int n = model->observations(), dof = 2 * n - model->globals() - 6 * model->pairsUsed();
  if (!inverse || dof < 1) return Error{ErrorCode::kDegenerate, "the pairs do not determine the pose of the cameras; add pairs in which both see the whole board"};
  const double variance = residualVariance(cost, dof, 0.3);
  out.rms_px = std::sqrt(cost / (2.0 * n));
  out.sigma_px = std::sqrt(variance);
  Matrix6d C = variance * inverse->global.topLeftCorner<6, 6>();
  out.left = model->camera(0);
  out.right = model->camera(1);
  if (options.refine) {
    out.left_covariance = lensBlock(variance * inverse->global, out.left_mask, 6);
    out.right_covariance = lensBlock(variance * inverse->global, out.right_mask, 6 + out.left_mask.count());
  }
  for (std::size_t k = 0; k < starts.pairs.size(); ++k) {
    const bool used = isUsed(model, k);
    const double rms = rmsOfPair(*model, starts.pairs[k], k);
    out.pairs.push_back({starts.pairs[k].left.name, starts.pairs[k].right.name, std::isfinite(rms) ? rms : -1, used, used ? "" : why[k]});
  }
  if (!options.refine) C += fromLenses(model, left, right);
  const Matrix6d J = inverseIncrement(model->T_RL());
  out.covariance = J * C * J.transpose();
  out.X_LR = model->T_RL().inverse();
  if (out.rms_px > 1) {
    out.warnings.push_back("the residuals are large (" + formatFixed(out.rms_px, 2) + " px rms): check that the camera files belong to these pictures and the pairs were taken at the same instant");
  }
  if (!options.refine && !left.covariance && !right.covariance) {
    out.warnings.push_back("the camera files hold no covariance: sigma is that of the corners alone");
  }
  return out;
}

}  // namespace

Result<StereoResult> calibrateStereo(const std::vector<BoardPair>& pairs, const vision::CameraFile& left, const vision::CameraFile& right,
                                     const StereoOptions& options) {
  const Starts starts = startsOf(pairs, left.camera, right.camera);
  if (starts.usable == 0) {
    return Error{ErrorCode::kDegenerate, "no pair shows the board in both pictures" + (pairs.empty() ? std::string() : ": " + starts.why.front()) +
                                             "; take pairs in which both cameras see all of it"};
  }
  StereoResult out;
  if (options.refine) {
    out.left_mask = refinedMask(left.camera);
    out.right_mask = refinedMask(right.camera);
  }
  StereoModel model(starts.pairs, left.camera, right.camera, out.left_mask, out.right_mask, starts.T_RL, starts.X_LK);
  std::vector<std::string> why = starts.why;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!why[k].empty()) switchOff(&model, k);
  }
  out.iterations = minimise(model).iterations;
  if (options.robust) rejectPairs(&model, starts.pairs, &why, &out.iterations);
  return finish(&model, starts, left, right, options, why, out);
}

}  // namespace longarm::calibration
