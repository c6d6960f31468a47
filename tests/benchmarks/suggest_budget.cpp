// How long a suggested match takes.
#include <chrono>
#include <memory>

#include "tests/benchmarks/gate.h"
#include "tests/vision/painted_wall.h"
#include "vision/match/suggest.h"

namespace longarm::benchmarks {
namespace {

constexpr double kLimit_s = 0.05;
constexpr int kPicks = 60;

// Two 640 x 480 pictures through real lenses.
struct Scene {
  tests::StereoRig rig;
  vision::MatchPicture left, right;

  static std::shared_ptr<Scene> make() {
    const tests::StereoRig rig;
    const auto wall = tests::PaintedWall::textured(3);
    tests::Dice dice(5);
    auto left = vision::MatchPicture::from(wall.seenBy(rig.left, &dice, 1, 0.02));
    auto right = vision::MatchPicture::from(wall.seenBy(rig.right, &dice, 0.7, 0.02));
    return std::make_shared<Scene>(Scene{rig, std::move(left).value(), std::move(right).value()});
  }
};

Latency measure(const Scene& scene) {
  tests::Dice dice(9);
  std::vector<double> wall, work;
  for (int i = 0; i < kPicks; ++i) {
    const Eigen::Vector2d pixel(dice.uniform(60, 580), dice.uniform(60, 420));
    const auto begin = std::chrono::steady_clock::now();
    const double begin_work = workSeconds();
    const auto matches = vision::suggestMatches(scene.rig.left, scene.left, pixel, scene.rig.right, scene.right);
    if (!matches) return {};
    work.push_back(workSeconds() - begin_work);
    wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return latencyOf(wall, work);
}

}  // namespace

std::vector<Budget> stereoBudgets() {
  auto scene = std::make_shared<std::shared_ptr<Scene>>();
  return {{"suggest", kLimit_s, [scene] {
             if (!*scene) *scene = Scene::make();
             return measure(**scene);
           }}};
}

}  // namespace longarm::benchmarks
