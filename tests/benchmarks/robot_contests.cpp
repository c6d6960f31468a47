// Kinematics against KDL, on the built-in arm and on one of seven joints.
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include <benchmark/benchmark.h>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainiksolverpos_nr.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "core/resource_path.h"
#include "core/text.h"
#include "planning/macros/feature_geometry.h"
#include "planning/macros/macro.h"
#include "planning/macros/reach_advice.h"
#include "planning/robot/ik.h"
#include "planning/world/workcell.h"
#include "tests/benchmarks/gate.h"

namespace longarm::benchmarks {
namespace {

using Eigen::VectorXd;
using planning::RobotModel;

constexpr int kPoses = 200, kIkChecked = 10000, kRestarts = 20, kWaypoints = 100;

// Random restarts until it is solved; only a pose that cannot be reached costs them all.
planning::IkOptions thorough() {
  planning::IkOptions options;
  options.restarts = 200;
  return options;
}

KDL::Frame frameOf(const Pose& X) {
  KDL::Frame frame;
  for (int i = 0; i < 3; ++i) {
    frame.p[i] = X.translation()[i];
    for (int j = 0; j < 3; ++j) frame.M(i, j) = X.linear()(i, j);
  }
  return frame;
}

Pose poseOf(const KDL::Frame& frame) {
  Pose X = Pose::Identity();
  for (int i = 0; i < 3; ++i) {
    X.translation()[i] = frame.p[i];
    for (int j = 0; j < 3; ++j) X.linear()(i, j) = frame.M(i, j);
  }
  return X;
}

KDL::JntArray arrayOf(const VectorXd& q) {
  KDL::JntArray out(static_cast<unsigned>(q.size()));
  out.data = q;
  return out;
}

// One arm for both sides; joints outside of it stand at neutral.
struct Arm {
  explicit Arm(planning::Workcell of) : cell(std::move(of)), solver(cell.model, cell.arm), lower(cell.arm_limits.lower),
          upper(cell.arm_limits.upper), random(7) {
    solver.setLimits(lower, upper);
    buildChain();
    fk = std::make_unique<KDL::ChainFkSolverPos_recursive>(chain);
    jacobian = std::make_unique<KDL::ChainJntToJacSolver>(chain);
    lma = std::make_unique<KDL::ChainIkSolverPos_LMA>(chain, 1e-6, 200);
    velocity = std::make_unique<KDL::ChainIkSolverVel_pinv>(chain);
    newton = std::make_unique<KDL::ChainIkSolverPos_NR>(chain, *fk, *velocity, 200, 1e-7);
  }

  // Root to tip, every joint in the way; those that are not the arm's are frozen where neutral() puts them.
  void buildChain() {
    const RobotModel& model = *cell.model;
    std::vector<int> way;
    for (int link = *model.linkIndex(cell.arm.tip_link); model.links()[static_cast<std::size_t>(link)].parent_joint >= 0;) {
      way.push_back(model.links()[static_cast<std::size_t>(link)].parent_joint);
      link = model.joints()[static_cast<std::size_t>(way.back())].parent_link;
    }
    const VectorXd neutral = model.neutral();
    for (auto it = way.rbegin(); it != way.rend(); ++it) {
      const auto& joint = model.joints()[static_cast<std::size_t>(*it)];
      const KDL::Frame X = frameOf(joint.X_PJ);
      const KDL::Vector axis(joint.axis.x(), joint.axis.y(), joint.axis.z());
      const bool moves = std::find(cell.arm.joints.begin(), cell.arm.joints.end(), *it) != cell.arm.joints.end();
      if (moves) {
        chain.addSegment(KDL::Segment(KDL::Joint(joint.name, X.p, X.M * axis, KDL::Joint::RotAxis), X));
        continue;
      }
      Pose still = joint.X_PJ;
      if (joint.q_index >= 0) {
        const double q = neutral[joint.q_index];
        if (joint.type == planning::JointType::kPrismatic) still.translate(joint.axis * q);
        else still.rotate(Eigen::AngleAxisd(q, joint.axis));
      }
      chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), frameOf(still)));
    }
  }

  VectorXd randomJoints() {
    VectorXd q(lower.size());
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      q[j] = std::uniform_real_distribution<>(std::max(lower[j], -M_PI), std::min(upper[j], M_PI))(random);
    }
    return q;
  }
  bool inside(const VectorXd& q) const { return ((q - lower).array() >= -1e-9).all() && ((upper - q).array() >= -1e-9).all(); }

  // KDL as its users run it: the seed, then random restarts until an answer lies within the limits.
  bool kdlSolve(const KDL::Frame& goal, const VectorXd& seed, std::mt19937& restarts, VectorXd& q) {
    VectorXd start = seed;
    for (int attempt = 0; attempt <= kRestarts; ++attempt) {
      KDL::JntArray out(static_cast<unsigned>(seed.size()));
      if (lma->CartToJnt(arrayOf(start), goal, out) >= 0) {
        q = out.data;
        for (Eigen::Index j = 0; j < q.size(); ++j) q[j] = std::remainder(q[j], 2 * M_PI);
        if (inside(q)) return true;
      }
      for (Eigen::Index j = 0; j < start.size(); ++j) start[j] = std::uniform_real_distribution<>(lower[j], upper[j])(restarts);
    }
    return false;
  }

  planning::Workcell cell;
  planning::IkSolver solver;
  VectorXd lower, upper;
  std::mt19937 random;
  KDL::Chain chain;
  std::unique_ptr<KDL::ChainFkSolverPos_recursive> fk;
  std::unique_ptr<KDL::ChainJntToJacSolver> jacobian;
  std::unique_ptr<KDL::ChainIkSolverPos_LMA> lma;
  std::unique_ptr<KDL::ChainIkSolverVel_pinv> velocity;
  std::unique_ptr<KDL::ChainIkSolverPos_NR> newton;
};

