#include "planning/motion/path_planner.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <numeric>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/PlannerTerminationCondition.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include "planning/motion/random.h"

namespace longarm::planning {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

constexpr double kRange = 1.0;           // longest new branch [rad]
constexpr std::size_t kStraightTries = 6;

using RealState = ob::RealVectorStateSpace::StateType;

Eigen::VectorXd toVector(const ob::State* state, int n) {
  return Eigen::Map<const Eigen::VectorXd>(state->as<RealState>()->values, n);
}

void copyTo(const Eigen::VectorXd& v, ob::State* state) {
  std::copy(v.data(), v.data() + v.size(), state->as<RealState>()->values);
}

// What one search shares between OMPL's callbacks.
struct Search {
  const ArmSpace& space;
  const PathRequest& request;
  Random random;
  int samples = 0;

  bool stop() const {
    return request.cancel.cancelled() || samples >= request.max_iterations || steadyNow() > request.deadline_s;
  }
};

class SeededSampler final : public ob::StateSampler {
 public:
  SeededSampler(const ob::StateSpace* space, Search& search) : ob::StateSampler(space), m_search(search) {}
  void sampleUniform(ob::State* state) override {
    ++m_search.samples;
    double* values = state->as<RealState>()->values;
    for (int j = 0; j < m_search.space.size(); ++j) {
      values[j] = m_search.random.uniform(m_search.space.lower()[j], m_search.space.upper()[j]);
    }
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    ++m_search.samples;
    double* values = state->as<RealState>()->values;
    for (int j = 0; j < m_search.space.size(); ++j) {
      const double middle = near->as<RealState>()->values[j];
      values[j] = std::clamp(m_search.random.uniform(middle - distance, middle + distance),
                             m_search.space.lower()[j], m_search.space.upper()[j]);
    }
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    sampleUniformNear(state, mean, deviation);
  }

 private:
  Search& m_search;
};

class ContinuousValidator final : public ob::MotionValidator {
 public:
  ContinuousValidator(const ob::SpaceInformationPtr& information, const ArmSpace& space)
      : ob::MotionValidator(information), m_space(space) {}
  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    return m_space.segmentFree(toVector(a, m_space.size()), toVector(b, m_space.size()));
  }
  bool checkMotion(const ob::State* a, const ob::State* b, std::pair<ob::State*, double>& last) const override {
    if (checkMotion(a, b)) return true;
    if (last.first != nullptr) si_->copyState(last.first, a);
    last.second = 0;
    return false;
  }

 private:
  const ArmSpace& m_space;
};

ob::SpaceInformationPtr makeInformation(const ArmSpace& space, Search& search) {
  auto states = std::make_shared<ob::RealVectorStateSpace>(static_cast<unsigned>(space.size()));
  ob::RealVectorBounds bounds(static_cast<unsigned>(space.size()));
  for (int j = 0; j < space.size(); ++j) {
    // A start a hair outside its limits is still a start.
    bounds.setLow(static_cast<unsigned>(j), space.lower()[j] - 1e-6);
    bounds.setHigh(static_cast<unsigned>(j), space.upper()[j] + 1e-6);
  }
  states->setBounds(bounds);
  states->setStateSamplerAllocator(
      [&search](const ob::StateSpace* s) { return std::make_shared<SeededSampler>(s, search); });
  auto information = std::make_shared<ob::SpaceInformation>(states);
  information->setStateValidityChecker(
      [&space](const ob::State* state) { return space.valid(toVector(state, space.size())); });
  information->setMotionValidator(std::make_shared<ContinuousValidator>(information, space));
  information->setup();
  return information;
}

std::size_t nearestGoal(const PathRequest& request, const Eigen::VectorXd& end) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < request.goals.size(); ++i) {
    if ((request.goals[i] - end).squaredNorm() < (request.goals[best] - end).squaredNorm()) best = i;
  }
  return best;
}

PathAnswer search(const ArmSpace& space, const PathRequest& request) {
  Search state{space, request, Random(request.seed)};
  const ob::SpaceInformationPtr information = makeInformation(space, state);
  auto problem = std::make_shared<ob::ProblemDefinition>(information);
  ob::State* scratch = information->allocState();
  copyTo(request.start, scratch);
  problem->addStartState(scratch);
  auto goals = std::make_shared<ob::GoalStates>(information);
  for (const auto& goal : request.goals) {
    copyTo(goal, scratch);
    goals->addState(scratch);
  }
  information->freeState(scratch);
  problem->setGoal(goals);
  auto planner = std::make_shared<og::RRTConnect>(information);
  planner->setNearestNeighbors<ompl::NearestNeighborsLinear>();
  planner->setRange(kRange);
  planner->setProblemDefinition(problem);
  planner->setup();
  const ob::PlannerStatus solved = planner->solve(ob::PlannerTerminationCondition([&state] { return state.stop(); }));
  PathAnswer answer;
  answer.iterations = state.samples;
  if (solved != ob::PlannerStatus::EXACT_SOLUTION) {
    if (request.cancel.cancelled()) answer.status = PlanStatus::kCancelled;
    else if (state.samples < request.max_iterations && steadyNow() > request.deadline_s) answer.status = PlanStatus::kTimeout;
    return answer;
  }
  auto* path = problem->getSolutionPath()->as<og::PathGeometric>();
  for (const ob::State* s : path->getStates()) answer.waypoints.push_back(toVector(s, space.size()));
  answer.waypoints.front() = request.start;
  answer.goal = nearestGoal(request, answer.waypoints.back());
  answer.waypoints.back() = request.goals[answer.goal];
  answer.status = PlanStatus::kOk;
  return answer;
}

