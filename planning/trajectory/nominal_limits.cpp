#include "planning/trajectory/nominal_limits.h"

#include <cmath>

#include "core/require.h"

namespace longarm::planning {
namespace {

constexpr double kAccelerationShare = 0.125;   // of the limit, at rate 1

}  // namespace

NominalLimits nominalLimits(const MotionLimits& limits, const PlaybackReserve& reserve) {
  const double root = std::sqrt(kAccelerationShare);
  LONGARM_REQUIRE(reserve.stop_rate * root < 1, "playback rate leaves no acceleration for braking");
  // Integral of dr / (1 - share r^2) from 0 to stop_rate.
  const double braking = std::atanh(reserve.stop_rate * root) / root;
  const double beta = reserve.stop_s / braking;
  return {(limits.max_velocity / reserve.max_rate).cwiseMin(beta * limits.max_acceleration),
          kAccelerationShare * limits.max_acceleration};
}

}  // namespace longarm::planning
