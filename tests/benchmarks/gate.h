#pragma once

/// @file
/// Contests between our code and a peer's, measured side by side and judged against gates.

#include <functional>
#include <iosfwd>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace longarm::benchmarks {

/// What the answer is worth, whatever its speed.
struct Accuracy {
  bool holds = false;
  std::string text;                    ///< Both sides' figures and the limit, for people.
};

/// One contest.  The two functions do the same job once; they run in one program, interleaved.
struct Contest {
  std::string name, peer;
  std::function<void()> ours, theirs;
  double gate = 1;                     ///< Least ratio peer / ours.
  double moonshot = 1;                 ///< What is aimed at.
  bool real_time = false;              ///< Drawing: wall time counts, not the processor's.
  std::function<Accuracy()> accuracy;
  /// Ours and theirs where not time but a figure of `unit` is compared, the smaller the better; `ours` and `theirs` are empty.
  std::function<std::pair<double, double>()> figures = {};
  std::string unit = {};
};

/// Ninety-fifth percentile and median of a latency [s].
struct Latency {
  double wall_p95 = 0, wall_median = 0;
  double work_p95 = 0;                 ///< Processor time of the thread alone: what a busy machine does not add to.
};

/// A latency that must stay below a limit; has no peer.
struct Budget {
  std::string name;
  double limit_s = 0;
  std::function<Latency()> measure;    ///< Runs the whole measurement once.
  bool of_median = false;              ///< The median is limited, not the 95th percentile.
};

struct Outcome {
  std::string name, peer;
  double ours_s = 0, peer_s = 0, ratio = 0, gate = 0, moonshot = 0;   ///< peer_s is the limit for a budget.
  Accuracy accuracy;
  bool passed = false;
  std::string unit = {};               ///< Of ours_s and peer_s where they are no seconds.
};

/// Medians of `repetitions` interleaved runs by Google Benchmark.
std::vector<Outcome> runContests(const std::vector<Contest>& contests, int repetitions);
/// The run with the middle wall time of three.  Wall time is judged, so run it on a machine that is idle otherwise.
Outcome runBudget(const Budget& budget);

void printTable(const std::vector<Outcome>& outcomes, std::ostream& out);
/// {"benchmarks": [{name, ours_s, peer, peer_s, ratio, gate, moonshot, accuracy, passed}]}, as the verb `bench`.
std::string toJson(const std::vector<Outcome>& outcomes);

/// Processor time of this thread [s].
double workSeconds();
/// Of times taken one by one; zeros when there are none.
Latency latencyOf(std::vector<double> wall_s, std::vector<double> work_s);

/// The contests of each room.  Empty where they cannot run here; `skipped` then says why, by name.
std::vector<Contest> stereoContests();
#ifdef LONGARM_WITH_KDL
std::vector<Contest> robotContests();
#endif
std::vector<Contest> motionContests();
std::vector<Budget> stereoBudgets();
std::vector<Budget> reachBudgets();
std::vector<Budget> cancelBudgets();
std::vector<Contest> calibrationContests(std::map<std::string, std::string>* skipped);
std::vector<Contest> poseContests(std::map<std::string, std::string>* skipped);
std::vector<Contest> paneContests(std::map<std::string, std::string>* skipped);
std::vector<Budget> paneBudgets(std::map<std::string, std::string>* skipped);
std::vector<Budget> sceneBudgets(std::map<std::string, std::string>* skipped);

}  // namespace longarm::benchmarks
