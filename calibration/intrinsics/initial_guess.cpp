#include "calibration/intrinsics/initial_guess.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "calibration/fixture/dlt.h"
#include "calibration/intrinsics/intrinsics_model.h"
#include "calibration/intrinsics/plane_homography.h"
#include "calibration/solve/robust.h"

namespace longarm::calibration {
namespace {

constexpr double kFlat = 0.02;      // below: a plane
constexpr double kNarrow = 1e-3;    // below: a line

Error unusable(const std::string& why) { return {ErrorCode::kDegenerate, why}; }

// Why a view cannot be used at all, or empty.
std::string shapeFault(const BoardView& view) {
  const std::size_t n = view.corners.size();
  if (n < 4) return "only " + std::to_string(n) + " corners; at least 4 are needed";
  const CornerPlane plane = planeOf(view.corners);
  if (plane.narrowness < kNarrow) return "all corners are collinear";
  if (plane.flatness >= kFlat && n < 6) return "only " + std::to_string(n) + " points that are not in one plane; at least 6 are needed";
  return {};
}

bool inFront(const BoardView& view, const Pose& X_CK) {
  return std::all_of(view.corners.begin(), view.corners.end(),
                     [&](const Corner& c) { return (X_CK * c.xyz).z() > 1e-6; });
}

// Focal lengths from homographies whose pixels are relative to the principal point.
std::optional<Eigen::Vector2d> focalFromHomographies(const std::vector<Eigen::Matrix3d>& homographies) {
  Eigen::Matrix2d N = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const auto& raw : homographies) {
    const double scale = 1 / std::sqrt(raw.col(0).norm() * raw.col(1).norm());
    const Eigen::Vector3d a = raw.col(0) * scale, b = raw.col(1) * scale;
    Eigen::Matrix2d A;
    A << a.x() * b.x(), a.y() * b.y(), a.x() * a.x() - b.x() * b.x(), a.y() * a.y() - b.y() * b.y();
    const Eigen::Vector2d c(-a.z() * b.z(), b.z() * b.z() - a.z() * a.z());
    N += A.transpose() * A;
    right += A.transpose() * c;
  }
  const Eigen::Vector2d w = N.ldlt().solve(right);
  if (!(w.x() > 0 && w.y() > 0) || !w.allFinite()) return std::nullopt;
  return Eigen::Vector2d(1 / std::sqrt(w.x()), 1 / std::sqrt(w.y()));
}

Eigen::Vector2d middle(const std::vector<BoardView>& views, int width, int height) {
  if (width > 0 && height > 0) return {(width - 1) / 2.0, (height - 1) / 2.0};
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300), high = -low;
  for (const auto& view : views) {
    for (const auto& c : view.corners) {
      low = low.cwiseMin(c.pixel);
      high = high.cwiseMax(c.pixel);
    }
  }
  return 0.5 * (low + high);
}

std::optional<vision::CameraModel> cameraFromSolids(const std::vector<BoardView>& views, const InitialGuess& guess) {
  std::vector<double> fx, fy, cx, cy;
  for (std::size_t k = 0; k < views.size(); ++k) {
    if (!guess.why_unusable[k].empty() || planeOf(views[k].corners).flatness < kFlat) continue;
    const auto camera = decompose(solveDlt(views[k].corners).C, views[k].corners);
    if (!camera) continue;
    fx.push_back(camera->camera.fx);
    fy.push_back(camera->camera.fy);
    cx.push_back(camera->camera.cx);
    cy.push_back(camera->camera.cy);
  }
  if (fx.empty()) return std::nullopt;
  vision::CameraModel out;
  out.fx = median(fx);
  out.fy = median(fy);
  out.cx = median(cx);
  out.cy = median(cy);
  return out;
}

