#include "planning/macros/task_search.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace longarm::planning {
namespace {

constexpr double kDistinct = 0.1;        // postures closer than this are one [rad]
constexpr double kRollStep = M_PI / 12;
constexpr double kRungStep = 0.04;       // [m]
constexpr double kRungTurn = M_PI / 12;
constexpr double kFineStep = 0.005;      // [m]
constexpr double kFineStepOfLong = 0.01;
constexpr double kLong = 0.6;            // stages from this length are followed in longer steps [m]
constexpr double kFineTurn = 2 * M_PI / 180;
constexpr double kEvenStep = 2 * M_PI / 180;
constexpr double kMostDeviation = 5e-4;  // of the spline between waypoints [m]
constexpr double kMostTurn = 5e-3;       // [rad]
constexpr std::size_t kRoughMost = 12;

// 0, +1, -1, +2, ... steps: all turns about tool z, nearest to the wanted one first.
std::vector<double> rollsOf(const ToolTask& task) {
  std::vector<double> rolls{0};
  for (int i = 1; task.roll_free && i <= 12; ++i) {
    rolls.push_back(i * kRollStep);
    if (i < 12) rolls.push_back(-i * kRollStep);
  }
  return rolls;
}

}  // namespace

/// The coarse stations of all stages in a row.
struct TaskSearch::Rungs {
  Ladder ladder;
  std::vector<std::size_t> stage;        // of each rung
  std::vector<double> way;               // within its stage [m]
  int restarts;                          // of the inverse kinematics at the first
  std::vector<std::size_t> first;        // rung at which each stage starts (shared with the end of the one before)

  explicit Rungs(const ToolTask& task) : restarts(task.restarts) {
    ladder.X_RT.push_back(task.stages.empty() ? task.X_entry : task.stages.front().path.start());
    stage.push_back(0);
    way.push_back(0);
    for (std::size_t k = 0; k < task.stages.size(); ++k) {
      first.push_back(ladder.X_RT.size() - 1);
      const ToolPath& path = task.stages[k].path;
      const std::vector<double> stations = path.stations(kRungStep, kRungTurn);
      for (std::size_t i = 1; i < stations.size(); ++i) {
        ladder.X_RT.push_back(path.at(stations[i]));
        stage.push_back(k);
        way.push_back(stations[i]);
      }
    }
  }

  bool holds(std::size_t rung, std::size_t k) const { return rung < stage.size() && stage[rung] == k; }
  // Last rung of stage k that lies not beyond `s`.
  std::size_t rungAt(std::size_t k, double s) const {
    std::size_t i = first[k];
    while (holds(i + 1, k) && way[i + 1] <= s) ++i;
    return i;
  }
  // Roll at way s of stage k, eased from rung to rung.
  double rollAt(std::size_t k, double s, const std::vector<double>& rolls) const {
    std::size_t i = rungAt(k, s);
    if (!holds(i + 1, k)) return rolls[i];
    const double from = i == first[k] ? 0 : way[i];
    const double w = std::clamp((s - from) / (way[i + 1] - from), 0.0, 1.0);
    return rolls[i] + (rolls[i + 1] - rolls[i]) * w * w * (3 - 2 * w);
  }
};

struct TaskSearch::Rough {
  LadderPath path;                       // at least its first rung
  double cost = 0;
};

TaskSearch::TaskSearch(PlanningRun& run, const ArmSpace& free, const ArmSpace& touching)
    : m_run(run), m_free(free), m_touching(touching), m_solver(run.workcell().model, run.workcell().arm, free.full(run.start())),
      m_reach(reachOf(run.workcell(), free.full(run.start()))) {
  m_solver.setLimits(free.lower(), free.upper());
}

const ArmSpace& TaskSearch::spaceOf(const ToolStage& stage) const {
  if (!stage.X_released) return stage.touching ? m_touching : m_free;
  for (const Released& known : m_released) {
    if (known.touching == stage.touching && known.X_moved.isApprox(*stage.X_released, 1e-9)) return *known.space;
  }
  const Eigen::VectorXd q = m_run.withGripperAt(m_run.workcell().gripper->open);
  Released made{*stage.X_released, stage.touching, m_run.makeReleasedWorld(*stage.X_released, q, stage.touching), nullptr};
  made.space = std::make_unique<ArmSpace>(m_run.workcell(), *made.world, q, m_run.context().cancel);
  m_released.push_back(std::move(made));
  return *m_released.back().space;
}

