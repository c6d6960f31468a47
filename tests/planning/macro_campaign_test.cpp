// Every macro on random queries of the range it should serve, in three cluttered scenes: a seeded sample in every run,
// the figures as a campaign.  LONGARM_CAMPAIGN_QUERIES changes the number of queries of the campaign (1000).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>

#include <gtest/gtest.h>

#include "core/text.h"
#include "planning/collision/collision_world.h"
#include "planning/macros/feature_geometry.h"
#include "planning/macros/reach_advice.h"
#include "planning/macros/tool_shape.h"
#include "planning/motion/ladder.h"
#include "planning/robot/ik.h"
#include "tests/planning/macro_scene.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;
using tests::featureOf;
using vision::FeatureKind;

struct Query {
  vision::Feature feature;
  std::map<std::string, double> arguments;
  Eigen::VectorXd start;
  std::vector<std::string> touched;
};

// What the feature itself puts into the scene for the independent sweep.
std::vector<WorldObject> bodyOf(const std::string& macro, const vision::Feature& feature) {
  if (feature.kind == FeatureKind::kTriad) {
    RootedFeature rooted{"mark", {}, {}};
    for (const auto& v : feature.vertices) rooted.points.push_back(v.xyz);
    return {boxPatchFrom(rooted)->object("mark")};
  }
  if (macro == "approach_from_side") {
    WorldObject pipe;
    pipe.name = "mark";
    const Vector3d a = feature.vertices[0].xyz, b = feature.vertices[1].xyz;
    pipe.shape = Cylinder{0.02, (b - a).norm()};
    pipe.X_WO = poseAt(0.5 * (a + b), rotationWithZ(b - a));
    return {pipe};
  }
  return {};
}

class Queries {
 public:
  Queries(std::string macro, unsigned seed) : m_macro(std::move(macro)), m_random(seed), m_cell(tests::builtIn()) {}

  // The next query that is feasible in this scene: for motions from here as a slow walk along the path finds it, for
  // those that need one hard posture as a long search for it does.
  Query next(const std::vector<WorldObject>& scene) {
    for (;; ++m_refused) {
      if (auto query = draw(scene)) return *std::move(query);
    }
  }
  // Drawn but not feasible.
  int refused() const { return m_refused; }

 private:
  std::optional<Query> draw(const std::vector<WorldObject>& scene) {
    Query query;
    query.start = tests::configuration(m_cell, m_random.unit() < 0.5 ? "home" : "ready");
    if (m_macro == "look_at" || m_macro == "touch" || m_macro == "move_above" || m_macro == "place_here") return aPoint(query);
    if (m_macro == "approach_from_side") return aPipe(query);
    if (m_macro == "aim_along_axis" || m_macro == "insert_along") return anAxis(query, scene);
    if (m_macro == "place_disruptor") return anEdge(query);
    if (m_macro == "surface_scan" || m_macro == "follow_perimeter" || m_macro == "press" || m_macro == "wipe") return aSurface(query);
    if (m_macro == "grasp_by_faces" || m_macro == "push_face" || m_macro == "scan_faces" || m_macro == "look_around") {
      return aBox(query, scene);
    }
    if (m_macro == "move_to") return aPose(query, scene);
    return fromHere(query, scene);
  }

  std::optional<Query> aPoint(Query query) {
    query.feature = featureOf(FeatureKind::kPoint, {tests::randomPlace(m_random)});
    if (m_macro == "look_at") query.arguments = {{"stand_off", m_random.uniform(0.2, 0.4)}};
    if (m_macro == "place_here") query.start = tests::configuration(m_cell, "ready");
    return query;
  }

  std::optional<Query> aPipe(Query query) {
    const Vector3d p = tests::randomPlace(m_random, 0.6, 0.85, 0.35, 0.7);
    const double heading = m_random.uniform(-M_PI, M_PI), half = m_random.uniform(0.1, 0.2);
    const Vector3d d(std::cos(heading), std::sin(heading), m_random.uniform(-0.15, 0.15));
    query.feature = featureOf(FeatureKind::kLine, {p - half * d.normalized(), p + half * d.normalized()});
    query.touched = {"mark"};
    return query;
  }

