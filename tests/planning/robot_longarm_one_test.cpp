// What the built-in robot must be able to do: reach the pipes its manual promises, stand in its canned poses, see.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "planning/collision/collision_world.h"
#include "planning/robot/ik.h"
#include "planning/world/workcell.h"

namespace longarm::planning {
namespace {

constexpr double kApproach = 0.10;       ///< Straight last leg [m].
constexpr double kMargin = 0.002;        ///< Kept between links and from the pipe [m].
constexpr double kPipeRadius = 0.02;

struct Pipe {
  Eigen::Vector3d middle, axis;
  double length = 0.3;
};

/// Pipes as cli.md promises them: middles 0.55-0.95 m from base_link, +-0.8 rad, heights 0.25-0.75 m, any direction.
class PipeSampler {
 public:
  explicit PipeSampler(bool distance_is_3d) : m_3d(distance_is_3d) {}

  Pipe next() {
    for (;;) {
      const double distance = uniform(0.55, 0.95), azimuth = uniform(-0.8, 0.8), height = uniform(0.25, 0.75);
      const double direction = uniform(0, M_PI);
      if (m_3d && distance <= height) continue;
      const double reach = m_3d ? std::sqrt(distance * distance - height * height) : distance;
      Pipe pipe{{reach * std::cos(azimuth), reach * std::sin(azimuth), height},
                {std::cos(direction), std::sin(direction), 0},
                uniform(0.2, 0.5)};
      return pipe;
    }
  }

 private:
  double uniform(double a, double b) { return std::uniform_real_distribution<>(a, b)(m_random); }
  bool m_3d;
  std::mt19937 m_random{11};
};

class LongarmOne : public testing::Test {
 protected:
  LongarmOne() {
    m_solver.setLimits(m_cell.arm_limits.lower, m_cell.arm_limits.upper);
    m_q[indexOf("gripper_joint")] = 0.045;
  }

  Eigen::Index indexOf(const std::string& joint) const {
    return m_cell.model->joints()[static_cast<std::size_t>(m_cell.model->jointIndex(joint).value())].q_index;
  }

  static WorldObject object(const Pipe& pipe) {
    WorldObject body;
    body.name = "pipe";
    body.shape = Cylinder{kPipeRadius, pipe.length};
    body.X_WO.translation() = pipe.middle;
    body.X_WO.linear() = rotationWithZ(pipe.axis);
    return body;
  }

  static Pose grasp(const Pipe& pipe, double tilt, bool flip) {
    const Eigen::Vector3d x = flip ? Eigen::Vector3d(-pipe.axis) : pipe.axis;
    const Eigen::Vector3d z = Eigen::AngleAxisd(tilt, pipe.axis) * Eigen::Vector3d(0, 0, -1);
    Pose X = Pose::Identity();
    X.linear() << x, z.cross(x), z;
    X.translation() = pipe.middle;
    return X;
  }

  /// Joint values of the straight leg from the grasp `q` back to the pre-grasp; empty if a joint leaves its limits.
  std::vector<Eigen::VectorXd> leg(const Pose& X_grasp, const Eigen::VectorXd& q) const {
    std::vector<Eigen::VectorXd> values{q};
    IkOptions single;
    single.restarts = 0;
    for (int i = 1; i <= 10; ++i) {
      Pose X = X_grasp;
      X.translation() -= 0.1 * i * kApproach * X.linear().col(2);
      const auto next = m_solver.solve(X, values.back(), single);
      constexpr double kNoFlip = 0.35;  // [rad] for 10 mm.
      if (!next || (next->joints - values.back()).cwiseAbs().maxCoeff() > kNoFlip) return {};
      values.push_back(next->joints);
    }
    return values;
  }