void TaskSearch::addPostures(const Pose& X_RT, double roll, const Rungs& rungs, const Eigen::VectorXd& from,
                             std::vector<Rough>& out) {
  IkOptions options;
  options.restarts = rungs.restarts;
  options.seed = m_run.context().seed;
  const auto postures = m_solver.solveAll(rolled(X_RT, roll), from, options, kDistinct);
  if (!postures) {
    ++m_refusals.unreachable;
    if (!m_refusals.pose) m_refusals.pose = rolled(X_RT, roll);
    return;
  }
  for (const auto& posture : *postures) {
    if (!rungs.ladder.valid(0, posture.joints)) {
      ++m_refusals.colliding;
      m_refusals.contact = *m_rung_contact;
      if (m_refusals.colliding == 1 && m_refusals.stopped == 0) m_refusals.pose = rolled(X_RT, roll);
      continue;
    }
    Rough rough;
    rough.path.joints = {posture.joints};
    rough.path.rolls = {roll};
    rough.cost = rough.path.cost = (posture.joints - from).norm();
    out.push_back(std::move(rough));
  }
}

std::vector<TaskSearch::Rough> TaskSearch::entries(const TaskPart& part, const ToolTask& task, const Rungs& rungs,
                                                   const Eigen::VectorXd& from) {
  std::vector<Rough> out;
  if (part.from_here) {
    out.emplace_back();
    out.back().path.joints = {from};
    out.back().path.rolls = {0};
    return out;
  }
  for (const double roll : rollsOf(task)) {
    if (stop()) return {};
    addPostures(rungs.ladder.X_RT.front(), roll, rungs, from, out);
  }
  std::stable_sort(out.begin(), out.end(), [](const Rough& a, const Rough& b) { return a.cost < b.cost; });
  return out;
}

void TaskSearch::noteStop(const ToolTask& task, const Rungs& rungs, std::size_t reached,
                          const std::optional<Contact>& contact, const std::string& why) {
  ++m_refusals.stopped;
  const std::size_t next = std::min(reached + 1, rungs.stage.size() - 1);
  const ToolStage& stage = task.stages[rungs.stage[next]];
  const double way = rungs.stage[reached] == rungs.stage[next] ? rungs.way[reached] : 0;
  const double furthest = static_cast<double>(rungs.stage[next]) + way / stage.path.length();
  if (furthest <= m_refusals.furthest) return;
  m_refusals.furthest = furthest;
  m_refusals.stop_contact = contact;
  m_refusals.stage = stage.name;
  m_refusals.why = contact ? contact->sentence() : why;
  m_refusals.waypoint = static_cast<int>(next);
  m_refusals.pose = rungs.ladder.X_RT[next];
}

std::vector<TaskSearch::Rough> TaskSearch::roughWays(const TaskPart& part, const ToolTask& task, const Rungs& rungs,
                                                     const Eigen::VectorXd& from, std::size_t enough) {
  const std::vector<Rough> starts = entries(part, task, rungs, from);
  std::vector<Rough> out;
  LadderOptions options;
  options.roll_step = task.roll_free ? kRollStep : 0;
  for (const Rough& start : starts) {
    if (stop() || out.size() >= enough) break;
    std::size_t reached = 0;
    Rough way;
    m_rung_contact.reset();
    way.path = followRungs(m_solver, rungs.ladder, start.path.joints.front(), start.path.rolls.front(), options, reached);
    way.cost = start.cost + way.path.cost;
    if (!way.path.joints.empty()) out.push_back(std::move(way));
    else noteStop(task, rungs, reached, m_rung_contact);
  }
  if (!out.empty() || starts.empty() || stop() || !task.roll_free) return out;
  std::vector<LadderPath> all;
  for (const Rough& start : starts) all.push_back(start.path);
  for (LadderPath& path : climb(m_solver, rungs.ladder, all, options).paths) {
    const double cost = path.cost;
    out.push_back({std::move(path), cost});
  }
  return out;
}

std::optional<StraightLeg> TaskSearch::followStage(const ToolTask& task, std::size_t k, const Rungs& rungs,
                                                   const std::vector<double>& rolls, const Eigen::VectorXd& arm) {
  const ToolStage& stage = task.stages[k];
  const ArmSpace& space = spaceOf(stage);
  const auto X_RT = [&](double s) { return rolled(stage.path.at(s), rungs.rollAt(k, s, rolls)); };
  const auto stopped = [&](double way, const std::optional<Contact>& by, const std::string& why = {}) -> std::optional<StraightLeg> {
    noteStop(task, rungs, rungs.rungAt(k, way), by, why);
    return {};
  };
  LegOptions options;
  options.even_step = kEvenStep;
  const double step = stage.path.length() > kLong ? kFineStepOfLong : kFineStep;
  StraightLeg leg = followPath(space, arm, X_RT, stage.path.stations(step, kFineTurn), options);
  if (!leg.ok) return stopped(leg.fraction * stage.path.length(), {}, "the next piece " + leg.next);
  Contact contact;
  for (std::size_t i = 1; i < leg.waypoints.size(); ++i) {
    if (i % 16 == 0 && stop()) return {};
    if (!space.segmentFree(leg.waypoints[i - 1], leg.waypoints[i], &contact)) return stopped(leg.way[i - 1], contact);
  }
  const LegDeviation off = splineDeviation(space, leg, X_RT);
  if (off.position > kMostDeviation || off.angle > kMostTurn) {
    return stopped(0, {}, "the arm would leave the path by " + formatFixed(off.position * 1e3, 2) + " mm");
  }
  return leg;
}

