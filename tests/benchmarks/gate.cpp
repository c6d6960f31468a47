#include "tests/benchmarks/gate.h"

#include <algorithm>
#include <ctime>
#include <iomanip>
#include <ostream>
#include <tuple>

#include <benchmark/benchmark.h>
#include <nlohmann/json.hpp>

#include "core/text.h"

namespace longarm::benchmarks {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

// Keeps the seconds of every repetition by the name of its function.
class Collector : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.iterations == 0) continue;
      const auto iterations = static_cast<double>(run.iterations);
      cpu[run.run_name.function_name].push_back(run.cpu_accumulated_time / iterations);
      real[run.run_name.function_name].push_back(run.real_accumulated_time / iterations);
    }
  }
  std::map<std::string, std::vector<double>> cpu, real;
};

void add(const std::string& name, const std::function<void()>& work, const Contest& contest, int repetitions) {
  auto* registered = benchmark::RegisterBenchmark(name.c_str(), [work](benchmark::State& state) {
    for (auto _ : state) work();
  });
  registered->Repetitions(repetitions)->MinTime(contest.real_time ? 0.2 : 0.1);
  if (contest.real_time) registered->UseRealTime();
}

std::string seconds(double s) {
  if (s < 1e-6) return formatFixed(s * 1e9, 1) + " ns";
  return s < 1e-3 ? formatFixed(s * 1e6, 2) + " us" : formatFixed(s * 1e3, 2) + " ms";
}

}  // namespace

double workSeconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Latency latencyOf(std::vector<double> wall_s, std::vector<double> work_s) {
  if (wall_s.empty() || work_s.empty()) return {};
  std::sort(wall_s.begin(), wall_s.end());
  std::sort(work_s.begin(), work_s.end());
  const std::size_t late = 95 * wall_s.size() / 100;
  return {wall_s[late], wall_s[wall_s.size() / 2], work_s[95 * work_s.size() / 100]};
}

std::vector<Outcome> runContests(const std::vector<Contest>& contests, int repetitions) {
  benchmark::ClearRegisteredBenchmarks();
  for (const auto& contest : contests) {
    if (contest.figures) continue;
    add(contest.name + ":ours", contest.ours, contest, repetitions);
    add(contest.name + ":peer", contest.theirs, contest, repetitions);
  }
  Collector collector;
  benchmark::RunSpecifiedBenchmarks(&collector);
  std::vector<Outcome> outcomes;
  for (const auto& contest : contests) {
    const auto& times = contest.real_time ? collector.real : collector.cpu;
    const auto secondsOf = [&](const char* side) {
      const auto found = times.find(contest.name + side);
      return found == times.end() ? 0 : median(found->second);
    };
    Outcome outcome{contest.name, contest.peer, secondsOf(":ours"), secondsOf(":peer"), 0, contest.gate,
                    contest.moonshot, contest.accuracy ? contest.accuracy() : Accuracy{true, ""}, false, {}};
    if (contest.figures) {
      std::tie(outcome.ours_s, outcome.peer_s) = contest.figures();
      outcome.unit = contest.unit.empty() ? " " : contest.unit;
    }
    if (outcome.ours_s > 0) outcome.ratio = outcome.peer_s / outcome.ours_s;
    outcome.passed = outcome.ratio >= outcome.gate && outcome.accuracy.holds;
    outcomes.push_back(outcome);
  }
  return outcomes;
}

Outcome runBudget(const Budget& budget) {
  std::vector<Latency> runs = {budget.measure(), budget.measure(), budget.measure()};
  std::sort(runs.begin(), runs.end(), [](const Latency& a, const Latency& b) { return a.wall_p95 < b.wall_p95; });
  const Latency& l = runs[1];
  const double judged = budget.of_median ? l.wall_median : l.wall_p95;
  const std::string text = budget.of_median ? "median of wall time; p95 " + seconds(l.wall_p95)
                                            : "p95 of wall time; median " + seconds(l.wall_median);
  Outcome outcome{budget.name, "limit", judged, budget.limit_s, judged > 0 ? budget.limit_s / judged : 0, 1, 1,
                  {true, text + ", p95 of the thread's own work " + seconds(l.work_p95)},
                  false};
  outcome.passed = judged > 0 && judged <= budget.limit_s;
  return outcome;
}

namespace {

std::string amount(const Outcome& outcome, double value) {
  return outcome.unit.empty() ? seconds(value) : formatFixed(value, 2) + " " + outcome.unit;
}

}  // namespace

void printTable(const std::vector<Outcome>& outcomes, std::ostream& out) {
  out << std::left << std::setw(18) << "name" << std::setw(12) << "ours" << std::setw(12) << "peer" << std::setw(9)
      << "ratio" << std::setw(8) << "gate" << std::setw(10) << "moonshot" << std::setw(8) << "" << "accuracy\n";
  for (const auto& o : outcomes) {
    out << std::setw(18) << o.name << std::setw(12) << amount(o, o.ours_s) << std::setw(12) << amount(o, o.peer_s)
        << std::setw(9) << formatFixed(o.ratio, 1) << std::setw(8) << formatNumber(o.gate) << std::setw(10)
        << formatNumber(o.moonshot) << std::setw(8) << (o.passed ? "passed" : "FAILED") << o.accuracy.text << "; peer: "
        << o.peer << "\n";
  }
}

std::string toJson(const std::vector<Outcome>& outcomes) {
  nlohmann::json list = nlohmann::json::array();
  for (const auto& o : outcomes) {
    list.push_back({{"name", o.name}, {"ours_s", o.ours_s}, {"peer", o.peer}, {"peer_s", o.peer_s}, {"ratio", o.ratio},
                    {"gate", o.gate}, {"moonshot", o.moonshot}, {"accuracy", o.accuracy.text}, {"passed", o.passed}});
  }
  return nlohmann::json{{"benchmarks", list}}.dump(2);
}

}  // namespace longarm::benchmarks
