// Jogging: straight in every frame, inside the limits, never into what is known, at rest when let go of.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "planning/jog/jogger.h"
#include "planning/world/workcell.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kTick_s = 0.02;
constexpr double kSlack = 1.0001;

const Workcell& builtIn() {
  static const Workcell cell = [] {
    auto loaded = loadBuiltInWorkcell();
    EXPECT_TRUE(loaded.ok()) << loaded.error().message;
    return loaded.ok() ? *loaded : Workcell{};
  }();
  return cell;
}

// An arm that does exactly what it is sent.
class Bench {
 public:
  explicit Bench(const std::string& pose = "ready", std::vector<WorldObject> objects = {}) {
    auto cell = std::make_shared<Workcell>(builtIn());
    cell->objects = std::move(objects);
    m_cell = cell;
    m_q = m_cell->model->neutral();
    for (const auto& [joint, value] : m_cell->poses.at(pose)) {
      m_q[m_cell->model->joints()[static_cast<std::size_t>(*m_cell->model->jointIndex(joint))].q_index] = value;
    }
    m_jogger = std::make_unique<Jogger>(m_cell);
    CollisionOptions options;
    options.moving = movingIndices(*m_cell->model, m_cell->arm);
    m_world = std::make_unique<CollisionWorld>(m_cell->model, m_cell->objects, allowedPairs(m_cell->model), options);
    m_world->setPadding(0.5 * m_world->padding(), 0.5 * m_world->selfPadding());   // what segmentFree() promises in between
  }

  const Workcell& cell() const { return *m_cell; }
  Jogger& jogger() { return *m_jogger; }
  const VectorXd& q() const { return m_q; }
  double now() const { return m_now; }
  Pose tip() const { return m_cell->model->forward(m_q, *m_cell->model->linkIndex(m_cell->arm.tip_link)); }
  VectorXd arm() const { return groupPositions(*m_cell->model, m_cell->arm, m_q); }
  bool touches() const { return m_world->inCollision(m_q); }
  double clearance() const { return m_world->clearance(m_q); }

  // Repeats the command for so long; every instant of what is sent is looked at.
  void hold(const JogCommand& command, double seconds) {
    for (const double end = m_now + seconds; m_now < end - 1e-9;) {
      ASSERT_TRUE(m_jogger->command(command, m_now).ok());
      tick();
    }
  }
  void rest(double seconds) {
    m_jogger->release();
    wait(seconds);
  }
  void wait(double seconds) {
    for (const double end = m_now + seconds; m_now < end - 1e-9;) tick();
  }
  void tick() {
    const Horizon horizon = m_jogger->tick(m_now, m_q);
    if (!horizon.points.empty()) {
      check(horizon);
      m_sent.points = horizon.points;
      m_start = m_now;
    }
    m_now += kTick_s;
    if (m_sent.empty()) return;
    const TrajectoryPoint here = m_sent.sample(m_now - m_start);
    m_speed = m_now - m_start < m_sent.duration() ? here.velocities.cwiseAbs().maxCoeff() : 0;
    setGroupPositions(*m_cell->model, m_cell->arm, here.positions, m_q);
  }
  double speed() const { return m_speed; }

 private:
  // Limits, continuity with what was in force, rest at the end, the start at now.
  void check(const Horizon& horizon) {
    const MotionLimits& limits = m_cell->arm_limits;
    Trajectory path;
    path.points = horizon.points;
    ASSERT_EQ(horizon.owner, "jog");
    ASSERT_LE(horizon.duration(), 0.45);
    ASSERT_LT(horizon.points.back().velocities.norm(), 1e-12);
    if (!m_sent.empty() && m_now < m_start + m_sent.duration()) {
      const TrajectoryPoint before = m_sent.sample(m_now - m_start);
      ASSERT_LT((before.positions - path.points[0].positions).cwiseAbs().maxCoeff(), 1e-9);
      ASSERT_LT((before.velocities - path.points[0].velocities).cwiseAbs().maxCoeff(), 1e-9);
    } else {
      ASSERT_LT((arm() - path.points[0].positions).cwiseAbs().maxCoeff(), 1e-12);
    }
    for (double t = 0; t <= path.duration(); t += 0.004) {
      const TrajectoryPoint p = path.sample(t);
      for (Eigen::Index j = 0; j < p.positions.size(); ++j) {
        ASSERT_LE(std::abs(p.velocities[j]), limits.max_velocity[j] * kSlack) << "joint " << j << " at " << t;
        ASSERT_LE(std::abs(p.accelerations[j]), limits.max_acceleration[j] * kSlack) << "joint " << j << " at " << t;
      }
    }
    for (Eigen::Index j = 0; j < arm().size(); ++j) {
      ASSERT_LE(path.points.back().positions[j], limits.upper[j] + 1e-9);
      ASSERT_GE(path.points.back().positions[j], limits.lower[j] - 1e-9);
    }
  }