// Candidate cameras for planar views: the closed form, else plausible fields of view.
std::vector<vision::CameraModel> camerasFromPlanes(const std::vector<BoardView>& views, const InitialGuess& guess,
                                                   const Eigen::Vector2d& centre, int width, int height) {
  std::vector<Eigen::Matrix3d> homographies;
  for (std::size_t k = 0; k < views.size(); ++k) {
    if (!guess.why_unusable[k].empty()) continue;
    std::vector<Eigen::Vector2d> pixels;
    for (const auto& c : views[k].corners) pixels.push_back(c.pixel - centre);
    homographies.push_back(planeHomography(views[k].corners, planeOf(views[k].corners), pixels));
  }
  vision::CameraModel camera;
  camera.cx = centre.x();
  camera.cy = centre.y();
  const double side = std::max({static_cast<double>(width), static_cast<double>(height), 2 * centre.x(), 2 * centre.y(), 1.0});
  const auto focal = focalFromHomographies(homographies);
  std::vector<vision::CameraModel> out;
  if (focal && focal->minCoeff() > 0.1 * side && focal->maxCoeff() < 100 * side) {
    camera.fx = focal->x();
    camera.fy = focal->y();
    out.push_back(camera);
    if (std::abs(std::log(camera.fx / camera.fy)) < 0.2) return out;
  }
  for (const double factor : {0.6, 1.0, 1.7, 3.0, 6.0}) {
    camera.fx = camera.fy = factor * side;
    out.push_back(camera);
  }
  return out;
}

// Poses for a camera; the number of views that have one.
InitialGuess withPoses(const std::vector<BoardView>& views, InitialGuess guess, const vision::CameraModel& camera) {
  guess.camera = camera;
  guess.X_CK.assign(views.size(), Pose::Identity());
  for (std::size_t k = 0; k < views.size(); ++k) {
    if (!guess.why_unusable[k].empty()) continue;
    const auto pose = guessPose(views[k], camera);
    if (pose) guess.X_CK[k] = *pose;
    else guess.why_unusable[k] = pose.error().message;
  }
  return guess;
}

// Cost of a short refinement of this guess.
double trialCost(const std::vector<BoardView>& views, const InitialGuess& guess) {
  IntrinsicsModel model(views, guess.camera, guess.X_CK, LensMask::of(false, 0));
  for (std::size_t k = 0; k < views.size(); ++k) {
    if (!guess.why_unusable[k].empty()) std::fill(model.weights()[k].begin(), model.weights()[k].end(), 0.0);
  }
  ArrowOptions options;
  options.max_iterations = 20;
  return minimise(model, options).cost;
}

}  // namespace

int InitialGuess::usable() const {
  return static_cast<int>(std::count(why_unusable.begin(), why_unusable.end(), std::string()));
}

Result<Pose> guessPose(const BoardView& view, const vision::CameraModel& camera) {
  if (const std::string fault = shapeFault(view); !fault.empty()) return unusable(fault);
  BoardView ideal = view;
  std::vector<Eigen::Vector2d> points;
  for (auto& c : ideal.corners) {
    const auto n = camera.normalisedOfPixel(c.pixel);
    if (!n) return unusable(n.error().message);
    c.pixel = *n;
    points.push_back(*n);
  }
  const CornerPlane plane = planeOf(view.corners);
  Pose X_CK = Pose::Identity();
  if (plane.flatness < kFlat) {
    X_CK = poseFromHomography(planeHomography(view.corners, plane, points)) * plane.X_KP.inverse();
  } else {
    const auto linear = decompose(solveDlt(ideal.corners).C, ideal.corners);
    if (!linear) return linear.error();
    X_CK = linear->X_CW;
  }
  if (!X_CK.matrix().allFinite() || !inFront(view, X_CK)) {
    return unusable("its corners fit no target in front of the camera; check their order");
  }
  return X_CK;
}

InitialGuess guessCamera(const std::vector<BoardView>& views, int width, int height,
                         const std::optional<vision::CameraModel>& known) {
  InitialGuess guess;
  for (const auto& view : views) guess.why_unusable.push_back(shapeFault(view));
  guess.X_CK.assign(views.size(), Pose::Identity());
  if (known) return withPoses(views, guess, *known);
  if (guess.usable() == 0) return guess;
  if (const auto solid = cameraFromSolids(views, guess)) return withPoses(views, guess, *solid);
  const auto cameras = camerasFromPlanes(views, guess, middle(views, width, height), width, height);
  InitialGuess best = withPoses(views, guess, cameras.front());
  if (cameras.size() == 1) return best;
  double best_cost = 1e300;
  for (const auto& camera : cameras) {
    const InitialGuess candidate = withPoses(views, guess, camera);
    if (candidate.usable() == 0) continue;
    const double cost = trialCost(views, candidate) - 1e6 * candidate.usable();
    if (cost < best_cost) {
      best_cost = cost;
      best = candidate;
    }
  }
  return best;
}

}  // namespace longarm::calibration