std::optional<FollowedTask> TaskSearch::refine(const ToolTask& task, const Rungs& rungs, const Rough& rough) {
  FollowedTask out;
  out.task = &task;
  out.entry = rough.path.joints.front();
  for (std::size_t k = 0; k < task.stages.size(); ++k) {
    if (stop()) return {};
    auto leg = followStage(task, k, rungs, rough.path.rolls, out.exit());
    if (!leg) return {};
    out.legs.push_back(std::move(*leg));
  }
  return out;
}

// Both are borrowed by the ladder.
void TaskSearch::watch(const ToolTask& task, Rungs& rungs) {
  rungs.ladder.stop = [this] { return stop(); };
  rungs.ladder.valid = [this, &task, &rungs](std::size_t rung, const Eigen::VectorXd& arm) {
    Contact contact;
    if ((rung > 0 ? spaceOf(task.stages[rungs.stage[rung]]) : m_free).valid(arm, &contact)) return true;
    m_rung_contact = contact;
    return false;
  };
}

std::optional<ReachSeed> TaskSearch::glanceAt(const TaskPart& part, int k, const Eigen::VectorXd& start, double roll, int restarts) {
  const ToolTask& task = part.tasks[static_cast<std::size_t>(k)];
  Rungs rungs(task);
  watch(task, rungs);
  ReachSeed out{k, roll, start};
  if (!part.from_here) {
    const Pose X = rolled(rungs.ladder.X_RT.front(), roll);
    IkOptions options;
    options.restarts = restarts;
    options.seed = m_run.context().seed;
    const bool far = (X.translation() - m_reach.shoulder).norm() > m_reach.length;
    const auto solved = far ? Result<IkSolution>(ErrorCode::kNoSolution, "") : m_solver.solve(X, start, options);
    if (!solved) {
      ++m_refusals.unreachable;
      return {};
    }
    out.entry = solved->joints;
    if (!rungs.ladder.valid(0, out.entry)) {
      ++m_refusals.colliding;
      m_refusals.contact = *m_rung_contact;
      return {};
    }
  }
  std::size_t reached = 0;
  m_rung_contact.reset();
  if (!followRungs(m_solver, rungs.ladder, out.entry, roll, {}, reached).joints.empty()) return out;
  noteStop(task, rungs, reached, m_rung_contact);
  return {};
}

std::optional<ReachSeed> TaskSearch::glance(const TaskPart& part, const Eigen::VectorXd& from, const ReachSeed& seed) {
  const int count = static_cast<int>(part.tasks.size());
  std::optional<ReachSeed> again;
  if (seed.task >= 0 && seed.task < count && seed.entry.size() == from.size()) again = glanceAt(part, seed.task, seed.entry, seed.roll, 0);
  const int best = part.tasks.front().preference;
  if (again && part.tasks[static_cast<std::size_t>(again->task)].preference == best) return again;
  for (int k = 0; k < count; ++k) {
    if (again && part.tasks[static_cast<std::size_t>(k)].preference > best) return again;
    const std::vector<double> rolls = part.from_here ? std::vector<double>{0} : rollsOf(part.tasks[static_cast<std::size_t>(k)]);
    for (const double roll : rolls) {
      if (stop()) return again;
      if (auto found = glanceAt(part, k, from, roll, 1)) return found;
    }
  }
  return again;
}

std::vector<FollowedTask> TaskSearch::find(const TaskPart& part, std::size_t first, std::size_t last,
                                           const Eigen::VectorXd& from, std::size_t enough) {
  struct Way {
    const ToolTask* task;
    std::size_t rungs;
    Rough rough;
  };
  std::vector<Way> ways;
  std::vector<Rungs> rungs;
  rungs.reserve(last - first);
  for (std::size_t i = first; i < last && ways.size() < kRoughMost && !stop(); ++i) {
    const ToolTask& task = part.tasks[i];
    rungs.emplace_back(task);
    Rungs& mine = rungs.back();
    watch(task, mine);
    for (Rough& rough : roughWays(part, task, mine, from, kRoughMost)) ways.push_back({&task, rungs.size() - 1, std::move(rough)});
  }
  std::stable_sort(ways.begin(), ways.end(), [](const Way& a, const Way& b) { return a.rough.cost < b.rough.cost; });
  std::vector<FollowedTask> out;
  for (const Way& way : ways) {
    if (stop() || out.size() >= enough) break;
    if (auto followed = refine(*way.task, rungs[way.rungs], way.rough)) out.push_back(std::move(*followed));
  }
  return out;
}

}  // namespace longarm::planning