  // Lines that lead away from the arm, within 40 degrees.
  std::optional<Query> anAxis(Query query, const std::vector<WorldObject>& scene) {
    const Vector3d p = tests::randomPlace(m_random, 0.75, 0.95, 0.4, 0.7);
    const double yaw = std::atan2(p.y(), p.x()) + m_random.uniform(-0.5, 0.5), pitch = m_random.uniform(-0.5, 0.5);
    const Vector3d d(std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch));
    query.feature = featureOf(FeatureKind::kLine, {p, p + 0.15 * d});
    if (m_macro == "insert_along") query.arguments = {{"depth", m_random.uniform(0.02, 0.1)}};
    if (m_macro == "aim_along_axis" && !canHold(query, {{axisEntry(p, d)}, {axisEntry(p + 0.15 * d, -d)}}, scene)) return {};
    return query;
  }

  std::optional<Query> anEdge(Query query) {
    const Vector3d p = tests::randomPlace(m_random, 0.75, 0.95, 0.3, 0.55);
    const double across = std::atan2(p.y(), p.x()) + M_PI / 2 + m_random.uniform(-0.5, 0.5), half = m_random.uniform(0.08, 0.2);
    const Vector3d d(std::cos(across), std::sin(across), 0);
    query.feature = featureOf(FeatureKind::kLine, {p - half * d, p + half * d});
    return query;
  }

  // Rectangles that face the arm or lie flat, a little turned.
  std::optional<Query> aSurface(Query query) {
    const bool flat = m_random.unit() < 0.5;
    const Vector3d p = flat ? tests::randomPlace(m_random, 0.6, 0.75, 0.25, 0.45) : tests::randomPlace(m_random, 0.8, 0.92, 0.4, 0.6);
    const double yaw = std::atan2(p.y(), p.x()) + m_random.uniform(-0.4, 0.4), tilt = m_random.uniform(-0.3, 0.3);
    const Vector3d u(-std::sin(yaw), std::cos(yaw), 0), away(std::cos(yaw), std::sin(yaw), 0);
    const double lean = (flat ? 0 : M_PI / 2) + tilt;
    const Vector3d v = std::cos(lean) * away + std::sin(lean) * Vector3d::UnitZ();
    const double a = m_random.uniform(0.08, 0.15), b = m_random.uniform(0.06, 0.12);
    query.feature = featureOf(FeatureKind::kPlane, {p - a * u + b * v, p - a * u - b * v, p + a * u - b * v});
    if (m_macro == "press" || m_macro == "wipe") query.touched = {"mark"};
    return query;
  }

  std::optional<Query> aBox(Query query, const std::vector<WorldObject>& scene) {
    const Vector3d p = tests::randomPlace(m_random, 0.65, 0.8, 0.35, 0.55);
    const double yaw = std::atan2(p.y(), p.x()) + m_random.uniform(-0.7, 0.7);
    const Eigen::Matrix3d R = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
    const Vector3d half(m_random.uniform(0.03, 0.07), m_random.uniform(0.025, 0.04), m_random.uniform(0.04, 0.08));
    const Vector3d o = p - R * half;
    std::vector<Vector3d> points{o};
    for (int k = 0; k < 3; ++k) points.push_back(o + 2 * half[k] * R.col(k));
    query.feature = featureOf(FeatureKind::kTriad, points);
    if (m_macro != "scan_faces" && m_macro != "look_around") query.touched = {"mark"};
    if (m_macro == "push_face" && !canHold(query, pushes(query), scene)) return {};
    return query;
  }

  // Anywhere before the robot, the tool leaning up to 60 degrees from level or straight down, however it is rolled.
  std::optional<Query> aPose(Query query, const std::vector<WorldObject>& scene) {
    const Vector3d p = tests::randomPlace(m_random), down = -Vector3d::UnitZ(), away = Vector3d(p.x(), p.y(), 0).normalized();
    const Vector3d z = (m_random.unit() < 0.5 ? down : away) + std::tan(m_random.uniform(0, M_PI / 3)) * tests::randomDirection(m_random);
    const Pose pose = rolled(poseAt(p, rotationWithZ(z.normalized())), m_random.uniform(-M_PI, M_PI));
    const Eigen::Matrix3d R = pose.linear();
    query.arguments = {{"x", p.x()}, {"y", p.y()}, {"z", p.z()}, {"roll", std::atan2(R(2, 1), R(2, 2))},
                       {"pitch", std::asin(std::clamp(-R(2, 0), -1.0, 1.0))}, {"yaw", std::atan2(R(1, 0), R(0, 0))}};
    if (!canHold(query, pose, scene, false)) return {};
    return query;
  }

  // Where the tool stands before an end of a line that it looks along, 0.2 m away.
  static Pose axisEntry(const Vector3d& end, const Vector3d& along) { return poseAt(end - 0.2 * along, rotationWithZ(along)); }

  // Before, at and pushed into each face that looks at the arm.
  std::vector<std::vector<Pose>> pushes(const Query& query) const {
    RootedFeature rooted{"mark", {}, {}};
    for (const auto& v : query.feature.vertices) rooted.points.push_back(v.xyz);
    const BoxPatch box = *boxPatchFrom(rooted);
    const Vector3d shoulder = reachOf(m_cell, query.start).shoulder;
    const double overhang = toolOverhang(m_cell, query.start);
    std::vector<std::vector<Pose>> out;
    for (int face = 0; face < 6; ++face) {
      const Vector3d n = box.normal(face);
      if (n.dot((shoulder - box.X_RO.translation()).normalized()) <= 0.1) continue;
      out.emplace_back();
      for (const double out_m : {0.08, 0.0, -0.05}) out.back().push_back(poseAt(box.faceCenter(face) + (overhang + out_m) * n, rotationWithZ(-n)));
    }
    return out;
  }

  // Whether for all poses of one of the ways there is some posture clear of the scene that holds the tool there,
  // whatever its roll (or just so): looked for much longer than planning does.  Without them the query is not feasible.
  bool canHold(const Query& query, const std::vector<std::vector<Pose>>& ways, const std::vector<WorldObject>& scene) const {
    return std::any_of(ways.begin(), ways.end(), [&](const std::vector<Pose>& poses) {
      return std::all_of(poses.begin(), poses.end(), [&](const Pose& pose) { return canHold(query, pose, scene); });
    });
  }
  bool canHold(const Query& query, const Pose& pose, const std::vector<WorldObject>& scene, bool roll_free = true) const {
    CollisionOptions options;
    options.moving = movingIndices(*m_cell.model, m_cell.arm);
    static const AllowedPairs allowed = allowedPairs(m_cell.model);
    const CollisionWorld world(m_cell.model, scene, allowed, options);
    IkSolver solver(m_cell.model, m_cell.arm, query.start);
    solver.setLimits(m_cell.arm_limits.lower, m_cell.arm_limits.upper);
    IkOptions thorough;
    thorough.restarts = 400;
    thorough.free[2] = roll_free;
    const Eigen::VectorXd arm = groupPositions(*m_cell.model, m_cell.arm, query.start);
    const auto all = solver.solveAll(pose, arm, thorough);
    return all && std::any_of(all->begin(), all->end(), [&](const IkSolution& one) {
      Eigen::VectorXd q = query.start;
      setGroupPositions(*m_cell.model, m_cell.arm, one.joints, q);
      return !world.inCollision(q);
    });
  }

  // A random posture of the arm, and a line or arc that a walk in millimetres can follow clear of everything.
  std::optional<Query> fromHere(Query query, const std::vector<WorldObject>& scene) {
    const Eigen::Index n = m_cell.arm_limits.lower.size();
    Eigen::VectorXd arm(n);
    const Eigen::VectorXd ready = groupPositions(*m_cell.model, m_cell.arm, query.start);
    for (Eigen::Index j = 0; j < n; ++j) {
      arm[j] = std::clamp(ready[j] + m_random.uniform(-0.6, 0.6), m_cell.arm_limits.lower[j] + 0.05, m_cell.arm_limits.upper[j] - 0.05);
    }
    setGroupPositions(*m_cell.model, m_cell.arm, arm, query.start);
    const Pose X = cellTool(query.start);
    std::function<Pose(double)> path;
    if (m_macro == "move_around_axis") {
      const Vector3d axis = tests::randomDirection(m_random), center = X.translation() + m_random.uniform(0.05, 0.5) * tests::randomDirection(m_random).cross(axis).normalized();
      const double angle = m_random.uniform(0.3, 1.2) * (m_random.unit() < 0.5 ? -1 : 1);
      query.feature = featureOf(FeatureKind::kLine, {center, center + 0.3 * axis});
      query.arguments = {{"angle", angle}};
      path = [=](double s) {
        Pose turned = Eigen::Translation3d(center) * Eigen::AngleAxisd(s * angle, axis) * Eigen::Translation3d(-center) * X;
        return turned;
      };
    } else {
      const Vector3d d = tests::randomDirection(m_random);
      const double distance = m_random.uniform(0.05, 0.3), sign = m_macro == "extract_along" ? -1 : 1;
      query.feature = featureOf(FeatureKind::kLine, {{0.5, 0, 0.5}, Vector3d(0.5, 0, 0.5) + 0.3 * d});
      query.arguments = {{"distance", distance}};
      path = [=](double s) { return Pose(Eigen::Translation3d(s * sign * distance * d) * X); };
    }
    if (!walk(query.start, path, scene)) return {};
    return query;
  }

  bool walk(Eigen::VectorXd q, const std::function<Pose(double)>& path, const std::vector<WorldObject>& scene) const {
    constexpr int kSteps = 400;
    CollisionOptions options;
    options.moving = movingIndices(*m_cell.model, m_cell.arm);
    options.padding = 0.007;             // a little more than planning keeps: those on the edge prove nothing
    options.self_padding = 0.002;
    static const AllowedPairs allowed = allowedPairs(m_cell.model);
    const CollisionWorld world(m_cell.model, scene, allowed, options);
    IkSolver solver(m_cell.model, m_cell.arm, q);
    solver.setLimits(m_cell.arm_limits.lower.array() + 0.01, m_cell.arm_limits.upper.array() - 0.01);
    IkOptions once;
    once.restarts = 0;
    for (int i = 0; i <= kSteps; ++i) {
      const Eigen::VectorXd arm = groupPositions(*m_cell.model, m_cell.arm, q);
      const auto next = solver.solve(path(static_cast<double>(i) / kSteps), arm, once);
      if (!next || (next->joints - arm).cwiseAbs().maxCoeff() > 0.02) return false;      // near a singularity
      setGroupPositions(*m_cell.model, m_cell.arm, next->joints, q);
      if (i % 8 == 0 && world.inCollision(q)) return false;
    }
    return true;
  }

  Pose cellTool(const Eigen::VectorXd& q) const { return m_cell.model->forward(q, *m_cell.model->linkIndex(m_cell.arm.tip_link)); }

  std::string m_macro;
  int m_refused = 0;
  Random m_random;
  const Workcell& m_cell;
};