// The first goals, nearest of them first, that a straight motion reaches.
PathAnswer straight(const ArmSpace& space, const PathRequest& request) {
  std::vector<std::size_t> order(std::min(request.goals.size(), kStraightTries));
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return (request.goals[a] - request.start).norm() < (request.goals[b] - request.start).norm();
  });
  PathAnswer answer;
  for (const std::size_t i : order) {
    if (request.cancel.cancelled()) {
      answer.status = PlanStatus::kCancelled;
      return answer;
    }
    if (!space.segmentFree(request.start, request.goals[i])) continue;
    answer.status = PlanStatus::kOk;
    answer.goal = i;
    answer.waypoints = {request.start, request.goals[i]};
    return answer;
  }
  return answer;
}

// Point at arc length `at` and the index of the segment it lies on.
std::pair<Eigen::VectorXd, std::size_t> along(const std::vector<Eigen::VectorXd>& waypoints, double at) {
  for (std::size_t i = 0; i + 1 < waypoints.size(); ++i) {
    const double length = (waypoints[i + 1] - waypoints[i]).norm();
    if (at <= length || i + 2 == waypoints.size()) {
      const double s = length > 0 ? std::min(at / length, 1.0) : 0;
      return {waypoints[i] + s * (waypoints[i + 1] - waypoints[i]), i};
    }
    at -= length;
  }
  return {waypoints.back(), waypoints.size() - 2};
}

// Leaves out waypoints that a straight motion can skip, farthest first.
void dropWaypoints(const ArmSpace& space, std::vector<Eigen::VectorXd>& waypoints, const CancelToken& cancel) {
  for (std::size_t i = 0; i + 2 < waypoints.size() && !cancel.cancelled(); ++i) {
    for (std::size_t j = waypoints.size() - 1; j > i + 1; --j) {
      if (!space.segmentFree(waypoints[i], waypoints[j])) continue;
      waypoints.erase(waypoints.begin() + static_cast<long>(i) + 1, waypoints.begin() + static_cast<long>(j));
      break;
    }
  }
}

}  // namespace

double steadyNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double pathLength(const std::vector<Eigen::VectorXd>& waypoints) {
  double length = 0;
  for (std::size_t i = 1; i < waypoints.size(); ++i) length += (waypoints[i] - waypoints[i - 1]).norm();
  return length;
}

std::vector<Eigen::VectorXd> shortcut(const ArmSpace& space, std::vector<Eigen::VectorXd> waypoints, unsigned seed,
                                      const CancelToken& cancel, int tries) {
  if (waypoints.size() < 3) return waypoints;
  dropWaypoints(space, waypoints, cancel);
  Random random(seed ^ 0x5f3759dfu);
  for (int k = 0; k < tries && waypoints.size() > 2 && !cancel.cancelled(); ++k) {
    const double length = pathLength(waypoints);
    double from = random.uniform(0, length), to = random.uniform(0, length);
    if (from > to) std::swap(from, to);
    const auto [a, i] = along(waypoints, from);
    const auto [b, j] = along(waypoints, to);
    if (i == j) continue;
    std::vector<Eigen::VectorXd> next(waypoints.begin(), waypoints.begin() + static_cast<long>(i) + 1);
    if ((a - next.back()).norm() > 1e-6) next.push_back(a);
    if ((b - next.back()).norm() > 1e-6) next.push_back(b);
    for (std::size_t n = j + 1; n < waypoints.size(); ++n) {
      if ((waypoints[n] - next.back()).norm() > 1e-6 || n + 1 == waypoints.size()) next.push_back(waypoints[n]);
    }
    if (pathLength(next) > 0.995 * length || !space.segmentFree(a, b)) continue;
    waypoints = std::move(next);
  }
  dropWaypoints(space, waypoints, cancel);
  return waypoints;
}

PathAnswer planPath(const ArmSpace& space, const PathRequest& request) {
  PathAnswer answer;
  if (request.goals.empty()) return answer;
  try {
    ompl::msg::noOutputHandler();
    answer = straight(space, request);
    if (answer.status == PlanStatus::kOk || answer.status == PlanStatus::kCancelled) return answer;
    answer = search(space, request);
    if (answer.status != PlanStatus::kOk) return answer;
    answer.waypoints = shortcut(space, std::move(answer.waypoints), request.seed, request.cancel);
  } catch (const std::exception&) {
    answer = {};
  }
  return answer;
}

}  // namespace longarm::planning