  /// Whether some roll about the pipe within `most_tilt` of straight down gives grasp and approach without contact.
  bool canGrasp(const Pipe& pipe, double most_tilt) {
    CollisionOptions options;
    options.padding = options.self_padding = kMargin;
    CollisionWorld world(m_cell.model, {object(pipe)}, *m_cell.model->srdfAllowedPairs(), options);
    world.allow("pipe", m_cell.gripper->links);
    for (double tilt = 0; tilt <= most_tilt; tilt += 0.17) {
      for (const double signed_tilt : {tilt, -tilt}) {
        for (const bool flip : {false, true}) {
          if (canGraspAt(grasp(pipe, signed_tilt, flip), world)) return true;
        }
      }
    }
    return false;
  }

  bool canGraspAt(const Pose& X_grasp, const CollisionWorld& world) {
    Eigen::VectorXd seed(6);
    seed << std::atan2(X_grasp.translation().y(), X_grasp.translation().x()), -0.1, 1.8, 0, 1.4, 0;
    IkOptions options;
    options.restarts = 12;
    const auto solutions = m_solver.solveAll(X_grasp, seed, options);
    if (!solutions) return false;
    return std::any_of(solutions->begin(), solutions->end(), [&](const IkSolution& solution) {
      const auto values = leg(X_grasp, solution.joints);
      return !values.empty() && std::all_of(values.begin(), values.end(), [&](const Eigen::VectorXd& arm) {
        setGroupPositions(*m_cell.model, m_cell.arm, arm, m_q);
        return !world.inCollision(m_q);
      });
    });
  }

  int countGraspable(bool distance_is_3d, double most_tilt, int tries) {
    PipeSampler sampler(distance_is_3d);
    int good = 0;
    for (int i = 0; i < tries; ++i) good += canGrasp(sampler.next(), most_tilt) ? 1 : 0;
    return good;
  }

  Eigen::VectorXd pose(const std::string& name) const {
    Eigen::VectorXd q = m_cell.model->neutral();
    q[indexOf("gripper_joint")] = m_cell.gripper->open;
    for (const auto& [joint, value] : m_cell.poses.at(name)) q[indexOf(joint)] = value;
    return q;
  }