struct Tally {
  int queries = 0, planned = 0, violations = 0, over = 0;
  std::vector<double> seconds;
  double least_coverage = 1;
  std::map<std::string, int> failures;
  double share() const { return static_cast<double>(planned) / queries; }
};

Tally run(const std::string& name, int queries, unsigned seed) {
  const Workcell& cell = tests::builtIn();
  Queries source(name, seed);
  Tally tally;
  for (int i = 0; i < queries; ++i) {
    const std::vector<WorldObject> scene = tests::clutter(i);
    const Query query = source.next(scene);
    PlanContext context;
    context.workcell = &cell;
    context.start = query.start;
    context.arguments = query.arguments;
    context.objects = scene;
    context.seed = static_cast<unsigned>(i + 1);
    context.budget_s = 60;               // measured, not cut off: machines differ
    const Macro& macro = tests::macroOf(name);
    const Plan plan = macro.plan(context, macro.info().takes ? &query.feature : nullptr);
    ++tally.queries;
    tally.seconds.push_back(plan.planning_seconds);
    if (!plan.ok()) {
      ++tally.failures[std::string(toString(plan.status)) + ": " + plan.reason];
      continue;
    }
    ++tally.planned;
    tally.over += plan.max_velocity_ratio > 0.5 + 1e-6 || plan.max_acceleration_ratio > 0.25 + 1e-6;
    if (plan.figures.count("coverage")) tally.least_coverage = std::min(tally.least_coverage, plan.figures.at("coverage"));
    std::vector<WorldObject> objects = scene;
    for (const auto& body : bodyOf(name, query.feature)) objects.push_back(body);
    const CheckReport report = tests::sweepOf(cell, plan, objects, query.touched);
    if (report.ok) continue;
    ++tally.violations;
    std::printf("%s %d: %s\n", name.c_str(), i, report.violations[0].sentence.c_str());
  }
  std::vector<double> sorted = tally.seconds;
  std::sort(sorted.begin(), sorted.end());
  std::printf("%-19s %4d queries, %4d planned (%.1f %%), %d violations, median %.3f s, p95 %.3f s, worst %.3f s; %d drawn were not feasible\n", name.c_str(), tally.queries,
              tally.planned, 100 * tally.share(), tally.violations, sorted[sorted.size() / 2], sorted[sorted.size() * 95 / 100], sorted.back(), source.refused());
  for (const auto& [reason, count] : tally.failures) std::printf("  %d x %s\n", count, reason.c_str());
  return tally;
}