struct Queries {
  explicit Queries(Arm& arm) {
    for (int i = 0; i < kPoses; ++i) {
      joints.push_back(arm.randomJoints());
      seeds.push_back(arm.randomJoints());
      goals.push_back(arm.solver.kinematics().forward(joints.back().data()));
      frames.push_back(frameOf(goals.back()));
    }
  }
  std::vector<VectorXd> joints, seeds;
  std::vector<Pose> goals;
  std::vector<KDL::Frame> frames;
};

Contest kinematicsContest(const std::shared_ptr<Arm>& arm, const std::shared_ptr<Queries>& queries) {
  Contest contest{"fk_jacobian", "KDL ChainFkSolverPos_recursive + ChainJntToJacSolver", {}, {}, 3, 8, false, {}};
  contest.ours = [arm, queries] {
    Eigen::Matrix3d R;
    Eigen::Vector3d p;
    double J[6 * 6];
    for (const auto& q : queries->joints) {
      arm->solver.kinematics().forwardAndJacobian(q.data(), R, p, J);
      benchmark::DoNotOptimize(J[5] + p.x());
    }
  };
  contest.theirs = [arm, queries] {
    KDL::Frame frame;
    KDL::Jacobian J(arm->chain.getNrOfJoints());
    for (const auto& q : queries->joints) {
      const KDL::JntArray array = arrayOf(q);
      arm->fk->JntToCart(array, frame);
      arm->jacobian->JntToJac(array, J);
      benchmark::DoNotOptimize(J(0, 5) + frame.p.x());
    }
  };
  contest.accuracy = [arm, queries] {
    double worst = 0;
    for (const auto& q : queries->joints) {
      Eigen::Matrix3d R;
      Eigen::Vector3d p;
      Eigen::Matrix<double, 6, Eigen::Dynamic> J(6, q.size());
      arm->solver.kinematics().forwardAndJacobian(q.data(), R, p, J.data());
      KDL::Frame frame;
      KDL::Jacobian theirs(arm->chain.getNrOfJoints());
      arm->fk->JntToCart(arrayOf(q), frame);
      arm->jacobian->JntToJac(arrayOf(q), theirs);
      const Pose X = poseOf(frame);
      worst = std::max({worst, (X.linear() - R).cwiseAbs().maxCoeff(), (X.translation() - p).cwiseAbs().maxCoeff(),
                        (theirs.data.topRows(3) - J.bottomRows(3)).cwiseAbs().maxCoeff(),
                        (theirs.data.bottomRows(3) - J.topRows(3)).cwiseAbs().maxCoeff()});
    }
    return Accuracy{worst < 1e-12, "at most " + formatNumber(worst) + " from KDL's pose and Jacobian (limit 1e-12)"};
  };
  return contest;
}

