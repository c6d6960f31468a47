#include "calibration/pose/loop_diagnosis.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "calibration/pose/loop_starts.h"
#include "calibration/pose/single_pose.h"
#include "core/text.h"

namespace longarm::calibration {
namespace {

constexpr double kClickSigma = 0.7;           // of a pick by hand [px]
constexpr std::size_t kMostForPairs = 16;     // observations up to which every exchange is tried

std::string namesOf(const LoopOptions& options) {
  std::string out;
  for (std::size_t i = 0; i < options.unknowns.size(); ++i) {
    out += (i == 0 ? "" : i + 1 == options.unknowns.size() ? " and " : ", ") + std::string(toString(options.unknowns[i]));
  }
  return out;
}

const char* leftFrame(LoopUnknown unknown) {
  return unknown == LoopUnknown::kExt ? "the camera's frame" : unknown == LoopUnknown::kDev ? "the device base's frame" : "the world frame";
}

// Middle of the points just left of a transform of the loop.
Eigen::Vector3d middleLeftOf(const LoopProblem& problem, LoopUnknown unknown, const Pose& T) {
  const auto observations = observationsOf(problem, unknown);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& o : observations) sum += T * o.y / static_cast<double>(observations.size());
  return sum;
}

// The problem with the transforms of a state filled in.
LoopProblem placed(const LoopProblem& problem, const LoopOptions& options, const LoopState& state) {
  LoopProblem out = problem;
  for (auto& view : out.views) {
    for (const LoopUnknown u : options.unknowns) {
      if (u == LoopUnknown::kExt) view.T_ext = state.T[0];
      if (u == LoopUnknown::kDev) view.T_dev = state.T[1];
      if (u == LoopUnknown::kObj) view.T_obj = state.T[2].inverse();
    }
  }
  return out;
}

double bestRms(const LoopProblem& problem, LoopUnknown unknown) {
  const auto observations = observationsOf(problem, unknown);
  const auto found = findPoses(problem.camera, observations);
  if (!found) return 1e9;
  return std::sqrt(found->front().cost / (2.0 * static_cast<double>(observations.size())));
}

struct Mirror {
  const char* what;
  std::function<void(LoopPoint*, const vision::CameraModel&)> apply;
};

const std::vector<Mirror>& mirrors() {
  static const std::vector<Mirror> all = {
      {"v is counted upwards (it must grow downwards)", [](LoopPoint* p, const vision::CameraModel& c) { p->pixel.y() = (c.height > 0 ? c.height - 1.0 : 2 * c.cy) - p->pixel.y(); }},
      {"u runs from right to left", [](LoopPoint* p, const vision::CameraModel& c) { p->pixel.x() = (c.width > 0 ? c.width - 1.0 : 2 * c.cx) - p->pixel.x(); }},
      {"the x axis of the points is reversed (their frame is left-handed)", [](LoopPoint* p, const vision::CameraModel&) { p->xyz.x() *= -1; }},
      {"the y axis of the points is reversed (their frame is left-handed)", [](LoopPoint* p, const vision::CameraModel&) { p->xyz.y() *= -1; }},
      {"the z axis of the points is reversed (their frame is left-handed)", [](LoopPoint* p, const vision::CameraModel&) { p->xyz.z() *= -1; }}};
  return all;
}

// The mirror that makes a bad fit a good one, or null.
const Mirror* findMirror(const LoopProblem& problem, const LoopOptions& options, double rms) {
  const auto poses = unknownPoses(options);
  if (poses.size() != 1 || options.unknowns.size() != 1) return nullptr;
  const double good = std::min(0.2 * rms, 4 * options.sigma_px.value_or(kClickSigma));
  for (const auto& mirror : mirrors()) {
    LoopProblem mirrored = problem;
    for (auto& view : mirrored.views) {
      for (auto& p : view.points) mirror.apply(&p, problem.camera);
    }
    if (bestRms(mirrored, poses.front()) < good) return &mirror;
  }
  return nullptr;
}

Error mirrorError(const Mirror& mirror) {
  return {ErrorCode::kDegenerate, std::string("the points are mirrored: they fit only if ") + mirror.what + "; correct the file"};
}

std::string swapSentence(const LoopView& view, std::size_t i, std::size_t j) {
  return (view.name.empty() ? "" : "view " + view.name + ": ") + "points " + std::to_string(i + 1) + " and " + std::to_string(j + 1) +
         " look swapped: each fits the other's pixel. Exchange their u,v";
}

// Two misfits of one view that fit each other's place.
Status findSwap(const LoopProblem& problem, const LoopModel& model, double limit) {
  for (std::size_t k = 0; k < problem.views.size(); ++k) {
    const auto& points = problem.views[k].points;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2d ri = model.residual(k, i);
      if (!(ri.norm() > limit) || !ri.allFinite()) continue;
      for (std::size_t j = i + 1; j < points.size(); ++j) {
        const Eigen::Vector2d rj = model.residual(k, j);
        if (!(rj.norm() > limit) || !rj.allFinite()) continue;
        const double exchanged = std::max((points[i].pixel - (points[j].pixel - rj)).norm(), (points[j].pixel - (points[i].pixel - ri)).norm());
        if (exchanged < limit) return {ErrorCode::kDegenerate, swapSentence(problem.views[k], i, j)};
      }
    }
  }
  return {};
}

