#include "hardware/horizon_checks.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "core/text.h"

namespace longarm::hardware {
namespace {

constexpr std::size_t kMaxPoints = 2000;
constexpr double kRelativeSlack = 0.01;  // rounding of a planner that works at the limit
constexpr double kAbsoluteSlack = 1e-6;

Error refusal(ErrorCode code, const Horizon& horizon, std::size_t point, const std::string& what) {
  return {code, "horizon of \"" + horizon.owner + "\", point " + std::to_string(point) + ": " + what};
}

std::string exceeds(const std::string& joint, const char* quantity, double value, double limit) {
  return "joint " + joint + " " + quantity + " " + formatNumber(value) + "; the limit is " + formatNumber(limit);
}

Status checkShape(const Horizon& h, const std::vector<std::string>& joints) {
  if (h.joint_names != joints) {
    return {ErrorCode::kInvalidInput, "horizon of \"" + h.owner + "\": names " +
                                          std::to_string(h.joint_names.size()) +
                                          " joints that are not, in this order, the " +
                                          std::to_string(joints.size()) + " of the arm"};
  }
  if (h.points.size() < 2 || h.points.size() > kMaxPoints) {
    return {ErrorCode::kInvalidInput, "horizon of \"" + h.owner + "\": has " + std::to_string(h.points.size()) +
                                          " points; expected 2 ... " + std::to_string(kMaxPoints)};
  }
  const auto n = static_cast<Eigen::Index>(joints.size());
  for (std::size_t i = 0; i < h.points.size(); ++i) {
    const auto& p = h.points[i];
    if (p.positions.size() != n || p.velocities.size() != n || p.accelerations.size() != n) {
      return refusal(ErrorCode::kInvalidInput, h, i, "needs " + std::to_string(n) +
                                                         " positions, velocities and accelerations");
    }
    if (!std::isfinite(p.t) || !p.positions.allFinite() || !p.velocities.allFinite() ||
        !p.accelerations.allFinite()) {
      return refusal(ErrorCode::kInvalidInput, h, i, "holds a number that is not finite");
    }
  }
  return {};
}

Status checkTimes(const Horizon& h, const GateOptions& options) {
  if (!std::isfinite(h.start_s)) {
    return {ErrorCode::kInvalidInput, "horizon of \"" + h.owner + "\": start time is not finite"};
  }
  for (std::size_t i = 0; i < h.points.size(); ++i) {
    const double t = h.points[i].t;
    const bool good = i == 0 ? t == 0 : t - h.points[i - 1].t >= options.min_point_spacing_s;
    if (!good) {
      return refusal(ErrorCode::kInvalidInput, h, i,
                     "t = " + formatNumber(t) + " s; times start at 0 and increase by at least " +
                         formatNumber(options.min_point_spacing_s) + " s");
    }
  }
  if (h.duration() > options.max_horizon_s) {
    return {ErrorCode::kOutOfLimits, "horizon of \"" + h.owner + "\": lasts " + formatNumber(h.duration()) +
                                         " s; the limit is " + formatNumber(options.max_horizon_s) + " s"};
  }
  return {};
}

Status checkRest(const Horizon& h) {
  const auto& last = h.points.back().velocities;
  for (Eigen::Index j = 0; j < last.size(); ++j) {
    if (std::abs(last[j]) > 1e-4) {
      return refusal(ErrorCode::kInvalidInput, h, h.points.size() - 1,
                     "joint " + h.joint_names[static_cast<std::size_t>(j)] + " still moves at " +
                         formatNumber(last[j]) + "; every horizon ends at rest");
    }
  }
  return {};
}

double withSlack(double limit) { return limit * (1 + kRelativeSlack) + kAbsoluteSlack; }

Status checkPoint(const Horizon& h, std::size_t i, Eigen::Index j, const MotionLimits& limits, double margin) {
  const auto& p = h.points[i];
  const std::string& joint = h.joint_names[static_cast<std::size_t>(j)];
  const double start = h.points.front().positions[j];
  const double lowest = std::min(limits.lower[j] + margin, start) - kAbsoluteSlack;
  const double highest = std::max(limits.upper[j] - margin, start) + kAbsoluteSlack;
  if (p.positions[j] < lowest) {
    return refusal(ErrorCode::kOutOfLimits, h, i, exceeds(joint, "at", p.positions[j], limits.lower[j] + margin));
  }
  if (p.positions[j] > highest) {
    return refusal(ErrorCode::kOutOfLimits, h, i, exceeds(joint, "at", p.positions[j], limits.upper[j] - margin));
  }
  if (std::abs(p.velocities[j]) > withSlack(limits.max_velocity[j])) {
    return refusal(ErrorCode::kOutOfLimits, h, i,
                   exceeds(joint, "moves at", p.velocities[j], limits.max_velocity[j]));
  }
  if (std::abs(p.accelerations[j]) > withSlack(limits.max_acceleration[j])) {
    return refusal(ErrorCode::kOutOfLimits, h, i,
                   exceeds(joint, "accelerates at", p.accelerations[j], limits.max_acceleration[j]));
  }
  return {};
}

// Between two points: mean velocity, mean acceleration, and a position step that the velocities explain.
Status checkStep(const Horizon& h, std::size_t i, Eigen::Index j, const MotionLimits& limits) {
  const auto& a = h.points[i - 1];
  const auto& b = h.points[i];
  const std::string& joint = h.joint_names[static_cast<std::size_t>(j)];
  const double dt = b.t - a.t;
  const double velocity = (b.positions[j] - a.positions[j]) / dt;
  if (std::abs(velocity) > withSlack(limits.max_velocity[j])) {
    return refusal(ErrorCode::kOutOfLimits, h, i,
                   exceeds(joint, "moves on the way there at", velocity, limits.max_velocity[j]));
  }
  const double acceleration = (b.velocities[j] - a.velocities[j]) / dt;
  if (std::abs(acceleration) > withSlack(limits.max_acceleration[j])) {
    return refusal(ErrorCode::kOutOfLimits, h, i,
                   exceeds(joint, "accelerates on the way there at", acceleration, limits.max_acceleration[j]));
  }
  const double unexplained = std::abs(velocity - 0.5 * (a.velocities[j] + b.velocities[j]));
  const double explained = withSlack(0.5 * limits.max_acceleration[j] * dt);
  if (unexplained > explained) {
    return refusal(ErrorCode::kOutOfLimits, h, i,
                   exceeds(joint, "jumps: its step differs from its velocities by", unexplained, explained));
  }
  return {};
}

Status checkLimits(const Horizon& h, const MotionLimits& limits, double margin) {
  const auto n = static_cast<Eigen::Index>(h.joint_names.size());
  for (std::size_t i = 0; i < h.points.size(); ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      if (auto status = checkPoint(h, i, j, limits, margin); !status) return status;
      if (i == 0) continue;
      if (auto status = checkStep(h, i, j, limits); !status) return status;
    }
  }
  return {};
}

Status checkToolSpeed(const Horizon& h, const GateChecks& checks) {
  Eigen::Vector3d before = checks.tool_position(h.points.front().positions);
  for (std::size_t i = 1; i < h.points.size(); ++i) {
    const Eigen::Vector3d here = checks.tool_position(h.points[i].positions);
    const double speed = (here - before).norm() / (h.points[i].t - h.points[i - 1].t);
    if (!(speed <= withSlack(checks.max_tool_speed) * 1.05)) {
      return refusal(ErrorCode::kOutOfLimits, h, i,
                     "the tool moves at " + formatFixed(speed, 3) + " m/s; the limit is " +
                         formatFixed(checks.max_tool_speed, 3) + " m/s");
    }
    before = here;
  }
  return {};
}

// Coming closer than the least clearance is refused; moving away from too close is not.
Status checkClearance(const Horizon& h, const GateChecks& checks) {
  const double start = checks.clearance(h.points.front().positions);
  const std::size_t middle = h.points.size() / 2;
  for (const std::size_t i : {middle, h.points.size() - 1}) {
    const double here = checks.clearance(h.points[i].positions);
    if (!(here >= checks.min_clearance || here >= start - 1e-4)) {
      return refusal(ErrorCode::kCollision, h, i,
                     "leaves " + formatFixed(here * 1000, 1) + " mm of clearance; at least " +
                         formatFixed(checks.min_clearance * 1000, 1) + " mm are needed");
    }
  }
  return {};
}

}  // namespace

Status checkHorizon(const Horizon& horizon, const std::vector<std::string>& joints, const MotionLimits& limits,
                    const GateOptions& options) {
  if (auto status = checkShape(horizon, joints); !status) return status;
  if (auto status = checkTimes(horizon, options); !status) return status;
  if (auto status = checkRest(horizon); !status) return status;
  return checkLimits(horizon, limits, options.limit_margin);
}

Status checkSurroundings(const Horizon& horizon, const GateChecks& checks) {
  try {
    if (checks.tool_position) {
      if (auto status = checkToolSpeed(horizon, checks); !status) return status;
    }
    if (checks.clearance) return checkClearance(horizon, checks);
    return {};
  } catch (const std::exception& e) {
    return {ErrorCode::kInternal, std::string("the check of a horizon failed: ") + e.what()};
  }
}

}  // namespace longarm::hardware
