// Zoom tables: the report's own, its quirks and faults, interpolation, leave-one-out, fitting.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include <unistd.h>

#include "calibration/zoom/zoom_fit.h"
#include "calibration/zoom/zoom_join.h"
#include "calibration/zoom/zoom_quality.h"
#include "core/text.h"
#include "tests/calibration/synthetic.h"
#include "tests/support/report_zoom_file.h"
#include "vision/camera/zoom_doubt.h"

namespace longarm::tests {
namespace {

using vision::ZoomCamera;
using vision::ZoomNode;

vision::ZoomFile report() {
  auto file = vision::parseZoomFile(kReportZoomFile);
  EXPECT_TRUE(file.ok());
  return *file;
}

ZoomCamera measuredOnly() {
  ZoomCamera camera = report().cameras.front();
  camera.nodes.resize(6);
  return camera;
}

std::string edited(const std::string& from, const std::string& to) {
  std::string text = kReportZoomFile;
  return text.replace(text.find(from), from.size(), to);
}

TEST(ZoomTable, TheReportsFileReadsExactly) {
  const auto file = report();
  ASSERT_EQ(file.cameras.size(), 1u);
  const auto& camera = file.cameras.front();
  EXPECT_EQ(camera.name, "zcam");
  ASSERT_EQ(camera.nodes.size(), 8u);
  const double zooms[8] = {0, 0.025, 0.05, 0.1, 0.15, 0.3, 0.4, 1};
  for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(camera.nodes[k].zoom, zooms[k]);
  EXPECT_EQ(camera.nodes[0].interior, (std::array<double, 9>{740.09, 741.60, -4.58, 344.25, 212.84, 0, 0, 0, 0}));
  EXPECT_EQ(camera.nodes[5].interior, (std::array<double, 9>{2314.0, 2319.32, -15.74, 321.77, 139.95, 0, 0, 0, 0}));
  EXPECT_EQ(camera.nodes[5].exterior, (std::array<double, 6>{-0.002, 0.042, 0.019, 0.001, 0.003, 0.034}));
  for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(vision::isNominal(camera.nodes[k]), k >= 6) << k;
  EXPECT_EQ(file.warnings.size(), 2u) << "the two nominal nodes";
}

TEST(ZoomTable, WritingIsStableAndLosesNothing) {
  const auto file = report();
  const std::string once = vision::zoomFileText(file);
  const auto again = vision::parseZoomFile(once);
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(vision::zoomFileText(*again), once);
  EXPECT_EQ(again->headers, file.headers);
  ASSERT_EQ(again->cameras.front().nodes.size(), 8u);
  for (std::size_t k = 0; k < 8; ++k) {
    EXPECT_EQ(again->cameras.front().nodes[k].interior, file.cameras.front().nodes[k].interior);
    EXPECT_EQ(again->cameras.front().nodes[k].exterior, file.cameras.front().nodes[k].exterior);
  }
}

TEST(ZoomTable, QuirksAreAcceptedAndTold) {
  const auto seven = vision::parseZoomFile(edited("344.25 212.84 0. 0. 0. 0.}", "344.25 212.84 0.1 -0.2}"));
  ASSERT_TRUE(seven.ok()) << seven.error().message;
  EXPECT_EQ(seven->cameras[0].nodes[0].interior[6], -0.2);
  EXPECT_EQ(seven->cameras[0].nodes[0].interior[7], 0);
  EXPECT_NE(seven->warnings.front().find("seven"), std::string::npos);
  const auto unsorted = vision::parseZoomFile(edited("<SR_zoom> 0.4 ", "<SR_zoom> 0.01 "));
  ASSERT_TRUE(unsorted.ok()) << unsorted.error().message;
  EXPECT_EQ(unsorted->cameras[0].nodes[6].zoom, 0.01) << "the file's order is kept";
  bool told = false;
  for (const auto& w : unsorted->warnings) told = told || w.find("order") != std::string::npos;
  EXPECT_TRUE(told);
  EXPECT_TRUE(vision::zoomAt(unsorted->cameras[0], 0.02).ok());
}

TEST(ZoomTable, FaultsAreRefusedWithPlaceAndFix) {
  const auto refusal = [](const std::string& text) {
    const auto file = vision::parseZoomFile(text);
    return file.ok() ? std::string("accepted") : file.error().message;
  };
  const struct {
    const char *from, *to, *word;
  } cases[] = {{"{740.09", "740.09", "opening brace"},
               {"0. 0. 0. 0.} </SR_cam_int> <SR_cam_ext> {-0.004 0.041", "0. 0. 0. 0. </SR_cam_int> <SR_cam_ext> {-0.004 0.041", "closing brace"},
               {"740.09", "740,09", "740.09, not 740,09"},
               {"0.025", "0.05", "given twice"},
               {"740.09", "-740.09", "not positive"},
               {"740.09", "abc", "abc"},
               {"740.09", "inf", "finite"},
               {"<SR_zoom> 1.0", "<SR_zoom> 1.2", "1.2"},
               {"-0.004 0.041 0.006 ", "", "expected 6"},
               {"740.09 741.60 ", "740.09 ", "expected 9"},
               {"</SR_cam_int>", "", "broken XML"},
               {"</SR_world>", "", "broken XML"}};
  for (const auto& c : cases) {
    const std::string message = refusal(edited(c.from, c.to));
    EXPECT_NE(message.find(c.word), std::string::npos) << c.from << " -> " << c.to << ": " << message;
  }
}

TEST(ZoomTable, NodesAreMetExactlyAndTheFocalLengthGrows) {
  const auto camera = report().cameras.front();
  for (const auto& node : camera.nodes) {
    const auto at = vision::zoomAt(camera, node.zoom);
    ASSERT_TRUE(at.ok());
    EXPECT_EQ(at->interior, node.interior);
    EXPECT_EQ(at->exterior, node.exterior);
  }
  double before = 0;
  for (int i = 0; i <= 1000; ++i) {
    const auto at = vision::zoomAt(camera, i / 1000.0);
    ASSERT_TRUE(at.ok());
    EXPECT_GT(at->interior[0], before) << i;
    before = at->interior[0];
  }
  EXPECT_FALSE(vision::zoomAt(measuredOnly(), 0.31).ok()) << "outside the nodes";
}

double rmsOf(const std::vector<calibration::ZoomMiss>& misses) {
  double sum = 0;
  for (const auto& m : misses) sum += m.focal_error * m.focal_error;
  return std::sqrt(sum / static_cast<double>(misses.size()));
}

TEST(ZoomQuality, LeaveOneOutHasTheFiguresOfTheTable) {
  const auto all = calibration::leaveOneOut(report().cameras.front());
  ASSERT_EQ(all.size(), 6u);
  EXPECT_NEAR(100 * rmsOf(all), 1.07, 0.01);
  EXPECT_NEAR(100 * rmsOf(calibration::leaveOneOut(measuredOnly())), 0.91, 0.01);
  double u = 0, v = 0;
  const auto measured = calibration::leaveOneOut(measuredOnly());
  for (const auto& m : measured) {
    u += m.boresight_px.x() * m.boresight_px.x() / 4;
    v += m.boresight_px.y() * m.boresight_px.y() / 4;
  }
  EXPECT_NEAR(std::sqrt(u), 2.7, 0.1);
  EXPECT_NEAR(std::sqrt(v), 2.7, 0.1);
}

TEST(ZoomQuality, TheBoresightLawHasTheFiguresOfTheTable) {
  const auto law = calibration::boresightLaw(report().cameras.front());
  EXPECT_EQ(law.nodes, 6) << "nominal nodes are left out";
  EXPECT_NEAR(law.principal_point.x(), 344.2, 0.1);
  EXPECT_NEAR(law.principal_point.y(), 239.0, 0.1);
  EXPECT_NEAR(law.slope.x(), -0.0069, 0.00005);
  EXPECT_NEAR(law.slope.y(), -0.0438, 0.00005);
  EXPECT_NEAR(law.residual_px.x(), 2.1, 0.1);
  EXPECT_NEAR(law.residual_px.y(), 1.3, 0.1);
}

TEST(ZoomQuality, TurnAndPrincipalPointThatTradeOffDoNoHarm) {
  Random random(81);
  ZoomCamera camera{"synthetic", {}};
  for (int k = 0; k < 7; ++k) {
    ZoomNode node;
    node.zoom = 0.1 * k;
    const double f = 740 * std::pow(40.0, node.zoom), theta = random.normal(0.02);
    // A turn about y moves the boresight by f tan(theta); the principal point makes up for it.
    node.interior = {f, f, 0, 320 - f * std::tan(theta), 240.5, 0, 0, 0, 0};
    node.exterior = {0, 0, 0, 0, theta, 0};
    camera.nodes.push_back(node);
  }
  for (double zoom = 0.01; zoom < 0.6; zoom += 0.007) {
    const auto at = vision::zoomAt(camera, zoom);
    ASSERT_TRUE(at.ok());
    EXPECT_LT((vision::boresightOf(*at) - Eigen::Vector2d(320, 240.5)).norm(), 1e-9);
  }
}

// A lens of eight settings whose principal point wanders by 2 px, each calibrated by itself: the narrower, the less sure.
struct NoisyLens {
  std::vector<calibration::ZoomLens> truth, measured;
};

NoisyLens noisyLens(Random* random) {
  NoisyLens out;
  for (int k = 0; k < 8; ++k) {
    calibration::ZoomLens lens;
    const double f = 740 * std::pow(8.0, k / 7.0), wide = f / 740;
    lens.node.zoom = k / 7.0;
    lens.node.interior = {f, 0.999 * f, 0, 322 + random->normal(2), 238 + random->normal(2), -0.2, 0.1, 0, 0};
    out.truth.push_back(lens);
    // Focal lengths and principal point of a real board calibration are correlated.
    Eigen::Matrix4d L = Eigen::Matrix4d::Identity();
    L(0, 0) = L(1, 1) = 0.5 * wide * wide;
    L(1, 0) = 0.4 * wide * wide;
    L(2, 2) = L(3, 3) = 0.6 * wide * wide;
    L(2, 0) = 0.3 * wide * wide;
    L(3, 1) = -0.3 * wide * wide;
    const Eigen::Matrix4d C = L * L.transpose();
    Eigen::Vector4d unit;
    for (int i = 0; i < 4; ++i) unit[i] = random->normal(1);
    const Eigen::Vector4d error = L * unit;
    const int index[] = {calibration::kFx, calibration::kFy, calibration::kCx, calibration::kCy};
    for (int i = 0; i < 4; ++i) {
      lens.node.interior[static_cast<std::size_t>(index[i])] += error[i];
      for (int j = 0; j < 4; ++j) lens.covariance(index[i], index[j]) = C(i, j);
    }
    out.measured.push_back(lens);
  }
  return out;
}

TEST(ZoomJoin, TheOtherSettingsSayWhereThePrincipalPointOfANarrowOneIs) {
  Random random(17);
  double alone = 0, together = 0, focal_alone = 0, focal_together = 0, nees = 0;
  const int runs = 400;
  for (int run = 0; run < runs; ++run) {
    const NoisyLens lens = noisyLens(&random);
    const auto joined = calibration::joinZoom(lens.measured);
    const auto off = [&](const calibration::ZoomLens& l, std::size_t i) { return l.node.interior[i] - lens.truth.back().node.interior[i]; };
    const auto& before = lens.measured.back();
    const auto& after = joined.lenses.back();
    alone += std::pow(off(before, 3), 2) / runs;
    together += std::pow(off(after, 3), 2) / runs;
    focal_alone += std::pow(off(before, 0), 2) / runs;
    focal_together += std::pow(off(after, 0), 2) / runs;
    nees += std::pow(off(after, 3), 2) / after.covariance(3, 3) / runs;
  }
  EXPECT_GT(std::sqrt(alone), 30) << "the board hardly says it";
  EXPECT_LT(std::sqrt(together), 3.2);
  EXPECT_LT(focal_together, 0.95 * focal_alone) << "what is correlated gains with it";
  EXPECT_GT(nees, 0.35) << "wander is taken as 3 px and was 2";
  EXPECT_LT(nees, 1.1);
}

TEST(ZoomJoin, WhatIsKnownStaysAndWhatIsOddIsTold) {
  Random random(4);
  auto lens = noisyLens(&random);
  auto certain = lens.truth;
  for (auto& l : certain) l.covariance.setZero();
  const auto same = calibration::joinZoom(certain);
  for (std::size_t k = 0; k < certain.size(); ++k) EXPECT_EQ(same.lenses[k].node.interior, certain[k].node.interior);
  EXPECT_TRUE(same.warnings.empty());
  lens.measured[0].node.interior[3] += 60;                 // wide, so that its own board is sure of it
  const auto joined = calibration::joinZoom(lens.measured);
  ASSERT_FALSE(joined.warnings.empty());
  EXPECT_NE(joined.warnings.front().find("zoom 0:"), std::string::npos) << joined.warnings.front();
  EXPECT_EQ(calibration::joinZoom({lens.measured[0]}).lenses[0].node.interior, lens.measured[0].node.interior) << "nothing to join";
}

TEST(ZoomDoubt, IsWhatNoisySettingsAreWrong) {
  Random random(23);
  double focal = 0, boresight = 0;
  const int runs = 500;
  for (int run = 0; run < runs; ++run) {
    ZoomCamera truth{"true", {}}, table{"noisy", {}};
    for (int k = 0; k < 9; ++k) {
      ZoomNode node;
      node.zoom = k / 8.0;
      const double f = 740 * std::pow(8.0, node.zoom);
      node.interior = {f, f, 0, 321.5, 238.5, -0.2, 0.1, 0, 0};
      truth.nodes.push_back(node);
      const double scale = 1 + random.normal(0.004);
      node.interior[0] *= scale;
      node.interior[1] *= scale;
      node.interior[3] += random.normal(1.5) * f / 740;    // a turn of the axis: magnified as everything else
      table.nodes.push_back(node);
    }
    const double zoom = 0.43;
    const auto at = vision::zoomAt(table, zoom);
    ASSERT_TRUE(at.ok());
    const auto C = vision::lensDoubt(vision::predictFromOthers(table), *at);
    ASSERT_TRUE(C.has_value());
    const double f = 740 * std::pow(8.0, zoom);
    focal += std::pow(at->interior[0] - f, 2) / (*C)(0, 0) / runs;
    boresight += std::pow(at->interior[3] - 321.5, 2) / (*C)(3, 3) / runs;
    EXPECT_NEAR((*C)(0, 1) / std::sqrt((*C)(0, 0) * (*C)(1, 1)), 1, 1e-9) << "both focal lengths grow together";
  }
  // Between settings the error is smaller than at them; a variance from three misses varies by itself.
  EXPECT_GT(focal, 0.4);
  EXPECT_LT(focal, 3);
  EXPECT_GT(boresight, 0.4);
  EXPECT_LT(boresight, 3);
}

TEST(ZoomDoubt, NeedsThreeSettingsAndLeavesNominalOnesOut) {
  auto camera = measuredOnly();
  camera.nodes.resize(2);
  EXPECT_FALSE(vision::lensDoubt(vision::predictFromOthers(camera), camera.nodes[0]).has_value());
  const auto whole = report().cameras.front();
  const auto all = vision::predictFromOthers(whole);
  const auto doubt = vision::lensDoubt(all, whole.nodes.back());
  ASSERT_TRUE(doubt.has_value());
  EXPECT_LT(std::sqrt((*doubt)(0, 0)) / whole.nodes.back().interior[0], 0.02) << "a nominal node in the middle would say more";
}

// A folder of its own for one test.
std::string folder(const std::string& name) {
  const std::string path = testing::TempDir() + "zoom_" + std::to_string(::getpid()) + "_" + name;
  std::filesystem::remove_all(path);
  std::filesystem::create_directories(path);
  return path;
}

TEST(ZoomFit, CameraFilesBecomeATableThatReadsBack) {
  const std::string where = folder("fit");
  const auto source = measuredOnly();
  for (const auto& node : source.nodes) {
    const auto file = vision::cameraFileOf(source, node);
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(vision::writeCameraFile(where + "/zcam_" + formatNumber(node.zoom) + ".yaml", *file).ok());
  }
  const auto fit = calibration::fitZoom(where);
  ASSERT_TRUE(fit.ok()) << fit.error().message;
  ASSERT_EQ(fit->camera.nodes.size(), 6u);
  for (std::size_t k = 0; k < 6; ++k) {
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(fit->camera.nodes[k].interior[i], source.nodes[k].interior[i], 1e-12);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(fit->camera.nodes[k].exterior[i], source.nodes[k].exterior[i], 1e-12);
  }
}

TEST(ZoomFit, AThirdRadialTermIsRefittedOrRefused) {
  const std::string where = folder("k3");
  auto camera = cameraOf(700, 700, 320, 240);
  camera.distortion = {-0.2, 0.05, 0.001, 0, 0.01};
  ASSERT_TRUE(vision::writeCameraFile(where + "/a_0.1.yaml", {camera, {}, {}}).ok());
  ASSERT_TRUE(vision::writeCameraFile(where + "/a_0.5.yaml", {cameraOf(1400, 1400, 320, 240), {}, {}}).ok());
  const auto fit = calibration::fitZoom(where);
  ASSERT_TRUE(fit.ok()) << fit.error().message;
  EXPECT_GT(fit->sources[0].refit_px, 0);
  EXPECT_LT(fit->sources[0].refit_px, 0.2);
  camera = cameraOf(400, 400, 320, 240);
  camera.distortion = {-0.3, 0.3, 0.001, 0, -0.25};
  ASSERT_TRUE(vision::writeCameraFile(where + "/a_0.1.yaml", {camera, {}, {}}).ok());
  const auto refused = calibration::fitZoom(where);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("k3"), std::string::npos) << refused.error().message;
}

TEST(ZoomFit, NamesWithoutASettingAndEmptyFoldersAreRefused) {
  const std::string where = folder("names");
  EXPECT_NE(calibration::fitZoom(where).error().message.find("at least 2"), std::string::npos);
  ASSERT_TRUE(vision::writeCameraFile(where + "/wide.yaml", {cameraOf(700, 700, 320, 240), {}, {}}).ok());
  EXPECT_NE(calibration::fitZoom(where).error().message.find("wide.yaml"), std::string::npos);
  EXPECT_EQ(calibration::fitZoom(where + "/none").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace longarm::tests
