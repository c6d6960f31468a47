// Paths after timing, against closed forms: the arc of a door, the passes of a scan (T8.2 and T8.3 of the algorithms' list).
#include <algorithm>
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "planning/macros/reach_advice.h"
#include "planning/robot/ik.h"
#include "tests/planning/macro_scene.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;
using tests::featureOf;
using vision::FeatureKind;

constexpr double kMostOff = 1e-3;        // [m], the tolerance that paths are held to
constexpr double kMostTurned = 0.01;     // [rad]

// A door of 0.8 m: where its handle is, the way the grip points, on which side it hangs.
struct Door {
  Vector3d handle;
  double yaw, side, angle;
  Vector3d hinge() const { return handle + 0.8 * side * Vector3d(-std::sin(yaw), std::cos(yaw), 0); }
};

std::vector<Door> doors() {
  // By a right angle from one place: the robot has driven up beside the hinge, which stands near the arm's first axis.
  std::vector<Door> out;
  const Eigen::VectorXd q = tests::configuration(tests::builtIn(), "ready");
  const Vector3d shoulder = reachOf(tests::builtIn(), q).shoulder;
  for (const double ahead : {0.0, 0.1, 0.2}) {
    for (const double aside : {0.0, 0.1, -0.1, 0.2, -0.2}) {
      for (const double bearing : {-M_PI / 4, M_PI / 4, -M_PI / 3, M_PI / 3}) {
        for (const double side : {1.0, -1.0}) {
          const Vector3d hinge(shoulder.x() + ahead, shoulder.y() + aside, 0.55);
          const Vector3d handle = hinge + 0.8 * Vector3d(std::cos(bearing), std::sin(bearing), 0);
          out.push_back({handle, bearing + side * M_PI / 2, side, bearing < 0 ? M_PI / 2 : -M_PI / 2});
        }
      }
    }
  }
  return out;
}

// The arm holding the handle; nothing when it cannot.
std::optional<Eigen::VectorXd> holding(const Workcell& cell, const Door& door) {
  Eigen::VectorXd q = tests::configuration(cell, "ready");
  IkSolver solver(cell.model, cell.arm, q);
  solver.setLimits(cell.arm_limits.lower, cell.arm_limits.upper);
  const Eigen::Matrix3d R = toolRotation({std::cos(door.yaw), std::sin(door.yaw), 0}, Vector3d::UnitZ());
  const auto found = solver.solve(poseAt(door.handle, R), groupPositions(*cell.model, cell.arm, q));
  if (!found) return {};
  setGroupPositions(*cell.model, cell.arm, found->joints, q);
  return q;
}

// Deviation from the door's circle and from its turn, at 1000 instants.
void expectOnTheArc(const Workcell& cell, const Plan& plan, const Door& door) {
  const Pose X_start = tests::toolAt(cell, plan, 0);
  double off = 0, turned = 0, last = 0;
  for (int i = 0; i <= 1000; ++i) {
    const Pose X = tests::toolAt(cell, plan, plan.trajectory.duration() * i / 1000);
    const Vector3d r = X.translation() - door.hinge(), r0 = X_start.translation() - door.hinge();
    off = std::max({off, std::abs(r.head<2>().norm() - 0.8), std::abs(r.z() - r0.z())});
    const double angle = std::atan2(r0.x() * r.y() - r0.y() * r.x(), r0.head<2>().dot(r.head<2>()));
    turned = std::max(turned, angleBetween(X.linear(), expSO3(Vector3d(0, 0, angle)) * X_start.linear()));
    EXPECT_GE((angle - last) * door.angle, -1e-9) << "it must not go back";
    last = angle;
  }
  EXPECT_LT(off, kMostOff);
  EXPECT_LT(turned, kMostTurned);
  EXPECT_NEAR(last, door.angle, 1e-4);
  EXPECT_NEAR(plan.figures.at("radius"), 0.8, 1e-5);
}

