// How long planning goes on after it was cancelled.
#include <pthread.h>
#include <time.h>

#include <atomic>
#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "planning/macros/macro.h"
#include "planning/motion/random.h"
#include "tests/benchmarks/gate.h"
#include "tests/planning/macro_scene.h"

namespace longarm::benchmarks {
namespace {

using Clock = std::chrono::steady_clock;
using Eigen::Vector3d;

constexpr double kLimit_s = 0.1;
constexpr std::size_t kCancelled = 50;

struct Job {
  std::string macro;
  std::optional<vision::Feature> feature;
  std::map<std::string, double> arguments = {};
};

// Long ones, ones that have to go round much, and ones that look for advice because they cannot be done.
std::vector<Job> jobs() {
  const auto plane = tests::featureOf(vision::FeatureKind::kPlane, {{0.85, -0.25, 0.30}, {0.85, 0.25, 0.30}, {0.85, 0.25, 0.70}});
  const auto box = [](double x) { return tests::featureOf(vision::FeatureKind::kTriad, {{x, -0.1, 0.35}, {x, 0.1, 0.35}, {x + 0.15, -0.1, 0.35}, {x, -0.1, 0.55}}); };
  const auto line = tests::featureOf(vision::FeatureKind::kLine, {{0.75, -0.2, 0.45}, {0.75, 0.2, 0.45}});
  const auto away = tests::featureOf(vision::FeatureKind::kPoint, {{1.6, 0.3, 0.5}});
  return {{"surface_scan", plane, {{"swath", 0.03}}}, {"scan_faces", box(0.70), {{"swath", 0.04}}}, {"look_around", box(0.75), {{"views", 16}}},
          {"grab_pipe", line},                        {"touch", away},                              {"look_around", box(1.5), {{"views", 16}}},
          {"move_to", {}, {{"x", 2.0}}},              {"move_to", {}, {{"x", 0.6}, {"y", 0.45}, {"z", 0.7}}}};
}

// The campaign's clutter of all three scenes at once, the arm's work between posts, table and shelf.
std::vector<planning::WorldObject> everything() {
  std::vector<planning::WorldObject> all = tests::clutter(0);
  for (const auto& object : tests::clutter(1)) {
    if (object.name != "floor") all.push_back(object);
  }
  for (const auto& object : tests::clutter(2)) {
    if (object.name != "floor") all.push_back(object);
  }
  return all;
}

double secondsSince(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

class Cancelling {
 public:
  Cancelling() : m_cell(planning::loadBuiltInWorkcell().value()), m_macros(planning::makeMacros(m_cell)), m_objects(everything()) {}

  // Cancels each of the jobs in turn at an instant drawn evenly from the time that it takes when it is left alone.
  Latency measure() {
    planning::Random random(11);
    const std::vector<Job> all = jobs();
    std::vector<double> whole;
    for (const Job& job : all) {
      const auto begin = Clock::now();
      plan(job, {});
      whole.push_back(secondsSince(begin));
    }
    std::vector<double> wall, work;
    for (std::size_t i = 0; wall.size() < kCancelled && i < 20 * kCancelled; ++i) cancelOnce(all[i % all.size()], random.unit() * whole[i % all.size()], &wall, &work);
    return latencyOf(wall, work);
  }

 private:
  planning::Plan plan(const Job& job, const CancelToken& cancel) const {
    planning::PlanContext context = tests::contextOf(m_cell, "ready");
    context.objects = m_objects;
    context.arguments = job.arguments;
    context.cancel = cancel;
    return planning::findMacro(m_macros, job.macro)->plan(context, job.feature ? &*job.feature : nullptr);
  }

  // Nothing is added when the plan was there first.
  void cancelOnce(const Job& job, double after_s, std::vector<double>* wall, std::vector<double>* work) const {
    CancelToken cancel;
    clockid_t planner{};
    ::pthread_getcpuclockid(::pthread_self(), &planner);
    std::atomic<bool> done{false};
    bool in_time = false;
    Clock::time_point cancelled;
    timespec work_then{};
    std::thread other([&] {
      std::this_thread::sleep_for(std::chrono::duration<double>(after_s));
      in_time = !done;
      cancelled = Clock::now();
      ::clock_gettime(planner, &work_then);
      cancel.cancel();
    });
    plan(job, cancel);
    const auto returned = Clock::now();
    const double work_now = workSeconds();
    done = true;
    other.join();
    if (!in_time || returned < cancelled) return;
    wall->push_back(std::chrono::duration<double>(returned - cancelled).count());
    work->push_back(work_now - (static_cast<double>(work_then.tv_sec) + 1e-9 * static_cast<double>(work_then.tv_nsec)));
  }

  planning::Workcell m_cell;
  std::vector<std::unique_ptr<planning::Macro>> m_macros;
  std::vector<planning::WorldObject> m_objects;
};

}  // namespace

std::vector<Budget> cancelBudgets() {
  return {{"cancel_planning", kLimit_s, [] { return Cancelling().measure(); }}};
}

}  // namespace longarm::benchmarks
