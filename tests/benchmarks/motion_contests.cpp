// Collision checking and free motion beside FCL on meshes and OMPL with its own simplifier, on the built-in arm.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>

#include <benchmark/benchmark.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/geometric_shape_to_BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include "core/text.h"
#include "planning/collision/collision_world.h"
#include "planning/motion/arm_space.h"
#include "planning/motion/path_planner.h"
#include "planning/world/zone.h"
#include "tests/benchmarks/gate.h"

namespace longarm::benchmarks {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using Eigen::VectorXd;
using planning::WorldObject;
using Mesh = fcl::BVHModel<fcl::OBBRSS<double>>;

constexpr int kStates = 500, kProblems = 6, kSides = 32;
constexpr double kResolution = 0.01;     // OMPL's usual share of the space between two checks of a motion

WorldObject box(const std::string& name, const Eigen::Vector3d& size, const Eigen::Vector3d& at) {
  WorldObject out;
  out.name = name;
  out.shape = planning::Box{size};
  out.X_WO.translation() = at;
  return out;
}

// A table with a shelf of two boards on it, and a post to one side.
std::vector<WorldObject> tableAndShelf() {
  return {box("floor", {4, 4, 0.02}, {0, 0, -0.02}),          box("table", {0.6, 1.2, 0.03}, {0.85, 0, 0.35}),
          box("board_low", {0.3, 0.9, 0.02}, {1.0, 0, 0.62}), box("board_high", {0.3, 0.9, 0.02}, {1.0, 0, 0.95}),
          box("side_left", {0.3, 0.02, 0.6}, {1.0, 0.45, 0.65}), box("side_right", {0.3, 0.02, 0.6}, {1.0, -0.45, 0.65}),
          box("post", {0.06, 0.06, 1.2}, {0.45, 0.6, 0.6})};
}

std::shared_ptr<Mesh> meshOf(const planning::Shape& shape) {
  auto mesh = std::make_shared<Mesh>();
  const fcl::Transform3<double> here = fcl::Transform3<double>::Identity();
  if (const auto* b = std::get_if<planning::Box>(&shape)) {
    fcl::generateBVHModel(*mesh, fcl::Box<double>(b->size), here);
  } else if (const auto* c = std::get_if<planning::Cylinder>(&shape)) {
    fcl::generateBVHModel(*mesh, fcl::Cylinder<double>(c->radius, c->length), here, kSides, 4);
  } else if (const auto* s = std::get_if<planning::Sphere>(&shape)) {
    fcl::generateBVHModel(*mesh, fcl::Sphere<double>(s->radius), here, kSides, kSides / 2);
  } else {
    const auto& triangles = *std::get<std::shared_ptr<const planning::TriangleMesh>>(shape);
    std::vector<fcl::Triangle> corners;
    for (const auto& t : triangles.triangles) {
      corners.emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2]));
    }
    mesh->beginModel();
    mesh->addSubModel(triangles.vertices, corners);
    mesh->endModel();
  }
  return mesh;
}

// The peer: every body a mesh, boxes around bodies first, then FCL's collide().  Robots whose shapes are meshes are checked so.
class MeshWorld {
 public:
  MeshWorld(const planning::Workcell& cell, const std::vector<WorldObject>& objects, VectorXd q) : m_cell(cell), m_q(std::move(q)) {
    const auto& links = cell.model->links();
    for (std::size_t i = 0; i < links.size(); ++i) {
      for (const auto& shape : links[i].collisions) add(static_cast<int>(i), shape.shape, shape.X_LS);
    }
    for (const auto& object : objects) add(-1, object.shape, object.X_WO);
    const auto allowed = planning::allowedPairs(cell.model);
    for (std::size_t i = 0; i < m_bodies.size(); ++i) {
      for (std::size_t j = i + 1; j < m_bodies.size(); ++j) {
        if (meets(m_bodies[i].link, m_bodies[j].link, allowed)) m_pairs.emplace_back(i, j);
      }
    }
  }

  bool free(const VectorXd& arm) {
    planning::setGroupPositions(*m_cell.model, m_cell.arm, arm, m_q);
    m_cell.model->forward(m_q, m_links);
    for (auto& body : m_bodies) {
      if (body.link < 0) continue;
      body.object->setTransform(m_links[static_cast<std::size_t>(body.link)] * body.X_LS);
      body.object->computeAABB();
    }
    fcl::CollisionRequest<double> request(1, false);
    for (const auto& [i, j] : m_pairs) {
      if (!m_bodies[i].object->getAABB().overlap(m_bodies[j].object->getAABB())) continue;
      fcl::CollisionResult<double> result;
      fcl::collide(m_bodies[i].object.get(), m_bodies[j].object.get(), request, result);
      if (result.isCollision()) return false;
    }
    return true;
  }

 private:
  struct Body {
    int link;
    Pose X_LS;
    std::shared_ptr<fcl::CollisionObject<double>> object;
  };