// Every answer by forward kinematics and against the limits.
Accuracy ikAccuracy(Arm& arm) {
  std::mt19937 restarts(3);
  int solved = 0, theirs = 0;
  double worst = 0;
  for (int i = 0; i < kIkChecked; ++i) {
    const VectorXd truth = arm.randomJoints(), seed = arm.randomJoints();
    const Pose goal = arm.solver.kinematics().forward(truth.data());
    if (const auto answer = arm.solver.solve(goal, seed, thorough())) {
      const Pose reached = arm.solver.kinematics().forward(answer->joints.data());
      const double off = (reached.translation() - goal.translation()).norm() +
                         Eigen::AngleAxisd(reached.linear().transpose() * goal.linear()).angle();
      if (arm.inside(answer->joints) && off < 1e-5) ++solved;
      worst = std::max(worst, off);
    }
    VectorXd q;
    if (i % 20 == 0 && arm.kdlSolve(frameOf(goal), seed, restarts, q)) ++theirs;
  }
  return {solved == kIkChecked, formatFixed(100.0 * solved / kIkChecked, 2) + " % of 10,000 poses solved within the limits, worst " +
                                    formatNumber(worst) + " off (KDL " + formatFixed(100.0 * theirs * 20 / kIkChecked, 1) +
                                    " % of 500; limit 100 %)"};
}

Contest ikContest(const std::string& name, const std::shared_ptr<Arm>& arm, const std::shared_ptr<Queries>& queries) {
  Contest contest{name, "KDL ChainIkSolverPos_LMA, 20 random restarts within limits", {}, {}, 4, 10, false, {}};
  contest.ours = [arm, queries] {
    for (std::size_t i = 0; i < queries->goals.size(); ++i) {
      benchmark::DoNotOptimize(arm->solver.solve(queries->goals[i], queries->seeds[i], thorough()).ok());
    }
  };
  const auto restarts = std::make_shared<std::mt19937>(5);
  contest.theirs = [arm, queries, restarts] {
    VectorXd q;
    for (std::size_t i = 0; i < queries->frames.size(); ++i) {
      benchmark::DoNotOptimize(arm->kdlSolve(queries->frames[i], queries->seeds[i], *restarts, q));
    }
  };
  contest.accuracy = [arm] { return ikAccuracy(*arm); };
  return contest;
}

