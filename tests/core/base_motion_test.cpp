#include "core/base_motion.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace longarm {
namespace {

BaseState at(double x, double y, double yaw_deg) {
  BaseState state;
  state.x = x;
  state.y = y;
  state.yaw = yaw_deg * M_PI / 180;
  return state;
}

TEST(BaseMotion, ATwistBeyondTheCapsIsRefusedNamingValueAndLimit) {
  const BaseLimits limits;
  EXPECT_TRUE(checkTwist({0.3, 0, 0.5}, limits).ok());
  EXPECT_EQ(checkTwist({0.31, 0, 0}, limits).error().code, ErrorCode::kOutOfLimits);
  EXPECT_NE(checkTwist({-0.4, 0, 0}, limits).error().message.find("0.400"), std::string::npos);
  EXPECT_EQ(checkTwist({0, 0, -0.6}, limits).error().code, ErrorCode::kOutOfLimits);
  EXPECT_EQ(checkTwist({0, 0.1, 0}, limits).error().code, ErrorCode::kOutOfLimits)
      << "tracks do not go sideways";
  EXPECT_EQ(checkTwist({std::nan(""), 0, 0}, limits).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(checkTwist({0, 0, std::numeric_limits<double>::infinity()}, limits).error().code,
            ErrorCode::kInvalidInput);
  BaseLimits free = limits;
  free.sideways = true;
  EXPECT_TRUE(checkTwist({0.2, 0.2, 0}, free).ok());
  EXPECT_FALSE(checkTwist({0.25, 0.25, 0}, free).ok()) << "the cap is one of speed, not of each axis";
}

TEST(BaseMotion, RampsWithinItsAccelerationsAndArrives) {
  BaseLimits limits;
  limits.sideways = true;
  BaseTwist now;
  const BaseTwist wanted{0.2, -0.1, 0.4};
  int steps = 0;
  for (; steps < 100 && !(now.forward == wanted.forward && now.turn == wanted.turn); ++steps) {
    const BaseTwist next = rampTowards(now, wanted, limits, 0.02);
    EXPECT_LE(std::hypot(next.forward - now.forward, next.left - now.left),
              0.02 * limits.max_acceleration + 1e-12);
    EXPECT_LE(std::abs(next.turn - now.turn), 0.02 * limits.max_turn_acceleration + 1e-12);
    now = next;
  }
  EXPECT_EQ(now.left, wanted.left);
  EXPECT_NEAR(steps, 23, 2);
}

TEST(BaseMotion, TheSamePlaceIsTenMillimetresAndHalfADegree) {
  EXPECT_TRUE(samePlace(at(1, 2, 10), at(1.0099, 2, 10)));
  EXPECT_FALSE(samePlace(at(1, 2, 10), at(1.0101, 2, 10)));
  EXPECT_TRUE(samePlace(at(0, 0, 179.8), at(0, 0, -179.9)));
  EXPECT_FALSE(samePlace(at(0, 0, 0), at(0, 0, 0.51)));
  EXPECT_NEAR(shiftBetween(at(0, 0, 0), at(3, 4, 359)).way, 5, 1e-12);
  EXPECT_NEAR(shiftBetween(at(0, 0, 0), at(3, 4, 359)).turn, M_PI / 180, 1e-12);
}

TEST(BaseMotion, ThePoseTurnsLeftAboutUp) {
  const Pose X = poseOf(at(1, 2, 90));
  EXPECT_LT((X * Eigen::Vector3d(1, 0, 0.5) - Eigen::Vector3d(1, 3, 0.5)).norm(), 1e-12);
}

}  // namespace
}  // namespace longarm