  std::shared_ptr<const Workcell> m_cell;
  std::unique_ptr<Jogger> m_jogger;
  std::unique_ptr<CollisionWorld> m_world;
  VectorXd m_q;
  Trajectory m_sent;
  double m_start = 0, m_now = 100, m_speed = 0;
};

JogCommand along(JogFrame frame, const Vector3d& linear, double speed = 0.5) {
  JogCommand command;
  command.frame = frame;
  command.linear = linear;
  command.speed = speed;
  return command;
}

// The way of the tip, and how far it leaves the line and the orientation.
void expectStraight(Bench& bench, const JogCommand& command, const Vector3d& direction_R) {
  const Pose from = bench.tip();
  bench.hold(command, 0.8);
  bench.rest(0.5);
  const Vector3d way = bench.tip().translation() - from.translation();
  const double on = way.dot(direction_R);
  EXPECT_GT(on, 0.03);
  EXPECT_LT((way - on * direction_R).norm(), 0.002) << way.transpose();
  EXPECT_LT(Eigen::AngleAxisd(from.linear().transpose() * bench.tip().linear()).angle(), 0.005);
}

TEST(Jog, GoesStraightAlongTheAxesOfEveryFrame) {
  {
    Bench bench;
    expectStraight(bench, along(JogFrame::kBase, Vector3d::UnitZ()), Vector3d::UnitZ());
  }
  {
    Bench bench;
    expectStraight(bench, along(JogFrame::kTool, -Vector3d::UnitZ()), -bench.tip().linear().col(2));
  }
  Bench bench;
  JogCommand command = along(JogFrame::kCamera, -Vector3d::UnitY());      // up in the picture
  command.camera = bench.cell().cameras.front().name;
  const int link = *bench.cell().model->linkIndex(bench.cell().cameras.front().link);
  expectStraight(bench, command, -bench.cell().model->forward(bench.q(), link).linear().col(1));
}

TEST(Jog, TurnsAboutTheToolsTip) {
  Bench bench;
  JogCommand command;
  command.frame = JogFrame::kTool;
  command.angular = Vector3d::UnitZ();
  const Pose from = bench.tip();
  bench.hold(command, 0.8);
  bench.rest(0.5);
  const Eigen::AngleAxisd turned(from.linear().transpose() * bench.tip().linear());
  EXPECT_GT(turned.angle(), 0.1);
  EXPECT_GT(turned.axis().z(), 0.999);
  EXPECT_LT((bench.tip().translation() - from.translation()).norm(), 0.002);
}

TEST(Jog, MovesOneJointUpToItsLimitAndSaysSo) {
  Bench bench;
  JogCommand command;
  command.frame = JogFrame::kJoint;
  command.joint = static_cast<int>(bench.cell().arm.joints.size()) - 1;
  command.turn = 1;
  command.speed = 1;
  const VectorXd from = bench.arm();
  const double limit = bench.cell().arm_limits.upper[command.joint];
  for (int i = 0; i < 60 && bench.jogger().report().reason.empty(); ++i) bench.hold(command, 0.5);
  EXPECT_NE(bench.jogger().report().reason.find("is at its limit"), std::string::npos) << bench.jogger().report().reason;
  bench.hold(command, 1);
  EXPECT_LE(bench.arm()[command.joint], limit + 1e-9);
  EXPECT_GT(bench.arm()[command.joint], limit - 0.01);
  VectorXd others = bench.arm() - from;
  others[command.joint] = 0;
  EXPECT_LT(others.norm(), 1e-9);
  command.turn = -1;
  bench.hold(command, 0.5);
  EXPECT_LT(bench.arm()[command.joint], limit - 0.02) << "the way back must be free";
}

