// Damaged files: every reader ends with a value that can be used or a sentence, never a crash or a hang.
#include <cstdio>
#include <fstream>

#include <unistd.h>

#include <gtest/gtest.h>

#include "calibration/fixture/calibrate_fixture.h"
#include "calibration/fixture/fixture_file.h"
#include "calibration/intrinsics/calibrate_intrinsics.h"
#include "calibration/intrinsics/corners_file.h"
#include "calibration/pose/observations_file.h"
#include "calibration/pose/solve_loop.h"
#include "calibration/zoom/zoom_quality.h"
#include "core/text.h"
#include "tests/calibration/synthetic.h"
#include "tests/support/fuzz.h"
#include "tests/support/report_zoom_file.h"

namespace longarm::tests {
namespace {

constexpr std::uint64_t kSeeds = 250;

template <typename T>
void expectSentence(const Result<T>& result) {
  if (!result.ok()) {
    EXPECT_GT(result.error().message.size(), 10u);
  }
}

std::string fixtureText() {
  std::string csv = "x,y,z,u,v\n";
  const auto view = picture(cameraOf(800, 805, 320, 240), poseOf({0.15, -0.2, 0.05}, {0.02, -0.03, 1.2}), slidingPanel());
  for (std::size_t i = 0; i < view.corners.size(); i += 5) {
    const auto& c = view.corners[i];
    csv += formatNumber(c.xyz.x()) + "," + formatNumber(c.xyz.y()) + "," + formatNumber(c.xyz.z()) + "," + formatFixed(c.pixel.x(), 3) + "," + formatFixed(c.pixel.y(), 3) + "\n";
  }
  return csv;
}

TEST(DamagedFiles, ZoomTables) {
  for (std::uint64_t seed = 0; seed < 4 * kSeeds; ++seed) {
    const auto file = vision::parseZoomFile(mutate(kReportZoomFile, seed));
    expectSentence(file);
    if (!file.ok()) continue;
    for (const auto& camera : file->cameras) {
      calibration::leaveOneOut(camera);
      calibration::boresightLaw(camera);
      expectSentence(vision::zoomAt(camera, 0.33));
    }
    EXPECT_TRUE(vision::parseZoomFile(vision::zoomFileText(*file)).ok()) << seed;
  }
}

TEST(DamagedFiles, Fixtures) {
  const std::pair<const char*, const char*> good[] = {
      {"f.csv", "name,x,y,z\na,0,0,0\nb,1,0,0\nc,0,1,0\nd,0,0,1\ne,1,1,0\nf,1,0,1\n"},
      {"f.yaml", "points: [[0,0,0],[1,0,0],[0,1,0],{name: top, xyz: [0,0,1]},[1,1,0],[1,0,1]]\npanel: {columns: 4, rows: 3, pitch: 0.3, depths: [2, 3]}\n"}};
  for (const auto& [file, text] : good) {
    ASSERT_TRUE(calibration::parseFixture(text, file).ok());
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) expectSentence(calibration::parseFixture(mutate(text, seed), file));
  }
}

TEST(DamagedFiles, FixturePoints) {
  const std::string good = fixtureText();
  ASSERT_TRUE(calibration::parseFixturePoints(good, "p.csv").ok());
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const auto points = calibration::parseFixturePoints(mutate(good, seed), "p.csv");
    expectSentence(points);
    if (!points.ok()) continue;
    const auto found = calibration::calibrateFixture(*points, 0, 0);
    expectSentence(found);
    EXPECT_TRUE(!found.ok() || (std::isfinite(found->camera.fx) && std::isfinite(found->rms_px))) << seed;
  }
}

TEST(DamagedFiles, Corners) {
  Random random(5);
  std::string good = "view,x,y,z,u,v\n";
  for (int k = 0; k < 4; ++k) {
    for (const auto& c : picture(cameraOf(500, 500, 320, 240), boardPose(&random), board(4, 3, 0.08)).corners) {
      good += "v" + std::to_string(k) + "," + formatNumber(c.xyz.x()) + "," + formatNumber(c.xyz.y()) + ",0," + formatFixed(c.pixel.x(), 2) + "," + formatFixed(c.pixel.y(), 2) + "\n";
    }
  }
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const auto views = calibration::parseCorners(mutate(good, seed), "c.csv");
    expectSentence(views);
    if (!views.ok()) continue;
    calibration::IntrinsicsOptions options;
    options.robust = seed % 2 == 0;
    const auto found = calibration::calibrateIntrinsics(*views, 0, 0, options);
    expectSentence(found);
    EXPECT_TRUE(!found.ok() || (std::isfinite(found->camera.fx) && std::isfinite(found->rms_px))) << seed;
  }
}

TEST(DamagedFiles, Observations) {
  std::string good = R"({"camera": {"camera_matrix": {"rows": 3, "cols": 3, "data": [800, 0, 320, 0, 800, 240, 0, 0, 1]}}, "sigma_px": 0.5,
 "T_dev": {"parent": "d", "xyz": [0, 0, 1], "quaternion_xyzw": [0, 0, 0, 1]}, "T_obj": {"parent": "o", "xyz": [0, 0, 0], "quaternion_xyzw": [0, 0, 0, 1]},
 "views": [{"name": "a", "T_kin": {"parent": "k", "xyz": [0, 0, 0], "quaternion_xyzw": [0, 0, 0, 1]}, "points": [
 {"xyz": [0.1, 0.2, 1], "u": 360, "v": 320}, {"xyz": [-0.1, 0.2, 1.5], "u": 288, "v": 304}, {"xyz": [0.1, -0.2, 1.2], "u": 356, "v": 167},
 {"xyz": [-0.3, 0.1, 2], "u": 240, "v": 267}, {"xyz": [0.2, 0.1, 1], "u": 400, "v": 280}, {"xyz": [0.3, -0.3, 2], "u": 400, "v": 160}]}]})";
  const std::string path = testing::TempDir() + "observations_" + std::to_string(::getpid()) + ".json";
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    std::ofstream(path, std::ios::binary) << (seed == 0 ? good : mutate(good, seed));
    const auto file = calibration::readObservations(path, {calibration::LoopUnknown::kExt});
    expectSentence(file);
    ASSERT_TRUE(seed > 0 || file.ok()) << file.error().message;
    if (!file.ok()) continue;
    calibration::LoopOptions options;
    options.unknowns = {calibration::LoopUnknown::kExt};
    options.starts = file->given;
    options.sigma_px = file->sigma_px;
    const auto found = calibration::solveLoop(file->problem, options);
    expectSentence(found);
    EXPECT_TRUE(!found.ok() || found->T[0].matrix().allFinite()) << seed;
  }
  std::remove(path.c_str());
}

}  // namespace
}  // namespace longarm::tests