  void add(int link, const planning::Shape& shape, const Pose& X) {
    auto object = std::make_shared<fcl::CollisionObject<double>>(meshOf(shape));
    object->setTransform(X);
    object->computeAABB();
    m_bodies.push_back({link, X, std::move(object)});
  }

  bool beyond(int link) const {
    const int last = m_cell.model->joints()[static_cast<std::size_t>(m_cell.arm.joints.back())].child_link;
    for (; link >= 0; link = parent(link)) {
      if (link == last) return true;
    }
    return false;
  }
  int parent(int link) const {
    const int joint = m_cell.model->links()[static_cast<std::size_t>(link)].parent_joint;
    return joint < 0 ? -1 : m_cell.model->joints()[static_cast<std::size_t>(joint)].parent_link;
  }
  bool meets(int a, int b, const planning::AllowedPairs& allowed) const {
    if (a == b || (a < 0 && b < 0)) return false;
    if (a >= 0 && b >= 0 && allowed.count({std::min(a, b), std::max(a, b)}) > 0) return false;
    if (beyond(a) && beyond(b)) return false;          // the arm does not move these against each other
    return planning::movedByArm(m_cell, a) || planning::movedByArm(m_cell, b);
  }

  const planning::Workcell& m_cell;
  VectorXd m_q;
  std::vector<Body> m_bodies;
  std::vector<std::pair<std::size_t, std::size_t>> m_pairs;
  std::vector<Pose> m_links;
};

struct Bench {
  Bench() : cell(planning::loadBuiltInWorkcell().value()), scene(tableAndShelf()), q(cell.model->neutral()), random(11) {
    ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
    for (const auto& [name, value] : cell.poses.at("ready")) {
      q[cell.model->joints()[static_cast<std::size_t>(*cell.model->jointIndex(name))].q_index] = value;
    }
    planning::CollisionOptions options;
    options.moving = planning::movingIndices(*cell.model, cell.arm);
    options.padding = options.self_padding = 0;
    world = std::make_unique<planning::CollisionWorld>(cell.model, scene, planning::allowedPairs(cell.model), options);
    space = std::make_unique<planning::ArmSpace>(cell, *world, q);
    meshes = std::make_unique<MeshWorld>(cell, scene, q);
  }

  VectorXd randomArm() {
    VectorXd arm(space->size());
    for (int j = 0; j < arm.size(); ++j) arm[j] = std::uniform_real_distribution<>(space->lower()[j], space->upper()[j])(random);
    return arm;
  }
  VectorXd randomFree() {
    for (;;) {
      const VectorXd arm = randomArm();
      if (space->valid(arm) && meshes->free(arm)) return arm;
    }
  }

  planning::Workcell cell;
  std::vector<WorldObject> scene;
  VectorXd q;
  std::mt19937 random;
  std::unique_ptr<planning::CollisionWorld> world;
  std::unique_ptr<planning::ArmSpace> space;
  std::unique_ptr<MeshWorld> meshes;
};

long statesToCompare() {
  const char* text = std::getenv("LONGARM_BENCH_STATES");
  const auto number = text != nullptr ? parseInteger(text) : std::nullopt;
  return number && *number > 0 ? *number : 100000;
}

Accuracy validityAccuracy(Bench& bench) {
  const long states = statesToCompare();
  long hits = 0, false_free = 0, false_hit = 0;
  for (long i = 0; i < states; ++i) {
    const VectorXd arm = bench.randomArm();
    const bool ours = bench.space->valid(arm), theirs = bench.meshes->free(arm);
    hits += !theirs;
    false_free += ours && !theirs;
    false_hit += !ours && theirs;
  }
  const double share = static_cast<double>(false_hit) / static_cast<double>(std::max(1L, states - hits));
  return {false_free == 0 && share <= 0.03,
          std::to_string(false_free) + " of " + std::to_string(states) + " states wrongly free (limit 0), " + formatFixed(100 * share, 2) +
              " % of the free ones wrongly hit (limit 3 %); " + formatFixed(100.0 * static_cast<double>(hits) / static_cast<double>(states), 0) + " % hit"};
}

Contest validityContest(const std::shared_ptr<Bench>& bench) {
  Contest contest{"state_validity", "FCL collide() on meshes, boxes around bodies first", {}, {}, 5, 40, false, {}};
  const auto states = std::make_shared<std::vector<VectorXd>>();
  for (int i = 0; i < kStates; ++i) states->push_back(bench->randomArm());
  contest.ours = [bench, states] {
    for (const auto& arm : *states) benchmark::DoNotOptimize(bench->space->valid(arm));
  };
  contest.theirs = [bench, states] {
    for (const auto& arm : *states) benchmark::DoNotOptimize(bench->meshes->free(arm));
  };
  contest.accuracy = [bench] { return validityAccuracy(*bench); };
  return contest;
}

struct Problem {
  VectorXd start, goal;
};