TEST(Jog, ComesToRestWhenLetGoOfOrNotRepeated) {
  Bench bench;
  bench.hold(along(JogFrame::kBase, Vector3d::UnitZ(), 1), 0.6);
  ASSERT_GT(bench.speed(), 0.02);
  bench.rest(0.4);
  EXPECT_EQ(bench.speed(), 0);
  EXPECT_FALSE(bench.jogger().active(bench.now()));
  bench.hold(along(JogFrame::kBase, -Vector3d::UnitZ(), 1), 0.6);
  ASSERT_GT(bench.speed(), 0.02);
  bench.wait(0.62);                    // nobody lets go, but nobody repeats either
  EXPECT_EQ(bench.speed(), 0);
  EXPECT_FALSE(bench.jogger().active(bench.now()));
}

WorldObject slab(double top) {
  WorldObject out;
  out.name = "slab";
  out.shape = Box{{3, 3, 0.1}};
  out.X_WO.translation() = Vector3d(1.8, 0, top - 0.05);
  return out;
}

TEST(Jog, SlowsDownAndStopsBeforeAnObstacleAndLeavesItAgain) {
  Bench probe;
  Bench bench("ready", {slab(probe.tip().translation().z() - 0.25)});
  ASSERT_FALSE(bench.touches());
  const JogCommand down = along(JogFrame::kBase, -Vector3d::UnitZ(), 1);
  double near_speed = 0;
  for (int i = 0; i < 400; ++i) {
    bench.hold(down, kTick_s);
    ASSERT_FALSE(bench.touches()) << "clearance " << bench.clearance();
    if (bench.clearance() < 0.015) near_speed = std::max(near_speed, bench.jogger().report().factor);
  }
  EXPECT_LT(bench.clearance(), 0.015);
  EXPECT_LT(near_speed, 0.4);
  EXPECT_NE(bench.jogger().report().reason.find("slab"), std::string::npos) << bench.jogger().report().reason;
  bench.hold(along(JogFrame::kBase, Vector3d::UnitZ(), 1), 1.5);
  EXPECT_GT(bench.clearance(), 0.024) << "what remains is between two links";
}

TEST(Jog, LeadsOnlyAwayFromWhatItIsTooCloseTo) {
  Bench probe;
  const double top = probe.tip().translation().z() - 0.25;
  Bench bench("ready", {slab(top)});
  bench.hold(along(JogFrame::kBase, -Vector3d::UnitZ(), 1), 8);
  bench.rest(0.5);
  // The slab turns out to be a little higher than it was thought to be: now it is closer than the padding.
  const double rise = bench.clearance() - 0.003;
  ASSERT_GT(rise, 0);
  bench.jogger().setObjects({slab(top + rise)});
  const double z = bench.tip().translation().z();
  bench.hold(along(JogFrame::kBase, -Vector3d::UnitZ(), 1), 1);
  EXPECT_NEAR(bench.tip().translation().z(), z, 1e-6);
  EXPECT_NE(bench.jogger().report().reason.find("away"), std::string::npos) << bench.jogger().report().reason;
  JogCommand creep = along(JogFrame::kBase, -Vector3d::UnitZ(), 1);
  creep.through_contact = true;
  bench.hold(creep, 0.2);
  bench.rest(0.4);
  EXPECT_LT(bench.tip().translation().z(), z - 1e-5);
  EXPECT_GT(bench.tip().translation().z(), z - 0.01);
  bench.hold(along(JogFrame::kBase, Vector3d::UnitZ(), 1), 2);
  EXPECT_GT(bench.tip().translation().z(), z + 0.01);
}

