#include "planning/macros/task_advice.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/text.h"
#include "planning/macros/reach_advice.h"
#include "planning/motion/ladder.h"
#include "planning/motion/path_planner.h"

namespace longarm::planning {
namespace {

constexpr double kTime = 1;              // [s]
constexpr double kDriveStep = 0.1, kDriveMost = 0.6;      // [m]
constexpr double kTurnStep = M_PI / 12, kTurnMost = M_PI / 3;
constexpr double kRollStep = M_PI / 12;
constexpr int kRolls = 6;                // of a way's entry that are tried
constexpr std::size_t kMostWays = 8;

struct BaseMove {
  double forward = 0, turn = 0;          // [m], [rad]
  Pose pose() const {
    Pose X = Pose(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
    X.translation().x() = forward;
    return X;
  }
  std::string sentence() const {
    if (forward != 0) return "Drive " + formatFixed(std::abs(forward), 2) + " m " + (forward > 0 ? "forwards." : "back.");
    return "Turn the base " + formatFixed(std::abs(turn) * 180 / M_PI, 0) + " deg to the " + (turn > 0 ? "left." : "right.");
  }
};

// Shortest first; a turn of 15 degrees counts as 0.1 m.
std::vector<BaseMove> baseMoves() {
  std::vector<BaseMove> moves;
  const int turns = static_cast<int>(std::lround(kTurnMost / kTurnStep)), drives = static_cast<int>(std::lround(kDriveMost / kDriveStep));
  for (int i = 1; i <= drives; ++i) {
    for (const double sign : {1.0, -1.0}) moves.push_back({sign * i * kDriveStep, 0});
    for (const double sign : {1.0, -1.0}) {
      if (i <= turns) moves.push_back({0, sign * i * kTurnStep});
    }
  }
  return moves;
}

class Tries {
 public:
  Tries(PlanningRun& run, const ArmSpace& space)
      : m_run(run), m_space(space), m_solver(run.workcell().model, run.workcell().arm, space.full(run.start())),
        m_reach(reachOf(run.workcell(), space.full(run.start()))), m_until(std::min(steadyNow() + kTime, run.deadline_s())) {
    m_solver.setLimits(space.lower(), space.upper());
    m_ladder.stop = [this] { return over(); };
  }

  bool over() const { return steadyNow() > m_until || m_run.cancelled(); }

  // Whether a way lies within reach, seen from where the base would stand.
  bool reachable(const std::vector<Pose>& way, const Pose& X_base) {
    const Pose X_back = X_base.inverse();
    m_ladder.X_RT.clear();
    for (const Pose& X : way) {
      m_ladder.X_RT.push_back(X_back * X);
      if ((m_ladder.X_RT.back().translation() - m_reach.shoulder).norm() > m_reach.length) return false;
    }
    m_ladder.valid = [](std::size_t, const Eigen::VectorXd&) { return true; };
    IkOptions options;
    options.restarts = 2;
    options.seed = m_run.context().seed;
    for (int i = 0; i < kRolls && !over(); ++i) {
      const double roll = i * 2 * M_PI / kRolls;
      const auto entry = m_solver.solve(rolled(m_ladder.X_RT.front(), roll), m_run.start(), options);
      if (entry && follows(entry->joints, roll)) return true;
    }
    return false;
  }

  bool freeFromHere(const std::vector<Pose>& way, double roll) {
    m_ladder.X_RT = way;
    m_ladder.valid = [this](std::size_t, const Eigen::VectorXd& arm) { return m_space.valid(arm); };
    IkOptions once;
    once.restarts = 0;
    const auto entry = m_solver.solve(rolled(way.front(), roll), m_run.start(), once);
    return entry && m_space.valid(entry->joints) && follows(entry->joints, roll);
  }

 private:
  bool follows(const Eigen::VectorXd& entry, double roll) {
    std::size_t reached = 0;
    return !followRungs(m_solver, m_ladder, entry, roll, {}, reached).joints.empty();
  }

  PlanningRun& m_run;
  const ArmSpace& m_space;
  IkSolver m_solver;
  Reach m_reach;
  double m_until;
  Ladder m_ladder;
};

bool advise(PlanningRun& run, const std::string& sentence) {
  run.plan().advice.push_back(sentence);
  return true;
}

}  // namespace

bool adviseObstacle(PlanningRun& run, const Contact& contact, const std::string& target) {
  for (const auto& name : {contact.first, contact.second}) {
    if (name.empty() || name == target || run.model().linkIndex(name)) continue;
    return advise(run, "\"" + name + "\" is in the way: move it, or correct the scene.");
  }
  return false;
}

bool adviseDriving(PlanningRun& run, const ArmSpace& free, const std::vector<std::vector<Pose>>& ways) {
  Tries tries(run, free);
  for (const BaseMove& move : baseMoves()) {
    for (std::size_t i = 0; i < std::min(kMostWays, ways.size()); ++i) {
      if (tries.over()) return false;
      if (tries.reachable(ways[i], move.pose())) return advise(run, move.sentence());
    }
  }
  return false;
}

bool adviseRoll(PlanningRun& run, const ArmSpace& free, const std::vector<Pose>& way) {
  Tries tries(run, free);
  for (int i = 1; i <= 12 && !tries.over(); ++i) {
    for (const double roll : {i * kRollStep, -i * kRollStep}) {
      if (tries.freeFromHere(way, roll)) {
        return advise(run, "Roll the wrist " + formatFixed(std::abs(roll) * 180 / M_PI, 0) + " deg " +
                               (roll > 0 ? "right-handed" : "left-handed") + " about the tool first.");
      }
    }
  }
  return false;
}

}  // namespace longarm::planning
