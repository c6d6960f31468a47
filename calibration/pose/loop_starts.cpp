#include "calibration/pose/loop_starts.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "calibration/fixture/dlt.h"
#include "calibration/pose/hand_eye.h"
#include "calibration/solve/robust.h"

namespace longarm::calibration {
namespace {

constexpr double kClickSigma = 0.7;       // of a pick by hand [px]

bool has(const std::vector<LoopUnknown>& unknowns, LoopUnknown which) {
  return std::find(unknowns.begin(), unknowns.end(), which) != unknowns.end();
}

std::size_t indexOf(LoopUnknown unknown) {
  return unknown == LoopUnknown::kExt ? 0 : unknown == LoopUnknown::kDev ? 1 : 2;
}

// In the loop the object's transform stands inverted.
Pose asInLoop(LoopUnknown unknown, const Pose& T) { return unknown == LoopUnknown::kObj ? T.inverse() : T; }

LoopState baseState(const LoopProblem& problem, const LoopOptions& options) {
  LoopState state;
  state.camera = problem.camera;
  for (const LoopUnknown unknown : {LoopUnknown::kExt, LoopUnknown::kDev, LoopUnknown::kObj}) {
    const auto& start = options.starts[indexOf(unknown)];
    if (start) state.T[indexOf(unknown)] = asInLoop(unknown, *start);
  }
  return state;
}

std::vector<double> misses(const vision::CameraModel& camera, const std::vector<PoseObservation>& observations, const Pose& T) {
  std::vector<double> out;
  for (const auto& o : observations) out.push_back(missOf(camera, o, T));
  return out;
}

// Minima over all observations; when some do not belong, over those that agree.
Result<LoopStarts> singleStarts(const LoopProblem& problem, const LoopOptions& options, LoopUnknown unknown,
                                const LoopState& base) {
  auto observations = observationsOf(problem, unknown);
  const Pose given = base.T[indexOf(unknown)];
  const Pose* start = options.starts[indexOf(unknown)] ? &given : nullptr;
  LoopStarts out;
  auto minima = findPoses(base.camera, observations, start);
  const bool can_drop = options.robust && observations.size() >= 7;
  if (!minima && !(can_drop && minima.error().code == ErrorCode::kNoSolution)) return minima.error();
  bool spoiled = !minima.ok();
  if (minima) {
    const auto lengths = misses(base.camera, observations, minima->front().T);
    spoiled = *std::max_element(lengths.begin(), lengths.end()) > 4.5 * options.sigma_px.value_or(kClickSigma);
  }
  if (spoiled && can_drop) {
    std::vector<bool> inliers;
    const double threshold = 4 * options.sigma_px.value_or(kClickSigma);
    const auto robust = findPoseAmongOutliers(base.camera, observations, threshold, &inliers);
    if (!robust && !minima) return robust.error();
    if (robust && std::count(inliers.begin(), inliers.end(), true) * 2 >= static_cast<std::ptrdiff_t>(inliers.size())) {
      for (const auto& view : problem.views) out.agree.emplace_back(view.points.size(), true);
      for (std::size_t i = 0; i < observations.size(); ++i) {
        observations[i].weight = inliers[i] ? 1 : 0;
        out.agree[static_cast<std::size_t>(observations[i].view)][static_cast<std::size_t>(observations[i].point)] = inliers[i];
      }
      minima = findPoses(base.camera, observations, &robust->T);
      if (!minima) return minima.error();
    }
  }
  if (!minima) return minima.error();
  out.minima = *minima;
  LoopState state = base;
  state.T[indexOf(unknown)] = minima->front().T;
  out.states.push_back(state);
  return out;
}

// Pose of the object in the camera from one view alone.
std::optional<Pose> poseOfView(const vision::CameraModel& camera, const LoopView& view) {
  if (view.points.size() < 4) return std::nullopt;
  LoopProblem one;
  one.camera = camera;
  LoopView alone;
  alone.points = view.points;
  one.views.push_back(alone);
  const auto found = findPoses(camera, observationsOf(one, LoopUnknown::kExt));
  if (!found) return std::nullopt;
  return found->front().T;
}

// T_ext with T_dev or T_obj, from views that each show four points or more.
std::optional<LoopState> handEyeState(const LoopProblem& problem, const std::vector<LoopUnknown>& poses, const LoopState& base) {
  if (poses.size() != 2 || !has(poses, LoopUnknown::kExt)) return std::nullopt;
  std::vector<HandEyePair> pairs;
  for (const auto& view : problem.views) {
    if (const auto P = poseOfView(base.camera, view)) pairs.push_back({view.T_kin, *P});
  }
  const auto start = handEyeStart(pairs);
  if (!start) return std::nullopt;
  LoopState state = base;
  state.T[0] = start->T_ext;
  const LoopView& first = problem.views.front();
  if (has(poses, LoopUnknown::kDev)) state.T[1] = start->Y * first.T_obj;       // Y = T_dev T_obj^-1
  else state.T[2] = first.T_dev.inverse() * start->Y;
  return state;
}

Result<LoopStarts> jointStarts(const LoopProblem& problem, const LoopOptions& options,
                               const std::vector<LoopUnknown>& poses, const LoopState& base) {
  LoopStarts out;
  const bool all_given = std::all_of(poses.begin(), poses.end(), [&](LoopUnknown u) { return options.starts[indexOf(u)].has_value(); });
  if (const auto found = handEyeState(problem, poses, base)) out.states.push_back(*found);
  if (all_given) out.states.push_back(base);
  if (!out.states.empty()) return out;
  // One of them is placed: find the other by itself first.
  for (const LoopUnknown missing : poses) {
    LoopProblem placed = problem;
    bool complete = true;
    for (const LoopUnknown other : poses) {
      if (other == missing) continue;
      const auto& start = options.starts[indexOf(other)];
      complete = complete && start.has_value();
      if (!start) continue;
      for (auto& view : placed.views) {
        (other == LoopUnknown::kExt ? view.T_ext : other == LoopUnknown::kDev ? view.T_dev : view.T_obj) = *start;
      }
    }
    if (!complete) continue;
    const auto minima = findPoses(base.camera, observationsOf(placed, missing));
    if (!minima) return minima.error();
    LoopState state = base;
    state.T[indexOf(missing)] = minima->front().T;
    out.states.push_back(state);
    return out;
  }
  return Error{ErrorCode::kInvalidInput, "two or more transforms are unknown and none can be found from nothing: give a start for "
                                         "one of them, or show four or more points in at least two views"};
}

// Linear intrinsics for points whose place in the camera is known: u = fx x + skew y + cx, v = fy y + cy.
Result<vision::CameraModel> linearIntrinsics(const LoopProblem& problem, const LoopState& base) {
  LoopModel model(problem, {}, base);
  std::vector<Eigen::Vector3d> rows;
  std::vector<Eigen::Vector2d> pixels;
  for (std::size_t k = 0; k < problem.views.size(); ++k) {
    for (std::size_t i = 0; i < problem.views[k].points.size(); ++i) {
      const Eigen::Vector3d p = model.pointInCamera(k, i);
      if (!(p.z() > 1e-6)) continue;
      rows.emplace_back(p.x() / p.z(), p.y() / p.z(), 1);
      pixels.push_back(problem.views[k].points[i].pixel);
    }
  }
  if (rows.size() < 3) {
    return Error{ErrorCode::kDegenerate, "fewer than 3 points are in front of the camera; check the transforms (each maps its right-hand frame into its left-hand one)"};
  }
  Eigen::MatrixXd A(rows.size(), 2), B(rows.size(), 2);
  Eigen::VectorXd u(rows.size()), v(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto r = static_cast<Eigen::Index>(i);
    A.row(r) << rows[i].x(), 1;
    B.row(r) << rows[i].y(), 1;
    u[r] = pixels[i].x();
    v[r] = pixels[i].y();
  }
  const Eigen::Vector2d x = A.colPivHouseholderQr().solve(u), y = B.colPivHouseholderQr().solve(v);
  vision::CameraModel camera = problem.camera;
  camera.fx = x[0];
  camera.cx = x[1];
  camera.fy = y[0];
  camera.cy = y[1];
  camera.skew = 0;
  camera.distortion = {};
  if (camera.fx > 0 && camera.fy > 0) return camera;
  return Error{ErrorCode::kDegenerate, "the points fit a camera only with a negative focal length: pixels or coordinates are mirrored, or a transform is inverted"};
}

}  // namespace

std::vector<LoopUnknown> unknownPoses(const LoopOptions& options) {
  std::vector<LoopUnknown> out;
  for (const LoopUnknown unknown : options.unknowns) {
    if (unknown != LoopUnknown::kIntrinsics) out.push_back(unknown);
  }
  return out;
}

double outlierLimit(const std::vector<double>& lengths, const std::optional<double>& sigma_px) {
  const double spread = sigmaFromLengths(lengths);
  // Of a few residuals the spread itself is uncertain: then nothing within what a hand can click is called wrong.
  if (lengths.size() >= 30) return std::max(5 * spread, 0.02);
  return std::max(5 * spread, 4.5 * sigma_px.value_or(kClickSigma));
}

Result<LoopStarts> loopStarts(const LoopProblem& problem, const LoopOptions& options) {
  const auto poses = unknownPoses(options);
  LoopState base = baseState(problem, options);
  const bool lens = has(options.unknowns, LoopUnknown::kIntrinsics);
  if (lens && poses.empty()) {
    const auto camera = linearIntrinsics(problem, base);
    if (!camera) return camera.error();
    base.camera = *camera;
    LoopStarts out;
    out.states.push_back(base);
    return out;
  }
  if (lens && !options.has_camera_start) {
    return Error{ErrorCode::kInvalidInput, "camera: intrinsics to start from are needed when a transform is unknown too; give a camera file"};
  }
  if (lens) base.camera.distortion = {}, base.camera.skew = 0;
  return poses.size() == 1 ? singleStarts(problem, options, poses.front(), base) : jointStarts(problem, options, poses, base);
}

}  // namespace longarm::calibration