TEST(Jog, NeverEntersAZoneNorLeavesTheWorkspaceThroughContactEither) {
  Bench probe;
  WorldObject zone = slab(probe.tip().translation().z() - 0.25);
  zone.role = BodyRole::kKeepOut;
  Bench bench("ready", {zone});
  JogCommand creep = along(JogFrame::kBase, -Vector3d::UnitZ(), 1);
  bench.hold(creep, 6);
  creep.through_contact = true;
  bench.hold(creep, 6);
  EXPECT_FALSE(bench.touches());
  EXPECT_NE(bench.jogger().report().reason.find("slab"), std::string::npos) << bench.jogger().report().reason;
  WorldObject room;
  room.name = "cell";
  room.role = BodyRole::kKeepIn;
  room.shape = Box{{6, 0.8, 6}};
  Bench inside("ready", {room});
  ASSERT_FALSE(inside.touches());
  for (const bool through : {false, true}) {
    JogCommand aside = along(JogFrame::kBase, Vector3d::UnitY(), 1);
    aside.through_contact = through;
    inside.hold(aside, 6);
    EXPECT_FALSE(inside.touches());
    EXPECT_GT(inside.tip().translation().y(), 0.1);
    EXPECT_LT(inside.tip().translation().y(), 0.4);
  }
  EXPECT_NE(inside.jogger().report().reason.find("workspace"), std::string::npos) << inside.jogger().report().reason;
}

TEST(Jog, SlowsDownWhereTheArmIsStretchedAndComesBack) {
  Bench bench;
  const JogCommand out = along(JogFrame::kBase, Vector3d::UnitX(), 1);
  for (int i = 0; i < 40 && bench.jogger().report().reason.empty(); ++i) bench.hold(out, 0.5);
  bench.hold(out, 2);
  EXPECT_FALSE(bench.jogger().report().reason.empty());
  EXPECT_LT(bench.jogger().report().factor, 0.5);
  const double x = bench.tip().translation().x();
  bench.rest(0.4);
  bench.hold(along(JogFrame::kBase, -Vector3d::UnitX(), 1), 2);
  EXPECT_LT(bench.tip().translation().x(), x - 0.02);
}

TEST(Jog, RefusesWhatMakesNoSense) {
  Bench bench;
  JogCommand command = along(JogFrame::kCamera, Vector3d::UnitX());
  command.camera = "nowhere";
  EXPECT_EQ(bench.jogger().command(command, bench.now()).error().code, ErrorCode::kInvalidInput);
  EXPECT_FALSE(bench.jogger().command(along(JogFrame::kBase, {NAN, 0, 0}), bench.now()).ok());
  EXPECT_FALSE(bench.jogger().command(along(JogFrame::kBase, {2, 0, 0}), bench.now()).ok());
  command = {};
  command.frame = JogFrame::kJoint;
  command.joint = 99;
  command.turn = 1;
  EXPECT_FALSE(bench.jogger().command(command, bench.now()).ok());
  EXPECT_FALSE(bench.jogger().active(bench.now()));
}

// Whatever is held, for however long: bench.hold() checks every horizon.
void jogAtRandom(unsigned seed, int steps) {
  Bench probe;
  Bench bench("ready", {slab(probe.tip().translation().z() - 0.2)});
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::uniform_int_distribution<int> ticks(1, 40), frame(0, 3), joint(0, static_cast<int>(bench.arm().size()) - 1);
  for (int step = 0; step < steps; ++step) {
    JogCommand command;
    command.frame = static_cast<JogFrame>(frame(rng));
    command.joint = joint(rng);
    command.turn = unit(rng);
    command.linear = Vector3d(unit(rng), unit(rng), unit(rng));
    command.angular = Vector3d(unit(rng), unit(rng), unit(rng));
    command.camera = bench.cell().cameras.front().name;
    command.speed = std::abs(unit(rng));
    bench.hold(command, kTick_s * ticks(rng));
    if (step % 5 == 4) bench.rest(kTick_s * ticks(rng));
    ASSERT_FALSE(bench.touches()) << "seed " << seed << ", step " << step;
    if (::testing::Test::HasFatalFailure()) return;
  }
}

TEST(Jog, KeepsLimitsAndDistanceWhateverIsHeld) { jogAtRandom(7, 150); }

TEST(JogCampaign, KeepsLimitsAndDistanceForManyOperators) {
  for (unsigned seed = 1; seed <= 50; ++seed) jogAtRandom(seed, 400);
}

}  // namespace
}  // namespace longarm::planning
