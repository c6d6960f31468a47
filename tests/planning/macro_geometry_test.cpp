// What macros are made of: parameters, features in the root frame, tool paths, rasters, the ladder.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "planning/macros/accuracy.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/macro_arguments.h"
#include "planning/macros/pipe_grasp.h"
#include "planning/macros/raster.h"
#include "planning/macros/tool_directions.h"
#include "planning/motion/ladder.h"
#include "planning/motion/tool_path.h"
#include "tests/planning/macro_scene.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;
using vision::FeatureKind;

RootedFeature points(const std::vector<Vector3d>& p) {
  return {"mark", p, std::vector<Eigen::Matrix3d>(p.size(), Eigen::Matrix3d::Zero())};
}

TEST(MacroArguments, TakeDefaultsAndRefuseWhatIsNotThere) {
  const MacroInfo info{"m", "M", "", {}, {{"depth", "m", 0.1, 0, 0.5, ""}, {"laps", "choice", 1, 1, 5, ""}}};
  const auto defaults = MacroArguments::from(info, {});
  ASSERT_TRUE(defaults.ok());
  EXPECT_EQ((*defaults)["depth"], 0.1);
  EXPECT_EQ(defaults->choice("laps"), 1);
  EXPECT_EQ((*MacroArguments::from(info, {{"depth", 0.5}}))["depth"], 0.5) << "both ends of the range are in it";
  const auto unknown = MacroArguments::from(info, {{"speed", 1}});
  ASSERT_FALSE(unknown.ok());
  EXPECT_NE(unknown.error().message.find("depth, laps"), std::string::npos) << unknown.error().message;
  const auto outside = MacroArguments::from(info, {{"depth", 0.6}});
  ASSERT_FALSE(outside.ok());
  EXPECT_EQ(outside.error().code, ErrorCode::kOutOfLimits);
  EXPECT_NE(outside.error().message.find("0.6"), std::string::npos) << outside.error().message;
  EXPECT_FALSE(MacroArguments::from(info, {{"laps", 1.5}}).ok());
  EXPECT_FALSE(MacroArguments::from(info, {{"depth", std::nan("")}}).ok());
}

TEST(MacroList, HasEveryMacroOfTheContractWithSoundParameters) {
  const auto macros = makeMacros(tests::builtIn());
  std::set<std::string> names;
  for (const auto& macro : macros) {
    const MacroInfo info = macro->info();
    EXPECT_TRUE(names.insert(info.name).second) << info.name << " is there twice";
    EXPECT_FALSE(info.description.empty()) << info.name;
    EXPECT_EQ(info.takes.has_value(), info.accuracy_need > 0) << info.name << " must state the accuracy it needs";
    for (const auto& p : info.parameters) {
      EXPECT_GE(p.value, p.lower) << info.name << " " << p.name;
      EXPECT_LE(p.value, p.upper) << info.name << " " << p.name;
      EXPECT_FALSE(p.unit.empty() || p.description.empty()) << info.name << " " << p.name;
    }
  }
  for (const char* name : {"home", "stow", "ready", "look_at", "touch", "grab_pipe", "move_around_axis", "approach_from_side", "move_parallel",
                           "aim_along_axis", "place_disruptor", "surface_scan", "follow_perimeter", "press", "wipe", "push_face",
                           "scan_faces", "look_around", "move_to"}) {
    EXPECT_TRUE(names.count(name)) << name;
  }
}

