#include "core/base_motion.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace longarm {
namespace {

constexpr double kSameWay = 0.010, kSameTurn = 0.5 * M_PI / 180;
constexpr double kSlack = 1e-9;
constexpr double kStill = 0.005, kTurnStill = 0.01;  // [m/s], [rad/s]

double towards(double now, double wanted, double step) { return now + std::clamp(wanted - now, -step, step); }

}  // namespace

bool BaseTwist::standing() const { return std::hypot(forward, left) < kStill && std::abs(turn) < kTurnStill; }

Pose poseOf(const BaseState& state) { return poseFromRpy({state.x, state.y, 0}, {0, 0, state.yaw}); }

BaseShift shiftBetween(const BaseState& a, const BaseState& b) {
  return {std::hypot(a.x - b.x, a.y - b.y), std::abs(std::remainder(a.yaw - b.yaw, 2 * M_PI))};
}

bool samePlace(const BaseState& a, const BaseState& b) {
  const BaseShift shift = shiftBetween(a, b);
  return shift.way <= kSameWay && shift.turn <= kSameTurn;
}

Status checkTwist(const BaseTwist& twist, const BaseLimits& limits) {
  if (!std::isfinite(twist.forward) || !std::isfinite(twist.left) || !std::isfinite(twist.turn)) {
    return {ErrorCode::kInvalidInput, "drive: the velocity is not a finite number"};
  }
  if (!limits.sideways && twist.left != 0)
    return {ErrorCode::kOutOfLimits, "drive: this base cannot move sideways"};
  const double speed = std::hypot(twist.forward, twist.left);
  if (speed > limits.max_speed + kSlack) {
    return {ErrorCode::kOutOfLimits, "drive: " + formatFixed(speed, 3) + " m/s is beyond the cap of " +
                                         formatFixed(limits.max_speed, 3) + " m/s"};
  }
  if (std::abs(twist.turn) > limits.max_turn + kSlack) {
    return {ErrorCode::kOutOfLimits, "drive: " + formatFixed(std::abs(twist.turn), 3) +
                                         " rad/s is beyond the cap of " + formatFixed(limits.max_turn, 3) +
                                         " rad/s"};
  }
  return {};
}

BaseTwist rampTowards(const BaseTwist& now, const BaseTwist& wanted, const BaseLimits& limits,
                      double seconds) {
  const double step = limits.max_acceleration * seconds, turn = limits.max_turn_acceleration * seconds;
  const double way = std::hypot(wanted.forward - now.forward, wanted.left - now.left);
  const double share = way <= step ? 1 : step / way;
  return {now.forward + share * (wanted.forward - now.forward), now.left + share * (wanted.left - now.left),
          towards(now.turn, wanted.turn, turn)};
}

}  // namespace longarm