const std::vector<std::string>& everyMacro() {
  static const std::vector<std::string> names{"move_to", "look_at", "touch", "move_above", "place_here", "move_around_axis", "approach_from_side", "move_parallel",
                                              "aim_along_axis", "place_disruptor", "insert_along", "extract_along", "surface_scan", "follow_perimeter",
                                              "press", "wipe", "grasp_by_faces", "push_face", "scan_faces", "look_around"};
  return names;
}

void expectGood(const Tally& tally, double least_share) {
  EXPECT_GE(tally.share(), least_share);
  EXPECT_EQ(tally.violations, 0);
  EXPECT_EQ(tally.over, 0);
}

class MacroSample : public testing::TestWithParam<std::string> {};
class MacroCampaign : public testing::TestWithParam<std::string> {};

TEST_P(MacroSample, PlansRandomQueriesInClutterWithoutTouchingAnything) { expectGood(run(GetParam(), 6, 1), 5.0 / 6 - 1e-9); }

TEST_P(MacroCampaign, PlansNinetySevenPercentOfItsQueries) {
  const char* wanted = std::getenv("LONGARM_CAMPAIGN_QUERIES");
  const int queries = wanted != nullptr ? static_cast<int>(parseInteger(wanted).value_or(1000)) : 1000;
  expectGood(run(GetParam(), queries, 2026), 0.97);
}

const auto kName = [](const auto& info) { return info.param; };
INSTANTIATE_TEST_SUITE_P(EveryMacro, MacroSample, testing::ValuesIn(everyMacro()), kName);
INSTANTIATE_TEST_SUITE_P(EveryMacro, MacroCampaign, testing::ValuesIn(everyMacro()), kName);

}  // namespace
}  // namespace longarm::planning
