#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/resource_path.h"
#include "planning/robot/ik.h"
#include "tests/support/test_data.h"

namespace longarm::planning {
namespace {

std::shared_ptr<const RobotModel> builtIn() {
  return RobotModel::load(resourcePath("robots/longarm_one/longarm_one.urdf").value(), {}, {{}, false}).value();
}

/// Random values of a group inside its limits (+-pi where there are none).
Eigen::VectorXd randomValues(const RobotModel& model, const JointGroup& group, std::mt19937& random) {
  Eigen::VectorXd q(static_cast<Eigen::Index>(group.joints.size()));
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const Joint& joint = model.joints()[static_cast<std::size_t>(group.joints[static_cast<std::size_t>(i)])];
    const bool limited = std::isfinite(joint.lower);
    q[i] = std::uniform_real_distribution<>(limited ? joint.lower : -M_PI, limited ? joint.upper : M_PI)(random);
  }
  return q;
}

class IkTest : public testing::Test {
 protected:
  std::shared_ptr<const RobotModel> m_model = builtIn();
  JointGroup m_arm = m_model->chain("base_link", "tool_tip").value();
  IkSolver m_solver{m_model, m_arm};
  std::mt19937 m_random{7};
};

TEST_F(IkTest, ChainAgreesWithTheModel) {
  for (int k = 0; k < 200; ++k) {
    Eigen::VectorXd full = m_model->neutral();
    const Eigen::VectorXd q = randomValues(*m_model, m_arm, m_random);
    setGroupPositions(*m_model, m_arm, q, full);
    const Pose X = m_model->forward(full, m_model->linkIndex("tool_tip").value());
    Eigen::Matrix3d R;
    Eigen::Vector3d p;
    Eigen::MatrixXd J(6, q.size());
    m_solver.kinematics().forwardAndJacobian(q.data(), R, p, J.data());
    constexpr double kRounding = 1e-12;
    EXPECT_LT((X.linear() - R).norm(), kRounding);
    EXPECT_LT((X.translation() - p).norm(), kRounding);
    EXPECT_LT((m_model->jacobian(full, m_arm) - J).norm(), kRounding);
    EXPECT_LT((m_solver.kinematics().forward(q.data()).matrix() - X.matrix()).norm(), kRounding);
  }
}

TEST_F(IkTest, HoldsJointsOutsideTheGroupAtTheReference) {
  const auto head = m_model->chain("torso_link", "head_left_optical").value();
  Eigen::VectorXd full = m_model->neutral();
  full[m_model->joints()[static_cast<std::size_t>(m_model->jointIndex("torso_joint").value())].q_index] = 0.25;
  const ChainKinematics chain(*m_model, head, full);
  const Eigen::Vector2d zero(0, 0);
  const Pose expected = m_model->forward(full, m_model->linkIndex("head_left_optical").value());
  EXPECT_LT((chain.forward(zero.data()).matrix() - expected.matrix()).norm(), 1e-12);
}

TEST_F(IkTest, FindsEveryReachablePoseWithinLimitsAndChecksIt) {
  for (int k = 0; k < 1000; ++k) {
    const Eigen::VectorXd truth = randomValues(*m_model, m_arm, m_random);
    const Pose goal = m_solver.kinematics().forward(truth.data());
    IkOptions options;
    options.restarts = 60;
    const auto found = m_solver.solve(goal, randomValues(*m_model, m_arm, m_random), options);
    ASSERT_TRUE(found.ok()) << k << ": " << found.error().message;
    const Pose reached = m_solver.kinematics().forward(found->joints.data());
    EXPECT_LT((reached.translation() - goal.translation()).norm(), 1e-6);
    EXPECT_LT(angleBetween(reached.linear(), goal.linear()), 1e-6);
    for (std::size_t i = 0; i < m_arm.joints.size(); ++i) {
      const Joint& joint = m_model->joints()[static_cast<std::size_t>(m_arm.joints[i])];
      EXPECT_GE(found->joints[static_cast<Eigen::Index>(i)], joint.lower);
      EXPECT_LE(found->joints[static_cast<Eigen::Index>(i)], joint.upper);
    }
  }
}

TEST_F(IkTest, GivesTheSameAnswerForTheSameSeed) {
  const Eigen::VectorXd truth = randomValues(*m_model, m_arm, m_random);
  const Pose goal = m_solver.kinematics().forward(truth.data());
  const auto a = m_solver.solve(goal, Eigen::VectorXd::Zero(6)), b = m_solver.solve(goal, Eigen::VectorXd::Zero(6));
  ASSERT_TRUE(a.ok());
  EXPECT_EQ(a->joints, b->joints);
}

TEST_F(IkTest, KeepsNarrowerLimitsWhenGiven) {
  Eigen::VectorXd lower(6), upper(6);
  lower << -1, -1, 0, -1, 0, -1;
  upper << 1, 1, 2, 1, 2, 1;
  m_solver.setLimits(lower, upper);
  const Eigen::VectorXd truth = 0.3 * lower + 0.7 * upper;
  const auto found = m_solver.solve(m_solver.kinematics().forward(truth.data()), lower);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_TRUE((found->joints.array() >= lower.array()).all() && (found->joints.array() <= upper.array()).all());
}

TEST_F(IkTest, LeavesFreeDirectionsFree) {
  const Eigen::VectorXd truth = (Eigen::VectorXd(6) << 0.3, 0.4, 1.3, 0.2, 1.2, 0.5).finished();
  const Pose goal = m_solver.kinematics().forward(truth.data());
  IkOptions options;
  options.free = {true, false, false, true, false, false};  // Roll about and shift along the pipe: tool x.
  const Eigen::VectorXd seed = truth + Eigen::VectorXd::Constant(6, 0.15);
  const auto found = m_solver.solve(goal, seed, options);
  ASSERT_TRUE(found.ok()) << found.error().message;
  const Pose difference = goal.inverse() * m_solver.kinematics().forward(found->joints.data());
  EXPECT_LT(difference.translation().tail<2>().norm(), 1e-5);  // The free turn moves nothing off the axis.
  EXPECT_NEAR(difference.linear()(0, 0), 1, 1e-9);
  EXPECT_GT((difference.matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-3);
}

TEST_F(IkTest, FindsTheBranchesOfAPose) {
  const Eigen::VectorXd truth = (Eigen::VectorXd(6) << 0.3, 0.4, 1.3, 0.2, 1.2, 0.5).finished();
  const Pose goal = m_solver.kinematics().forward(truth.data());
  IkOptions options;
  options.restarts = 200;
  const auto all = m_solver.solveAll(goal, truth, options);
  ASSERT_TRUE(all.ok());
  EXPECT_LT((all->front().joints - truth).norm(), 1e-4);
  EXPECT_GE(all->size(), 2u);
  for (const auto& one : *all) {
    EXPECT_LT((m_solver.kinematics().forward(one.joints.data()).translation() - goal.translation()).norm(), 1e-6);
  }
}

TEST_F(IkTest, SaysHowFarOutOfReachAPoseIs) {
  Pose far = Pose::Identity();
  far.translation() << 5, 0, 0.5;
  const auto found = m_solver.solve(far, Eigen::VectorXd::Zero(6));
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().code, ErrorCode::kNoSolution);
  EXPECT_NE(found.error().message.find("mm"), std::string::npos);
}

TEST_F(IkTest, RefusesGoalsAndSeedsThatAreNone) {
  Pose bad = Pose::Identity();
  bad.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(m_solver.solve(bad, Eigen::VectorXd::Zero(6)).error().code, ErrorCode::kInvalidInput);
  bad = Pose::Identity();
  bad.linear() *= 2;
  EXPECT_EQ(m_solver.solve(bad, Eigen::VectorXd::Zero(6)).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(m_solver.solve(Pose::Identity(), Eigen::VectorXd::Zero(5)).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(m_solver.solveAll(Pose::Identity(), Eigen::VectorXd::Zero(5)).error().code, ErrorCode::kInvalidInput);
}

TEST(IkOfOthers, SolvesTheUr5FromRandomSeeds) {
  LONGARM_SKIP_WITHOUT_DATA();
  const auto model = RobotModel::load(tests::dataFolder() + "/robots/ur_expanded/ur5.urdf").value();
  const auto arm = model->chain("base_link", "tool0").value();
  const IkSolver solver(model, arm);
  std::mt19937 random(3);
  for (int k = 0; k < 1000; ++k) {
    const Pose goal = solver.kinematics().forward(randomValues(*model, arm, random).data());
    EXPECT_TRUE(solver.solve(goal, randomValues(*model, arm, random)).ok()) << k;
  }
}

}  // namespace
}  // namespace longarm::planning