planning::PathAnswer ourPath(const Bench& bench, const Problem& problem) {
  planning::PathRequest request;
  request.start = problem.start;
  request.goals = {problem.goal};
  return planning::planPath(*bench.space, request);
}

// RRT-Connect with states checked every hundredth of the space, then simplifyMax().
class Peer {
 public:
  explicit Peer(Bench& bench) : m_bench(bench) {
    const int n = bench.space->size();
    m_space = std::make_shared<ob::RealVectorStateSpace>(static_cast<unsigned>(n));
    ob::RealVectorBounds bounds(static_cast<unsigned>(n));
    for (int j = 0; j < n; ++j) {
      bounds.setLow(static_cast<unsigned>(j), bench.space->lower()[j]);
      bounds.setHigh(static_cast<unsigned>(j), bench.space->upper()[j]);
    }
    m_space->setBounds(bounds);
    m_space->setLongestValidSegmentFraction(kResolution);
    m_info = std::make_shared<ob::SpaceInformation>(m_space);
    m_info->setStateValidityChecker([this, n](const ob::State* state) {
      return m_bench.meshes->free(Eigen::Map<const VectorXd>(state->as<ob::RealVectorStateSpace::StateType>()->values, n));
    });
    m_info->setup();
  }

  /// Length of the simplified path; infinite without one.
  double solve(const Problem& problem) {
    ob::ScopedState<> start(m_space), goal(m_space);
    for (int j = 0; j < problem.start.size(); ++j) {
      start[static_cast<unsigned>(j)] = problem.start[j];
      goal[static_cast<unsigned>(j)] = problem.goal[j];
    }
    auto definition = std::make_shared<ob::ProblemDefinition>(m_info);
    definition->setStartAndGoalStates(start, goal);
    og::RRTConnect planner(m_info);
    planner.setProblemDefinition(definition);
    planner.setup();
    if (!planner.solve(ob::timedPlannerTerminationCondition(20))) return HUGE_VAL;
    auto path = std::static_pointer_cast<og::PathGeometric>(definition->getSolutionPath());
    og::PathSimplifier(m_info).simplifyMax(*path);
    return path->length();
  }
  double resolution() const { return kResolution * m_space->getMaximumExtent(); }

 private:
  Bench& m_bench;
  std::shared_ptr<ob::RealVectorStateSpace> m_space;
  std::shared_ptr<ob::SpaceInformation> m_info;
};

Accuracy pathAccuracy(Bench& bench, Peer& peer, const std::vector<Problem>& problems) {
  double ours = 0, theirs = 0;
  int found = 0, touching = 0;
  for (const auto& problem : problems) {
    const auto answer = ourPath(bench, problem);
    if (answer.status != planning::PlanStatus::kOk) continue;
    ++found;
    ours += planning::pathLength(answer.waypoints);
    theirs += peer.solve(problem);
    for (std::size_t i = 1; i < answer.waypoints.size(); ++i) {
      const VectorXd way = answer.waypoints[i] - answer.waypoints[i - 1];
      const int steps = std::max(1, static_cast<int>(std::ceil(way.norm() / (0.5 * peer.resolution()))));
      for (int k = 0; k <= steps; ++k) touching += !bench.meshes->free(answer.waypoints[i - 1] + way * (static_cast<double>(k) / steps));
    }
  }
  const double ratio = theirs > 0 ? ours / theirs : HUGE_VAL;
  return {found == kProblems && touching == 0 && ratio <= 1.05,
          std::to_string(found) + " of " + std::to_string(kProblems) + " found, length " + formatFixed(ratio, 3) +
              " of theirs (limit 1.05), " + std::to_string(touching) + " states of ours touch on meshes at half their step (limit 0)"};
}

Contest pathContest(const std::shared_ptr<Bench>& bench) {
  Contest contest{"plan_simplify", "OMPL RRTConnect + simplifyMax, FCL meshes every 1 % of the space", {}, {}, 3, 20, false, {}};
  ompl::RNG::setSeed(1);
  const auto peer = std::make_shared<Peer>(*bench);
  const auto problems = std::make_shared<std::vector<Problem>>();
  while (problems->size() < kProblems) {
    const Problem problem{bench->randomFree(), bench->randomFree()};
    if (!bench->space->segmentFree(problem.start, problem.goal)) problems->push_back(problem);   // the straight way is no problem
  }
  contest.ours = [bench, problems] {
    for (const auto& problem : *problems) benchmark::DoNotOptimize(ourPath(*bench, problem).waypoints.size());
  };
  contest.theirs = [peer, problems] {
    for (const auto& problem : *problems) benchmark::DoNotOptimize(peer->solve(problem));
  };
  contest.accuracy = [bench, peer, problems] { return pathAccuracy(*bench, *peer, *problems); };
  return contest;
}

}  // namespace

std::vector<Contest> motionContests() {
  const auto bench = std::make_shared<Bench>();
  return {validityContest(bench), pathContest(bench)};
}

}  // namespace longarm::benchmarks