TEST(MoveAroundAxis, KeepsADoorsArcOfNinetyDegreesWithinAMillimetre) {
  const Workcell& cell = tests::builtIn();
  int planned = 0;
  for (const Door& door : doors()) {
    const auto start = holding(cell, door);
    if (!start || planned == 3) continue;
    PlanContext context = tests::contextOf(cell);
    context.start = *start;
    context.arguments = {{"angle", door.angle}};
    context.budget_s = 60;
    const vision::Feature axis = featureOf(FeatureKind::kLine, {door.hinge() - Vector3d(0, 0, 0.4), door.hinge() + Vector3d(0, 0, 0.4)});
    const Plan plan = tests::macroOf("move_around_axis").plan(context, &axis);
    if (!plan.ok()) continue;            // not from every place
    ++planned;
    expectOnTheArc(cell, plan, door);
    const CheckReport report = tests::sweepOf(cell, plan, {});
    EXPECT_TRUE(report.ok) << (report.violations.empty() ? "" : report.violations[0].sentence);
  }
  EXPECT_GE(planned, 1) << "none of " << doors().size() << " doors could be opened";
}

TEST(MoveAroundAxis, TurnsAValveOnTheSpotAndKeepsTheToolsDirectionWhenAsked) {
  const Workcell& cell = tests::builtIn();
  PlanContext context = tests::contextOf(cell, "ready");
  const Pose X = cell.model->forward(context.start, *cell.model->linkIndex("tool_tip"));
  const vision::Feature spindle = featureOf(FeatureKind::kLine, {X.translation(), X * Vector3d(0, 0, 0.1)});
  context.arguments = {{"angle", -0.7}};
  const Plan turn = tests::macroOf("move_around_axis").plan(context, &spindle);
  ASSERT_TRUE(turn.ok()) << turn.reason;
  const Pose end = tests::toolAt(cell, turn, turn.trajectory.duration());
  EXPECT_LT((end.translation() - X.translation()).norm(), 1e-4);
  EXPECT_LT(angleBetween(end.linear(), expSO3(-0.7 * X.linear().col(2)) * X.linear()), 1e-4);
  const vision::Feature crank = featureOf(FeatureKind::kLine, {X * Vector3d(0, 0.1, 0), X * Vector3d(0, 0.1, 0.1)});
  context.arguments = {{"angle", 0.7}, {"turn_tool", 0}};
  const Plan slip = tests::macroOf("move_around_axis").plan(context, &crank);
  ASSERT_TRUE(slip.ok()) << slip.reason;
  for (double t = 0; t <= slip.trajectory.duration(); t += 0.02) {
    const Pose now = tests::toolAt(cell, slip, t);
    EXPECT_LT(angleBetween(now.linear(), X.linear()), kMostTurned);
    EXPECT_NEAR((X.inverse() * now.translation() - Vector3d(0, 0.1, 0)).head<2>().norm(), 0.1, kMostOff);
  }
}

TEST(MoveAroundAxis, SaysHowFarItCanTurn) {
  const Workcell& cell = tests::builtIn();
  PlanContext context = tests::contextOf(cell, "ready");
  context.arguments = {{"angle", 3.1}};
  const vision::Feature axis = featureOf(FeatureKind::kLine, {{0.7, 0.8, 0}, {0.7, 0.8, 1}});
  const Plan plan = tests::macroOf("move_around_axis").plan(context, &axis);
  ASSERT_FALSE(plan.ok());
  EXPECT_NE(plan.reason.find("% of its way"), std::string::npos) << plan.reason;
}

struct ScanCase {
  const char* name;
  std::vector<Vector3d> corners;
  std::map<std::string, double> arguments;
};

class ScanPath : public testing::TestWithParam<ScanCase> {};

