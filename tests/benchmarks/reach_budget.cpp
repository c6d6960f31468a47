// Live reach: how long all buttons that a selection shows take to be coloured while the feature is dragged.
#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "planning/macros/macro.h"
#include "planning/world/workcell.h"
#include "tests/benchmarks/gate.h"
#include "tests/planning/macro_scene.h"

namespace longarm::benchmarks {
namespace {

using Eigen::Vector3d;

constexpr double kLimit_s = 0.05;        // 20 times a second
constexpr int kSteps = 80;

std::vector<Vector3d> shapeOf(vision::FeatureKind kind) {
  switch (kind) {
    case vision::FeatureKind::kPoint: return {{0, 0, 0}};
    case vision::FeatureKind::kLine: return {{0, -0.1, 0}, {0, 0.1, 0}};
    case vision::FeatureKind::kPlane: return {{0, -0.12, -0.1}, {0, 0.12, -0.1}, {0, 0.12, 0.1}};
    case vision::FeatureKind::kTriad: return {{0, 0, 0}, {0.08, 0, 0}, {0, 0.1, 0}, {0, 0, 0.07}};
  }
  return {};
}

// Dragged from near the robot to where it no longer reaches, in the clutter of the campaign's second scene.
Latency measure(vision::FeatureKind kind) {
  const auto cell = planning::loadBuiltInWorkcell().value();
  const auto macros = planning::makeMacros(cell);
  std::map<std::string, planning::ReachAnswer> answers;
  std::vector<double> wall, work;
  for (int i = 0; i < kSteps; ++i) {
    std::vector<Vector3d> points = shapeOf(kind);
    for (auto& p : points) p += Vector3d(0.55 + 0.008 * i, -0.2 + 0.005 * i, 0.45);
    const vision::Feature feature = tests::featureOf(kind, points);
    const auto begin = std::chrono::steady_clock::now();
    const double begin_work = workSeconds();
    for (const auto& macro : macros) {
      if (macro->info().takes != kind) continue;
      planning::PlanContext context = tests::contextOf(cell, "ready");
      context.objects = tests::clutter(1);
      auto& answer = answers[macro->info().name];
      answer = macro->reach(context, feature, answer.seed);
    }
    work.push_back(workSeconds() - begin_work);
    wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return latencyOf(wall, work);
}

// From the macro's button to the finished plan that the preview shows, over all macros that the example scenes need.
Latency measurePreview() {
  const auto cell = planning::loadBuiltInWorkcell().value();
  const auto macros = planning::makeMacros(cell);
  std::vector<double> wall, work;
  for (const auto kind : {vision::FeatureKind::kPoint, vision::FeatureKind::kLine, vision::FeatureKind::kPlane, vision::FeatureKind::kTriad}) {
    std::vector<Vector3d> points = shapeOf(kind);
    for (auto& p : points) p += Vector3d(0.75, 0, 0.5);
    const vision::Feature feature = tests::featureOf(kind, points);
    for (const auto& macro : macros) {
      if (macro->info().takes != kind) continue;
      planning::PlanContext context = tests::contextOf(cell, "ready");
      context.objects = tests::clutter(1);
      const auto begin = std::chrono::steady_clock::now();
      const double begin_work = workSeconds();
      if (!macro->plan(context, &feature).ok()) continue;
      work.push_back(workSeconds() - begin_work);
      wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
  }
  return latencyOf(wall, work);
}

}  // namespace

std::vector<Budget> reachBudgets() {
  return {{"live_reach_point", kLimit_s, [] { return measure(vision::FeatureKind::kPoint); }},
          {"live_reach_line", kLimit_s, [] { return measure(vision::FeatureKind::kLine); }},
          {"live_reach_plane", kLimit_s, [] { return measure(vision::FeatureKind::kPlane); }},
          {"live_reach_triad", kLimit_s, [] { return measure(vision::FeatureKind::kTriad); }},
          {"button_to_plan", kLimit_s, [] { return measurePreview(); }, true}};
}

}  // namespace longarm::benchmarks