// A straight way of the tool in a hundred steps, each solved from the one before.
struct Way {
  explicit Way(Arm& arm) {
    VectorXd q(arm.lower.size());
    for (const auto& [name, value] : arm.cell.poses.at("ready")) {
      const auto names = arm.cell.armJointNames();
      const auto at = std::find(names.begin(), names.end(), name);
      if (at != names.end()) q[at - names.begin()] = value;
    }
    start = q;
    const Pose from = arm.solver.kinematics().forward(q.data());
    for (int i = 1; i <= kWaypoints; ++i) {
      Pose X = from;
      X.translation() += Eigen::Vector3d(0.10, 0.08, 0.12) * (static_cast<double>(i) / kWaypoints);
      X.linear() = from.linear() * Eigen::AngleAxisd(0.3 * i / kWaypoints, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      goals.push_back(X);
      frames.push_back(frameOf(X));
    }
  }
  VectorXd start;
  std::vector<Pose> goals;
  std::vector<KDL::Frame> frames;
};

// Largest step of a joint between two waypoints; -1 when one was not solved.
double walk(Arm& arm, const Way& way) {
  VectorXd q = way.start;
  double jump = 0;
  for (const auto& goal : way.goals) {
    const auto next = arm.solver.solve(goal, q);
    if (!next) return -1;
    jump = std::max(jump, (next->joints - q).cwiseAbs().maxCoeff());
    q = next->joints;
  }
  return jump;
}

Contest cartesianContest(const std::shared_ptr<Arm>& arm) {
  const auto way = std::make_shared<Way>(*arm);
  Contest contest{"cartesian_100", "KDL ChainIkSolverPos_NR with pseudo-inverse", {}, {}, 8, 25, false, {}};
  contest.ours = [arm, way] { benchmark::DoNotOptimize(walk(*arm, *way)); };
  contest.theirs = [arm, way] {
    KDL::JntArray q = arrayOf(way->start), next(arm->chain.getNrOfJoints());
    for (const auto& frame : way->frames) {
      benchmark::DoNotOptimize(arm->newton->CartToJnt(q, frame, next));
      q = next;
    }
  };
  contest.accuracy = [arm, way] {
    const double jump = walk(*arm, *way);
    return Accuracy{jump >= 0 && jump < 0.05, "largest joint step " + formatNumber(jump) + " rad of 100 waypoints (limit 0.05: no change of branch)"};
  };
  return contest;
}

// "Can the tool touch this point?" asked while the point is dragged from before the robot to beyond its reach.  Ours looks at the
// approach and at collisions too; KDL is asked for the same entry of the approach, turned about the tool's axis as freely.
struct Drag {
  static constexpr int kPoints = 40, kRolls = 24;
  explicit Drag(const Arm& arm) : macros(planning::makeMacros(arm.cell)), touch(planning::findMacro(macros, "touch")) {
    context.workcell = &arm.cell;
    context.start = arm.cell.model->neutral();
    for (const auto& [name, value] : arm.cell.poses.at("ready")) {
      const auto joint = arm.cell.model->jointIndex(name);
      if (joint) context.start[arm.cell.model->joints()[static_cast<std::size_t>(*joint)].q_index] = value;
    }
    const planning::Reach reach = planning::reachOf(arm.cell, context.start);
    for (int i = 0; i < kPoints; ++i) {
      vision::Feature point;
      point.kind = vision::FeatureKind::kPoint;
      point.vertices.resize(1);
      point.vertices[0].xyz = Eigen::Vector3d(0.6 + 0.03 * i, 0.1, 0.5);
      const Eigen::Vector3d z = (point.vertices[0].xyz - reach.shoulder).normalized();
      Pose X = planning::poseAt(point.vertices[0].xyz - 0.10 * z, planning::toolRotation(z, Eigen::Vector3d::UnitZ()));
      std::vector<KDL::Frame> turned;
      for (int k = 0; k < kRolls; ++k) turned.push_back(frameOf(X * Eigen::AngleAxisd(2 * M_PI * k / kRolls, Eigen::Vector3d::UnitZ())));
      points.push_back(std::move(point));
      entries.push_back(std::move(turned));
    }
  }
  int ours() const {
    int reached = 0;
    planning::ReachAnswer last;
    for (const auto& point : points) {
      last = touch->reach(context, point, last.seed);
      reached += last.level != planning::ReachAnswer::Level::kNot;
    }
    return reached;
  }
  int theirs(Arm& arm) const {
    int reached = 0;
    std::mt19937 restarts(3);
    VectorXd q = 0.5 * (arm.lower + arm.upper);
    for (const auto& entry : entries) {
      reached += std::any_of(entry.begin(), entry.end(), [&](const KDL::Frame& frame) { return arm.kdlSolve(frame, q, restarts, q); });
    }
    return reached;
  }
  std::vector<std::unique_ptr<planning::Macro>> macros;
  const planning::Macro* touch;
  planning::PlanContext context;
  std::vector<vision::Feature> points;
  std::vector<std::vector<KDL::Frame>> entries;
};

Contest reachContest(const std::shared_ptr<Arm>& arm) {
  const auto drag = std::make_shared<Drag>(*arm);
  Contest contest{"reach_question", "KDL ChainIkSolverPos_LMA with restarts, 24 rolls, no collisions", {}, {}, 1, 10, false, {}};
  contest.ours = [drag] { benchmark::DoNotOptimize(drag->ours()); };
  contest.theirs = [drag, arm] { benchmark::DoNotOptimize(drag->theirs(*arm)); };
  contest.accuracy = [drag, arm] {
    const int ours = drag->ours(), theirs = drag->theirs(*arm);
    return Accuracy{ours > 0 && ours < Drag::kPoints, std::to_string(ours) + " of " + std::to_string(Drag::kPoints) +
                                                          " points of the drag are reached (KDL: " + std::to_string(theirs) + ", square to the sight only)"};
  };
  return contest;
}

}  // namespace

std::vector<Contest> robotContests() {
  const auto arm = std::make_shared<Arm>(planning::loadBuiltInWorkcell().value());
  const auto queries = std::make_shared<Queries>(*arm);
  const auto seven = std::make_shared<Arm>(planning::loadWorkcell(resourcePath("robots/seven_joints/workcell.yaml").value()).value());
  return {kinematicsContest(arm, queries), ikContest("ik", arm, queries), ikContest("ik_seven_joints", seven, std::make_shared<Queries>(*seven)),
          cartesianContest(arm), reachContest(arm)};
}

}  // namespace longarm::benchmarks
