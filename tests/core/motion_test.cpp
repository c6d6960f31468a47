#include <gtest/gtest.h>

#include "core/motion.h"

namespace longarm {
namespace {

Trajectory oneJointMove() {
  Trajectory t;
  t.joint_names = {"j1"};
  const auto v = [](double x) { return Eigen::VectorXd::Constant(1, x); };
  t.points = {{0, v(0), v(0), v(0)}, {1, v(0.5), v(1), v(0)}, {2, v(1), v(0), v(0)}};
  return t;
}

TEST(Trajectory, SamplePassesThroughEveryPointWithItsVelocity) {
  const auto t = oneJointMove();
  for (const auto& p : t.points) {
    const auto s = t.sample(p.t);
    EXPECT_NEAR(s.positions[0], p.positions[0], 1e-12);
    EXPECT_NEAR(s.velocities[0], p.velocities[0], 1e-12);
  }
  EXPECT_DOUBLE_EQ(t.sample(-1).positions[0], 0);
  EXPECT_DOUBLE_EQ(t.sample(9).positions[0], 1);
}

TEST(Trajectory, SampledVelocityIsTheDerivativeOfPosition) {
  const auto t = oneJointMove();
  const double h = 1e-6;
  for (double at : {0.1, 0.5, 0.9, 1.3, 1.9}) {
    const double numeric = (t.sample(at + h).positions[0] - t.sample(at - h).positions[0]) / (2 * h);
    EXPECT_NEAR(t.sample(at).velocities[0], numeric, 1e-7);
  }
}

TEST(Trajectory, ValidateNamesWhatIsWrong) {
  EXPECT_TRUE(validate(oneJointMove()).ok());
  auto moving = oneJointMove();
  moving.points.back().velocities[0] = 0.3;
  EXPECT_NE(validate(moving).error().message.find("j1 moves at 0.3"), std::string::npos);
  auto late = oneJointMove();
  late.points[2].t = 1;
  EXPECT_NE(validate(late).error().message.find("t = 1"), std::string::npos);
  auto nan = oneJointMove();
  nan.points[1].positions[0] = std::nan("");
  EXPECT_FALSE(validate(nan).ok());
  EXPECT_FALSE(validate(Trajectory{}).ok());
}

TEST(JointState, PositionsOfNamesTheMissingJoint) {
  JointState s;
  s.names = {"a", "b"};
  s.positions = Eigen::Vector2d(1, 2);
  EXPECT_DOUBLE_EQ((*s.positionsOf({"b", "a"}))[0], 2);
  EXPECT_NE(s.positionsOf({"a", "wrist"}).error().message.find("\"wrist\""), std::string::npos);
}

}  // namespace
}  // namespace longarm