  Workcell m_cell = loadBuiltInWorkcell().value();
  IkSolver m_solver{m_cell.model, m_cell.arm};
  Eigen::VectorXd m_q = m_cell.model->neutral();
};

TEST_F(LongarmOne, GraspsThePipesItPromisesWithinFortyFiveDegreesOfStraightDown) {
  EXPECT_GE(countGraspable(false, 0.8, 2000), 1990);  // 99.5 %
}

TEST_F(LongarmOne, GraspsThemAlsoWhenDistanceIsTakenInSpace) {
  // Some of these pipes lie above the chassis, a few across the arm's own column.
  EXPECT_GE(countGraspable(true, 1.4, 2000), 1990);
}

TEST_F(LongarmOne, StandsFreeAndAwayFromItsLimitsInEveryCannedPose) {
  for (const char* variant : {"", "ptz"}) {
    m_cell = loadBuiltInWorkcell(variant).value();
    CollisionOptions options;
    options.self_padding = 0.014;  // [m]
    const CollisionWorld world(m_cell.model, {}, *m_cell.model->srdfAllowedPairs(), options);
    for (const char* name : {"home", "stow", "ready", "look_ahead"}) {
      const Eigen::VectorXd q = pose(name);
      Contact contact;
      EXPECT_FALSE(world.inCollision(q, &contact)) << variant << " " << name << ": " << contact.sentence();
      const Eigen::VectorXd arm = groupPositions(*m_cell.model, m_cell.arm, q);
      EXPECT_GT((arm - m_cell.arm_limits.lower).minCoeff(), 0.2) << name;
      EXPECT_GT((m_cell.arm_limits.upper - arm).minCoeff(), 0.2) << name;
    }
  }
}

TEST_F(LongarmOne, KeepsTheArmOutOfTheHeadsViewAtHome) {
  for (const char* name : {"home", "stow"}) {
    const Eigen::VectorXd q = pose(name);
    std::vector<WorldObject> rays;
    for (const char* eye : {"head_left_optical", "head_right_optical"}) {
      const Eigen::Vector3d from = m_cell.model->forward(q, m_cell.model->linkIndex(eye).value()).translation();
      for (const double x : {0.5, 0.75, 1.0}) {
        for (const double y : {-0.6, -0.3, 0.0, 0.3, 0.6}) {
          for (const double z : {0.2, 0.5, 0.8}) {
            const Eigen::Vector3d ray = Eigen::Vector3d(x, y, z) - from;
            const double start = 0.25;  // Beyond the head itself.
            WorldObject body;
            body.name = "ray";
            body.shape = Cylinder{0.005, ray.norm() - start};
            body.X_WO.translation() = from + ray.normalized() * 0.5 * (ray.norm() + start);
            body.X_WO.linear() = rotationWithZ(ray);
            rays.push_back(body);
          }
        }
      }
    }
    const CollisionWorld world(m_cell.model, rays, *m_cell.model->srdfAllowedPairs());
    Contact contact;
    EXPECT_FALSE(world.inCollision(q, &contact)) << name << ": " << contact.sentence();
  }
}

TEST_F(LongarmOne, CarriesItsCamerasWhereTheConsoleExpectsThem) {
  const Eigen::VectorXd q = m_cell.model->neutral();
  const auto frame = [&](const char* link) { return m_cell.model->forward(q, m_cell.model->linkIndex(link).value()); };
  const Pose left = frame("head_left_optical"), right = frame("head_right_optical");
  EXPECT_NEAR((left.translation() - right.translation()).norm(), 0.254, 1e-9);
  EXPECT_NEAR(left.translation().z(), 1.25, 0.05);
  EXPECT_LT((left.linear() - right.linear()).norm(), 1e-9);
  EXPECT_GT(left.linear()(0, 2), 0.7);     // Looks forward ...
  EXPECT_LT(left.linear()(2, 2), -0.4);    // ... and down;
  EXPECT_NEAR(left.linear()(1, 0), -1, 1e-9);  // image x is to the robot's right.
  EXPECT_GT(frame("drive_optical").linear()(0, 2), 0.9);
  EXPECT_LT(frame("reverse_optical").linear()(0, 2), -0.9);
  const Pose tip = frame("tool_tip"), wrist = frame("wrist_optical");
  EXPECT_GT(wrist.linear().col(2).dot(tip.linear().col(2)), 0.95);
}

TEST_F(LongarmOne, OpensItsFingersAlongToolY) {
  Eigen::VectorXd q = m_cell.model->neutral();
  const auto gap = [&](double opening) {
    q[indexOf("gripper_joint")] = opening;
    const Pose X_TW = m_cell.model->forward(q, m_cell.model->linkIndex("tool_tip").value()).inverse();
    const Pose left = X_TW * m_cell.model->forward(q, m_cell.model->linkIndex("finger_left_link").value());
    const Pose right = X_TW * m_cell.model->forward(q, m_cell.model->linkIndex("finger_right_link").value());
    return Eigen::Vector3d(left.translation() - right.translation());
  };
  EXPECT_LT(gap(0).norm(), 1e-9);
  EXPECT_LT((gap(0.05) - Eigen::Vector3d(0, 0.1, 0)).norm(), 1e-9);
}

TEST_F(LongarmOne, IsDrawnWithFewTriangles) {
  std::size_t triangles = 0;
  for (const auto& link : m_cell.model->links()) {
    for (const auto& visual : link.visuals) {
      const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&visual.shape);
      triangles += mesh != nullptr ? (*mesh)->triangles.size() : 96;  // A cylinder of 24 sides.
    }
  }
  EXPECT_LT(triangles, 8000u);
}

}  // namespace
}  // namespace longarm::planning