TEST(FeatureGeometry, PlaneIsARectangleWhoseNormalLooksAtTheEye) {
  const auto patch = planePatchFrom(points({{1.3, 0, 1}, {1, 0, 1}, {1.1, 0.2, 1}}), {1, 0, 3});
  ASSERT_TRUE(patch.ok());
  EXPECT_LT((patch->normal - Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_NEAR(patch->width, 0.3, 1e-12);
  EXPECT_NEAR(patch->height, 0.2, 1e-12) << "the second edge is made square to the first";
  EXPECT_NEAR(patch->u.dot(patch->v), 0, 1e-12);
  EXPECT_LT((planePatchFrom(points({{1.3, 0, 1}, {1, 0, 1}, {1.1, 0.2, 1}}), {1, 0, -3})->normal + Vector3d::UnitZ()).norm(), 1e-12);
  const auto narrow = planePatchFrom(points({{1.3, 0, 1}, {1, 0, 1}, {1.3, 0.01, 1}}), {1, 0, 3});
  ASSERT_FALSE(narrow.ok());
  EXPECT_NE(narrow.error().message.find("deg apart"), std::string::npos) << narrow.error().message;
}

TEST(FeatureGeometry, BoxIsTheSameWhetherItsEdgesWerePickedLeftOrRightHanded) {
  Random random(5);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Matrix3d R = expSO3(3 * tests::randomDirection(random) * random.unit());
    const Vector3d o = tests::randomPlace(random), size(random.uniform(0.05, 0.3), random.uniform(0.05, 0.3), random.uniform(0.05, 0.3));
    const auto edge = [&](int k) { return Vector3d(o + size[k] * R.col(k)); };
    const auto right = boxPatchFrom(points({o, edge(0), edge(1), edge(2)})), left = boxPatchFrom(points({o, edge(1), edge(0), edge(2)}));
    ASSERT_TRUE(right.ok() && left.ok());
    EXPECT_LT((right->X_RO.linear() - R).norm(), 1e-9);
    EXPECT_LT((right->size - size).norm(), 1e-9);
    EXPECT_NEAR(left->X_RO.linear().determinant(), 1, 1e-9) << "never a reflection";
    EXPECT_LT((left->X_RO.translation() - right->X_RO.translation()).norm(), 1e-9);
    EXPECT_NEAR(left->size.prod(), size.prod(), 1e-9);
  }
  EXPECT_FALSE(boxPatchFrom(points({{0, 0, 0}, {1, 0, 0}, {1, 0.1, 0}, {0, 0, 1}})).ok()) << "far from square";
}

TEST(FeatureGeometry, BoxOfSkewedEdgesIsTheNearestRightAngledOne) {
  const double a = 0.04;                 // edges 4 degrees off, evenly: the frame must lie between them
  const auto box = boxPatchFrom(points({{0, 0, 0}, {std::cos(a), std::sin(a), 0}, {std::sin(a), std::cos(a), 0}, {0, 0, 1}}));
  ASSERT_TRUE(box.ok());
  EXPECT_LT((box->X_RO.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_NEAR(box->size[0], std::cos(a), 1e-12);
}

TEST(FeatureGeometry, MovesVerticesAndCovariancesIntoTheRootFrame) {
  const Workcell& cell = tests::builtIn();
  const Eigen::VectorXd q = tests::configuration(cell, "ready");
  vision::Feature feature = tests::featureOf(FeatureKind::kPoint, {{0.1, 0.2, 0.3}});
  feature.parent = "wrist_optical";
  feature.vertices[0].covariance = Eigen::Vector3d(1e-6, 4e-6, 9e-6).asDiagonal();
  const auto out = rooted(feature, FeatureKind::kPoint, *cell.model, q);
  ASSERT_TRUE(out.ok());
  const Pose X = cell.model->forward(q, *cell.model->linkIndex("wrist_optical"));
  EXPECT_LT((out->points[0] - X * Vector3d(0.1, 0.2, 0.3)).norm(), 1e-12);
  EXPECT_NEAR(out->uncertainty(), 1.96 * 0.003, 1e-9) << "the largest half-axis, whatever the frame";
  feature.parent = "nowhere";
  EXPECT_NE(rooted(feature, FeatureKind::kPoint, *cell.model, q).error().message.find("nowhere"), std::string::npos);
  EXPECT_FALSE(rooted(feature, FeatureKind::kLine, *cell.model, q).ok());
}

TEST(Accuracy, GoesAsksAndRefusesByTheNeed) {
  EXPECT_EQ(judgeAccuracy(0.004, 0.005).go, "go");
  EXPECT_TRUE(judgeAccuracy(0.004, 0.005).note.empty());
  const AccuracyVerdict ask = judgeAccuracy(0.006, 0.005);
  EXPECT_EQ(ask.go, "ask");
  EXPECT_NE(ask.note.find("6.0 mm"), std::string::npos) << ask.note;
  EXPECT_EQ(judgeAccuracy(0.016, 0.005).go, "no_go");
}

TEST(ToolPath, RunsAlongLinesAndArcsByTheWay) {
  ToolPath path(Pose(Eigen::Translation3d(1, 0, 0)));
  path.lineTo(Vector3d(1, 0, 0.5)).arc({0, 0, 0.5}, Vector3d::UnitZ(), M_PI / 2, true);
  EXPECT_NEAR(path.length(), 0.5 + M_PI / 2, 1e-12);
  EXPECT_LT((path.at(0.25).translation() - Vector3d(1, 0, 0.25)).norm(), 1e-12);
  const Pose middle = path.at(0.5 + M_PI / 4);
  EXPECT_LT((middle.translation() - Vector3d(std::sqrt(0.5), std::sqrt(0.5), 0.5)).norm(), 1e-12);
  EXPECT_LT(angleBetween(middle.linear(), expSO3(Vector3d(0, 0, M_PI / 4))), 1e-9) << "the tool turns rigidly with the arc";
  EXPECT_LT((path.end().translation() - Vector3d(0, 1, 0.5)).norm(), 1e-12) << "right-handed";
  EXPECT_LT((path.at(99).translation() - path.end().translation()).norm(), 1e-12);
}

TEST(ToolPath, CountsTurnsOnTheSpotAsWay) {
  ToolPath path;
  path.arc(Vector3d::Zero(), Vector3d::UnitX(), 1.0, true);
  EXPECT_NEAR(path.length(), 0.1, 1e-12);
  EXPECT_NEAR(angleBetween(path.at(0.05).linear(), Eigen::Matrix3d::Identity()), 0.5, 1e-9);
  EXPECT_TRUE(ToolPath().lineTo(Vector3d::Zero()).empty()) << "a step of nothing is left out";
}

TEST(ToolPath, StationsHoldEveryEndOfAPiece) {
  ToolPath path;
  path.lineTo(Vector3d(0.033, 0, 0)).lineTo(Vector3d(0.033, 0.01, 0)).arc({0.033, 0.02, 0}, Vector3d::UnitZ(), 1.0, false);
  const auto stations = path.stations(0.02, 0.1);
  EXPECT_EQ(stations.front(), 0);
  EXPECT_NEAR(stations.back(), path.length(), 1e-12);
  for (const double end : {0.033, 0.043}) {
    EXPECT_TRUE(std::any_of(stations.begin(), stations.end(), [&](double s) { return std::abs(s - end) < 1e-12; })) << end;
  }
  for (std::size_t i = 1; i < stations.size(); ++i) {
    EXPECT_GT(stations[i], stations[i - 1]);
    EXPECT_LE(stations[i] - stations[i - 1], 0.02 + 1e-12);
  }
}

TEST(Raster, CoversThePatchWithPassesThatOverlapEnough) {
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    PlanePatch patch;
    patch.width = random.uniform(0.05, 0.6);
    patch.height = random.uniform(0.05, 0.6);
    RasterSpec spec;
    spec.swath = random.uniform(0.02, 0.2);
    spec.overlap = random.uniform(0, 0.6);
    spec.along_v = random.unit() < 0.5;
    spec.mirror_travel = random.unit() < 0.5;
    spec.mirror_step = random.unit() < 0.5;
    const auto raster = rasterOf(patch, spec);
    ASSERT_TRUE(raster.ok());
    const double across = spec.along_v ? patch.width : patch.height, along = spec.along_v ? patch.height : patch.width;
    if (raster->passes > 1) {
      EXPECT_LE(raster->spacing, spec.swath * (1 - spec.overlap) + 1e-9);
    }
    EXPECT_GE((raster->passes - 1) * raster->spacing + spec.swath, std::min(across, spec.swath) - 1e-9);
    // Every point of the patch within half a swath of the path, seen from above.
    for (int k = 0; k < 20; ++k) {
      const double u = random.unit() * patch.width, v = random.unit() * patch.height;
      double nearest = 1;
      for (double s = 0; s <= raster->path.length(); s += 0.002) nearest = std::min(nearest, (raster->path.at(s).translation().head<2>() - Eigen::Vector2d(u, v)).norm());
      EXPECT_LE(nearest, 0.5 * spec.swath + 2e-3);
    }
    EXPECT_NEAR(raster->path.start().translation().z(), spec.stand_off, 1e-12);
    EXPECT_GT(raster->path.length(), along);
  }
  RasterSpec far;
  far.first_pass = 50;
  PlanePatch unit;
  unit.width = unit.height = 0.2;
  EXPECT_FALSE(rasterOf(unit, far).ok());
}

TEST(Directions, StartWithTheWantedOneAndTiltByRings) {
  const auto directions = directionsAround(Vector3d(1, 2, -3), 0.8, 0.2618);
  ASSERT_EQ(directions.size(), 1u + 3 * 8);
  for (const auto& d : directions) {
    EXPECT_NEAR(std::acos(std::clamp(d.z.dot(directions[0].z), -1.0, 1.0)), 0.2618 * d.ring, 1e-7);
    EXPECT_NEAR(d.z.norm(), 1, 1e-12);
  }
}

class LadderTest : public testing::Test {
 protected:
  LadderTest() : m_cell(tests::builtIn()), m_solver(m_cell.model, m_cell.arm, tests::configuration(m_cell, "ready")) {
    m_solver.setLimits(m_cell.arm_limits.lower, m_cell.arm_limits.upper);
    m_start = groupPositions(*m_cell.model, m_cell.arm, tests::configuration(m_cell, "ready"));
    m_ladder.valid = [](std::size_t, const Eigen::VectorXd&) { return true; };
    m_ladder.stop = [] { return false; };
  }
  // A line of `n` rungs from the start, and the start as the first node.
  LadderPath prepare(const Vector3d& way, int n) {
    const Pose X = m_solver.kinematics().forward(m_start.data());
    for (int i = 0; i <= n; ++i) m_ladder.X_RT.push_back(Eigen::Translation3d(way * i / n) * X);
    return {{m_start}, {0}, 0};
  }
  const Workcell& m_cell;
  IkSolver m_solver;
  Ladder m_ladder;
  Eigen::VectorXd m_start;
};

TEST_F(LadderTest, FollowsALineInOneBranch) {
  const LadderPath first = prepare({0, 0.15, 0}, 6);
  const auto answer = climb(m_solver, m_ladder, {first});
  ASSERT_FALSE(answer.paths.empty());
  const LadderPath& path = answer.paths[0];
  ASSERT_EQ(path.joints.size(), 7u);
  for (std::size_t i = 0; i < path.joints.size(); ++i) {
    const Pose X = m_solver.kinematics().forward(path.joints[i].data()), wanted = rolled(m_ladder.X_RT[i], path.rolls[i]);
    EXPECT_LT((X.translation() - wanted.translation()).norm(), 1e-5);
    EXPECT_LT(angleBetween(X.linear(), wanted.linear()), 1e-5);
    if (i > 0) {
      EXPECT_LT((path.joints[i] - path.joints[i - 1]).cwiseAbs().maxCoeff(), 0.6);
    }
  }
}

TEST_F(LadderTest, TurnsTheToolWhereItsFirstRollIsForbidden) {
  const LadderPath first = prepare({0, 0.15, 0}, 6);
  const Eigen::Matrix3d R0 = m_ladder.X_RT[0].linear();
  // Beyond the third rung only rolls of at least 30 degrees are allowed.
  m_ladder.valid = [&](std::size_t rung, const Eigen::VectorXd& arm) {
    return rung < 3 || angleBetween(R0, m_solver.kinematics().forward(arm.data()).linear()) > 0.5;
  };
  std::size_t reached = 0;
  EXPECT_TRUE(followRungs(m_solver, m_ladder, m_start, 0, {}, reached).joints.empty());
  EXPECT_EQ(reached, 2u);
  const auto answer = climb(m_solver, m_ladder, {first});
  ASSERT_FALSE(answer.paths.empty());
  EXPECT_GE(std::abs(answer.paths[0].rolls.back()), 0.5);
  LadderOptions fixed;
  fixed.roll_step = 0;
  const auto none = climb(m_solver, m_ladder, {first}, fixed);
  EXPECT_TRUE(none.paths.empty());
  EXPECT_EQ(none.furthest, 2u);
}

TEST(PipeGoals, AFreeRollReachesPipesThatAFixedOneDoesNot) {
  const Workcell& cell = tests::builtIn();
  const Eigen::VectorXd home = tests::configuration(cell, "home");
  IkSolver solver(cell.model, cell.arm, home);
  solver.setLimits(cell.arm_limits.lower, cell.arm_limits.upper);
  Random random(60);
  IkOptions options;
  options.restarts = 8;
  int fixed = 0, free = 0;
  for (int i = 0; i < 60; ++i) {
    const auto pipe = pipeFrom(tests::randomPipe(random), *cell.model, home);
    ASSERT_TRUE(pipe.ok());
    const Eigen::VectorXd seed = groupPositions(*cell.model, cell.arm, home);
    bool first = true, any = false;
    for (const PipeGrasp& grasp : graspsAt(*pipe, 0)) {
      const bool reached = solver.solve(grasp.X_RT, seed, options).ok();
      if (first) fixed += reached;
      first = false;
      any = any || reached;
      if (any) break;
    }
    free += any;
  }
  EXPECT_EQ(free, 60);
  EXPECT_LT(fixed, 60) << "some of these pipes must need the freedom, or the test shows nothing";
}

}  // namespace
}  // namespace longarm::planning
