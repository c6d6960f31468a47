#include "planning/motion/ladder.h"

#include <algorithm>
#include <cmath>

namespace longarm::planning {
namespace {

constexpr double kSame = 0.02;           // nodes of one roll closer than this are one [rad]
constexpr std::size_t kPaths = 6;

struct Node {
  Eigen::VectorXd joints;
  int roll = 0;                          // in steps from the first node's own roll
  double base = 0;                       // that roll
  double cost = 0;
  int parent = -1;                       // on the rung below
  int origin = 0;                        // which start it grew from
};

bool step(const IkSolver& solver, const Pose& X_RT, const Eigen::VectorXd& from, double most, Eigen::VectorXd& to) {
  IkOptions once;
  once.restarts = 0;
  once.iterations = 20;
  const auto found = solver.solve(X_RT, from, once);
  if (!found || (found->joints - from).cwiseAbs().maxCoeff() > most) return false;
  to = found->joints;
  return true;
}

class Climber {
 public:
  Climber(const IkSolver& solver, const Ladder& ladder, const LadderOptions& options)
      : m_solver(solver), m_ladder(ladder), m_options(options) {}

  LadderAnswer run(const std::vector<LadderPath>& starts) {
    std::vector<Node> first;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      first.push_back({starts[i].joints.front(), 0, starts[i].rolls.front(), starts[i].cost, -1, static_cast<int>(i)});
    }
    m_rungs.push_back(std::move(first));
    LadderAnswer answer;
    for (std::size_t rung = 1; rung < m_ladder.X_RT.size(); ++rung) {
      std::vector<Node> next = grow(rung);
      if (next.empty()) return answer;
      answer.furthest = rung;
      m_rungs.push_back(std::move(next));
    }
    answer.paths = collect();
    return answer;
  }

 private:
  std::vector<Node> grow(std::size_t rung) {
    std::vector<Node> next;
    const std::vector<Node>& below = m_rungs.back();
    for (std::size_t i = 0; i < below.size(); ++i) {
      if (m_ladder.stop()) return {};
      const int most = m_options.roll_step > 0 ? 1 : 0;
      for (const int change : {0, 1, -1}) {
        if (std::abs(change) <= most) add(below[i], static_cast<int>(i), change, rung, next);
      }
    }
    std::stable_sort(next.begin(), next.end(), [](const Node& a, const Node& b) { return a.cost < b.cost; });
    return choose(next, rung);
  }

  void add(const Node& from, int parent, int change, std::size_t rung, std::vector<Node>& next) {
    Node node = from;
    node.parent = parent;
    node.roll += change;
    const double roll = node.base + node.roll * m_options.roll_step;
    if (!step(m_solver, rolled(m_ladder.X_RT[rung], roll), from.joints, m_options.max_joint_step, node.joints)) return;
    node.cost += (node.joints - from.joints).norm() + m_options.roll_cost * std::abs(change * m_options.roll_step);
    next.push_back(std::move(node));
  }

  // The cheapest that are valid and differ from one another.
  std::vector<Node> choose(std::vector<Node>& sorted, std::size_t rung) {
    std::vector<Node> kept;
    for (auto& node : sorted) {
      if (kept.size() >= m_options.widest) break;
      const bool known = std::any_of(kept.begin(), kept.end(), [&](const Node& other) {
        return (other.joints - node.joints).cwiseAbs().maxCoeff() < kSame;
      });
      if (!known && m_ladder.valid(rung, node.joints)) kept.push_back(std::move(node));
    }
    return kept;
  }

  std::vector<LadderPath> collect() const {
    std::vector<LadderPath> paths;
    std::vector<int> origins;
    for (const Node& last : m_rungs.back()) {
      if (paths.size() >= kPaths) break;
      if (std::find(origins.begin(), origins.end(), last.origin) != origins.end()) continue;
      origins.push_back(last.origin);
      LadderPath path;
      path.cost = last.cost;
      const Node* node = &last;
      for (std::size_t rung = m_rungs.size(); rung-- > 0;) {
        path.joints.push_back(node->joints);
        path.rolls.push_back(node->base + node->roll * m_options.roll_step);
        if (rung > 0) node = &m_rungs[rung - 1][static_cast<std::size_t>(node->parent)];
      }
      std::reverse(path.joints.begin(), path.joints.end());
      std::reverse(path.rolls.begin(), path.rolls.end());
      paths.push_back(std::move(path));
    }
    return paths;
  }

  const IkSolver& m_solver;
  const Ladder& m_ladder;
  const LadderOptions& m_options;
  std::vector<std::vector<Node>> m_rungs;
};

}  // namespace

Pose rolled(const Pose& X_RT, double roll) { return X_RT * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()); }

LadderAnswer climb(const IkSolver& solver, const Ladder& ladder, const std::vector<LadderPath>& starts,
                   const LadderOptions& options) {
  return Climber(solver, ladder, options).run(starts);
}

LadderPath followRungs(const IkSolver& solver, const Ladder& ladder, const Eigen::VectorXd& start, double roll,
                       const LadderOptions& options, std::size_t& reached) {
  LadderPath path;
  path.joints.push_back(start);
  path.rolls.push_back(roll);
  reached = 0;
  for (std::size_t rung = 1; rung < ladder.X_RT.size(); ++rung) {
    Eigen::VectorXd next;
    const bool there = !ladder.stop() &&
                       step(solver, rolled(ladder.X_RT[rung], roll), path.joints.back(), options.max_joint_step, next) &&
                       ladder.valid(rung, next);
    if (!there) return {};
    path.cost += (next - path.joints.back()).norm();
    path.joints.push_back(std::move(next));
    path.rolls.push_back(roll);
    reached = rung;
  }
  return path;
}

}  // namespace longarm::planning