// Few points: one swap spoils the whole fit, so every exchange is tried.
Status tryExchanges(const LoopProblem& problem, const LoopOptions& options, double rms) {
  const auto poses = unknownPoses(options);
  std::size_t n = 0;
  for (const auto& view : problem.views) n += view.points.size();
  if (poses.size() != 1 || options.unknowns.size() != 1 || n > kMostForPairs || n < 5) return {};
  const double good = std::min(0.2 * rms, 3 * options.sigma_px.value_or(kClickSigma));
  for (std::size_t k = 0; k < problem.views.size(); ++k) {
    for (std::size_t i = 0; i < problem.views[k].points.size(); ++i) {
      for (std::size_t j = i + 1; j < problem.views[k].points.size(); ++j) {
        LoopProblem exchanged = problem;
        std::swap(exchanged.views[k].points[i].pixel, exchanged.views[k].points[j].pixel);
        if (bestRms(exchanged, poses.front()) < good) return {ErrorCode::kDegenerate, swapSentence(problem.views[k], i, j)};
      }
    }
  }
  return {};
}

double rmsOfAll(const LoopProblem& problem, const LoopModel& model) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t k = 0; k < problem.views.size(); ++k) {
    for (std::size_t i = 0; i < problem.views[k].points.size(); ++i, ++n) sum += std::min(1e8, model.residual(k, i).squaredNorm());
  }
  return std::sqrt(sum / (2.0 * static_cast<double>(std::max<std::size_t>(1, n))));
}

}  // namespace

std::string weakestInWords(const LoopProblem& problem, const LoopOptions& options, const LoopModel& model, const Observability& seen) {
  std::string out;
  const LoopProblem known = placed(problem, options, model.state());
  const double whole = seen.null_direction.norm();
  Eigen::Index at = 0;
  for (const LoopUnknown u : {LoopUnknown::kExt, LoopUnknown::kDev, LoopUnknown::kObj}) {
    if (std::count(options.unknowns.begin(), options.unknowns.end(), u) == 0) continue;
    const Vector6d part = seen.null_direction.segment<6>(at);
    at += 6;
    if (part.norm() < 0.05 * whole) continue;
    const Pose& T = model.state().T[u == LoopUnknown::kExt ? 0 : u == LoopUnknown::kDev ? 1 : 2];
    out += (out.empty() ? "" : "; ") + std::string(toString(u)) + ": " + motionInWords(part, T, middleLeftOf(known, u, T)) + ", in " + leftFrame(u);
  }
  return out.empty() ? "the intrinsics" : out;
}

Error undetermined(const LoopOptions& options, const Observability& seen, const std::string& weakest) {
  const bool gauge = std::count(options.unknowns.begin(), options.unknowns.end(), LoopUnknown::kDev) > 0 &&
                     std::count(options.unknowns.begin(), options.unknowns.end(), LoopUnknown::kObj) > 0;
  return {ErrorCode::kDegenerate, namesOf(options) + (options.unknowns.size() > 1 ? " are" : " is") + " not determined: only " +
                                      std::to_string(seen.rank) + " of " + std::to_string(seen.figures.size()) + " motions show in the pictures. Free is " +
                                      weakest + ". " +
                                      (gauge ? "Only T_dev T_obj^-1 can be seen: give one of T_dev and T_obj and solve the other"
                                             : "Add points that are distinct and not on one line with the others, or views from other "
                                               "directions (turned about a second axis)")};
}

Status refuseMislabelled(const LoopProblem& problem, const LoopOptions& options, const LoopModel& model) {
  const double sigma = options.sigma_px.value_or(kClickSigma), limit = 6 * sigma;
  if (auto status = findSwap(problem, model, limit); !status) return status;
  const double rms = rmsOfAll(problem, model);
  if (rms < 5 * sigma) return {};
  if (const Mirror* mirror = findMirror(problem, options, rms)) return mirrorError(*mirror);
  return tryExchanges(problem, options, rms);
}

Error explainMisfit(const LoopProblem& problem, const LoopOptions& options, const Error& error) {
  if (error.code != ErrorCode::kNoSolution) return error;
  if (const Mirror* mirror = findMirror(problem, options, 1e3)) return mirrorError(*mirror);
  return error;
}

}  // namespace longarm::calibration