// Coverage and speed by code of its own: foot points of the tool's axis in the plane, a grid of cells.
TEST_P(ScanPath, CoversTheSurfaceAtAnEvenSpeedWithinAMillimetre) {
  const Workcell& cell = tests::builtIn();
  PlanContext context = tests::contextOf(cell);
  context.arguments = GetParam().arguments;
  context.budget_s = 60;
  const vision::Feature feature = featureOf(FeatureKind::kPlane, GetParam().corners);
  const Plan plan = tests::macroOf("surface_scan").plan(context, &feature);
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const auto argument = [&](const std::string& name, double otherwise) {
    const auto it = GetParam().arguments.find(name);
    return it == GetParam().arguments.end() ? otherwise : it->second;
  };
  const Vector3d o = GetParam().corners[1], e1 = GetParam().corners[0] - o, e2 = GetParam().corners[2] - o, n = e1.cross(e2).normalized();
  const double speed = argument("speed", 0.05), stand_off = argument("stand_off", 0.1), half = 0.5 * argument("swath", 0.08);
  const bool second = argument("direction", 0) == 1;
  const Vector3d travel = (second ? e2 : e1).normalized(), step = (second ? e1 : e2).normalized();
  const double length = (second ? e2 : e1).norm(), width = (second ? e1 : e2).norm();
  const PlanStage& scan = plan.stages.back();
  constexpr int kCells = 100;
  std::vector<char> covered(kCells * kCells, 0);
  double off = 0, slowest = 1, fastest = 0;
  Vector3d before = tests::toolAt(cell, plan, scan.start_s).translation();
  constexpr double kStep = 0.005;
  for (double t = scan.start_s + kStep; t <= scan.end_s; t += kStep) {
    const Pose X = tests::toolAt(cell, plan, t);
    const Vector3d p = X.translation(), z = X.linear().col(2);
    const double depth = n.dot(o - p) / n.dot(z);
    off = std::max(off, std::abs(depth - stand_off));
    const Vector3d foot = p + depth * z - o;
    const double along = foot.dot(travel), across = foot.dot(step), v = (p - before).norm() / kStep;
    before = p;
    if (along < 0 || along > length) continue;
    slowest = std::min(slowest, v);
    fastest = std::max(fastest, v);
    const int a = std::min(kCells - 1, static_cast<int>(along / length * kCells));
    for (int c = 0; c < kCells; ++c) {
      if (std::abs((c + 0.5) / kCells * width - across) <= half) covered[static_cast<std::size_t>(a * kCells + c)] = 1;
    }
  }
  const double share = static_cast<double>(std::count(covered.begin(), covered.end(), 1)) / (kCells * kCells);
  EXPECT_LT(off, kMostOff);
  EXPECT_GE(share, 0.99);
  EXPECT_GE(plan.figures.at("coverage"), 0.99);
  EXPECT_NEAR(plan.figures.at("coverage"), share, 0.02);
  EXPECT_GE(slowest, 0.98 * speed) << "of " << speed;
  EXPECT_LE(fastest, 1.02 * speed);
  const CheckReport report = tests::sweepOf(cell, plan, {});
  EXPECT_TRUE(report.ok) << (report.violations.empty() ? "" : report.violations[0].sentence);
}

INSTANTIATE_TEST_SUITE_P(
    Surfaces, ScanPath,
    testing::Values(ScanCase{"wall", {{0.85, -0.15, 0.40}, {0.85, 0.15, 0.40}, {0.85, 0.15, 0.65}}, {}},
                    ScanCase{"table_from_above", {{0.6, -0.15, 0.30}, {0.6, 0.15, 0.30}, {0.85, 0.15, 0.30}}, {{"swath", 0.06}, {"overlap", 0.3}}},
                    ScanCase{"table_tilted_tool", {{0.6, -0.15, 0.30}, {0.6, 0.15, 0.30}, {0.85, 0.15, 0.30}}, {{"direction", 1}, {"roll_free", 0}, {"tilt", 0.2}}},
                    ScanCase{"leaning", {{0.80, -0.12, 0.40}, {0.80, 0.12, 0.40}, {0.83, 0.12, 0.60}}, {{"stand_off", 0.15}}}),
    [](const auto& scan) { return std::string(scan.param.name); });

TEST(SurfaceScan, ResumesFromAPass) {
  const Workcell& cell = tests::builtIn();
  PlanContext context = tests::contextOf(cell);
  context.budget_s = 60;
  const vision::Feature feature = featureOf(FeatureKind::kPlane, {{0.85, -0.15, 0.40}, {0.85, 0.15, 0.40}, {0.85, 0.15, 0.65}});
  const Plan whole = tests::macroOf("surface_scan").plan(context, &feature);
  context.arguments = {{"first_pass", 2}};
  const Plan rest = tests::macroOf("surface_scan").plan(context, &feature);
  ASSERT_TRUE(whole.ok() && rest.ok()) << rest.reason;
  EXPECT_EQ(rest.figures.at("passes"), whole.figures.at("passes"));
  EXPECT_NEAR(rest.figures.at("coverage"), 1 - (2 * whole.figures.at("spacing")) / 0.25, 0.02) << "two passes are left out";
  context.arguments = {{"first_pass", 9}};
  const Plan none = tests::macroOf("surface_scan").plan(context, &feature);
  EXPECT_EQ(none.status, PlanStatus::kLimits);
  EXPECT_NE(none.reason.find("9"), std::string::npos) << none.reason;
}

}  // namespace
}  // namespace longarm::planning
