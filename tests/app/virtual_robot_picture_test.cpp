#include <chrono>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "app/virtual_robot/camera_rig.h"
#include "app/virtual_robot/picture_effects.h"
#include "app/virtual_robot/picture_maker.h"
#include "app/virtual_robot/render_thread.h"
#include "tests/app/virtual_robot_rig.h"
#include "vision/stereo/triangulate.h"

namespace longarm::virtual_robot {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A magenta bar of known pose in front of the head, and nothing else that is magenta.
planning::Scenario barScenario() {
  auto scenario = emptyScenario();
  planning::ScenarioObject bar;
  bar.body.name = "bar";
  bar.body.shape = planning::Cylinder{0.02, 0.3};
  bar.body.X_WO = poseFromRpy({1.0, 0.38, 0.5}, {0.15, 0.1, 0});   // upright, beside the arm, in both pictures
  bar.body.rgba = {1, 0, 1, 1};
  scenario.objects = {bar};
  scenario.light.intensity = scenario.light.ambient = 2;   // burnt out: the bar is evenly bright
  return scenario;
}

class Studio {
 public:
  explicit Studio(const planning::Scenario& scenario, const std::string& variant = {})
      : m_workcell(builtIn(variant)), m_rig(*CameraRig::load(m_workcell)) {
    auto body = RobotBody::create(m_workcell, scenario, 1);
    EXPECT_TRUE(body.ok());
    m_body = std::move(*body);
    auto maker = PictureMaker::create(m_workcell, m_body->scenario());
    EXPECT_TRUE(maker.ok()) << maker.error().message;
    m_maker = std::move(*maker);
  }
  cv::Mat take(const std::string& camera, double noise = 0) {
    PictureOrder order{camera, m_rig.lens(camera), noise};
    auto picture = m_maker->render(m_body->snapshot(), order);
    EXPECT_TRUE(picture.ok()) << picture.error().message;
    return picture ? *picture : cv::Mat();
  }
  RobotBody& body() { return *m_body; }
  CameraRig& rig() { return m_rig; }
  PictureMaker& maker() { return *m_maker; }

 private:
  const planning::Workcell& m_workcell;
  CameraRig m_rig;
  std::unique_ptr<RobotBody> m_body;
  std::unique_ptr<PictureMaker> m_maker;
};

/// How magenta each pixel is, 0 ... about 255.
cv::Mat magenta(const cv::Mat& picture) {
  std::vector<cv::Mat> bgr;
  cv::split(picture, bgr);
  cv::Mat weakest = cv::min(bgr[0], bgr[2]), out;
  cv::subtract(weakest, bgr[1], out);
  return out;
}

/// The silhouette of the bar as the camera's model projects it: extreme pixels of its surface in each row.
struct Edges {
  double left = 1e9, right = -1e9;
};

std::map<int, Edges> projectedRows(const RobotBody& body, const std::string& camera, const vision::CameraModel& lens) {
  const auto snapshot = body.snapshot();
  const Pose X_CO = snapshot.X_WC.at(camera).inverse() * snapshot.objects.front().X_WO;
  std::map<int, Edges> rows;
  const auto& bar = std::get<planning::Cylinder>(snapshot.objects.front().shape);
  for (int i = 0; i < 6000; ++i) {
    for (int k = 0; k < 96; ++k) {
      const double angle = 2 * M_PI * k / 96;
      const Vector3d p(bar.radius * std::cos(angle), bar.radius * std::sin(angle), bar.length * (i / 5999.0 - 0.5));
      const auto pixel = lens.project(X_CO * p);
      if (!pixel) continue;
      const int row = static_cast<int>(std::lround(pixel->y()));
      if (std::abs(pixel->y() - row) > 0.05) continue;
      rows[row].left = std::min(rows[row].left, pixel->x());
      rows[row].right = std::max(rows[row].right, pixel->x());
    }
  }
  return rows;
}

/// What is not green: 255 on the bar whatever its shade, near 0 on the burnt-out ground.
cv::Mat greenless(const cv::Mat& picture) {
  cv::Mat green;
  cv::extractChannel(picture, green, 1);
  return 255 - green;
}

/// Where a row crosses half of white next to the silhouette that is expected, to a fraction of a pixel.
std::optional<Edges> measuredRow(const cv::Mat& mask, int row, const Edges& wanted) {
  Edges out;
  const int from = static_cast<int>(wanted.left) - 6, to = static_cast<int>(wanted.right) + 6;
  for (int u = std::max(0, from); u < std::min(to, mask.cols - 1); ++u) {
    const double a = mask.at<uchar>(row, u) - 127.5, b = mask.at<uchar>(row, u + 1) - 127.5;
    if (a < 0 && b >= 0 && out.left > 1e8) out.left = u + a / (a - b);
    if (a >= 0 && b < 0) out.right = u + a / (a - b);
  }
  if (out.left > out.right) return {};
  return out;
}

TEST(VirtualPictures, ASilhouetteIsWhereTheCameraModelProjectsIt) {
  Studio studio(barScenario());
  for (const char* camera : {"head_left", "head_right"}) {
    const cv::Mat mask = greenless(studio.take(camera));
    const auto rows = projectedRows(studio.body(), camera, studio.rig().lens(camera));
    ASSERT_GT(rows.size(), 40u) << camera << ": the bar is in view";
    int compared = 0;
    double worst = 0, sum = 0;
    for (const auto& [row, wanted] : rows) {
      const bool inner = row > rows.begin()->first + 12 && row < rows.rbegin()->first - 12;
      if (!inner || row < 2 || row > mask.rows - 3 || wanted.left < 3 || wanted.right > mask.cols - 4) continue;
      const auto got = measuredRow(mask, row, wanted);
      ASSERT_TRUE(got.has_value()) << camera << " row " << row;
      for (const double error : {got->left - wanted.left, got->right - wanted.right}) {
        worst = std::max(worst, std::abs(error));
        sum += error;
        ++compared;
      }
    }
    ASSERT_GT(compared, 40) << camera;
    EXPECT_LT(worst, 1.0) << camera;
    EXPECT_LT(std::abs(sum / compared), 0.25) << camera << ": shifted as a whole";
  }
}

Vector2d centroid(const cv::Mat& mask) {
  const cv::Moments m = cv::moments(mask);
  return {m.m10 / m.m00, m.m01 / m.m00};
}

TEST(VirtualPictures, APairTriangulatesToTheTruth) {
  auto scenario = barScenario();
  scenario.objects[0].body.shape = planning::Sphere{0.02};
  Studio studio(scenario);
  const auto snapshot = studio.body().snapshot();
  std::vector<vision::View> views;
  std::vector<Vector2d> pixels;
  for (const char* camera : {"head_left", "head_right"}) {
    vision::View view;
    view.name = camera;
    view.camera = studio.rig().lens(camera);
    view.X_WC = snapshot.X_WC.at(camera);
    views.push_back(view);
    pixels.push_back(centroid(magenta(studio.take(camera)) > 60));
  }
  const std::vector<vision::Sighting> seen = {{&views[0], pixels[0], 0.5}, {&views[1], pixels[1], 0.5}};
  const auto point = vision::triangulate(seen);
  ASSERT_TRUE(point.ok()) << point.error().message;
  EXPECT_LT((point->xyz - snapshot.objects.front().X_WO.translation()).norm(), 0.004);
}

TEST(VirtualPictures, ShowTheRobotItself) {
  auto scenario = emptyScenario();
  Studio studio(scenario);
  const cv::Mat before = studio.take("head_left");
  moveArm(studio.body(), (Eigen::VectorXd(6) << 0.5, 0, 0, 0, 0, 0).finished(), 1);
  const cv::Mat after = studio.take("head_left");
  cv::Mat change;
  cv::absdiff(before, after, change);
  cv::cvtColor(change, change, cv::COLOR_BGR2GRAY);
  EXPECT_GT(cv::countNonZero(change > 25), 5000) << "the arm moved in the picture";
}

TEST(VirtualPictures, HaveTexturesLightAndNoise) {
  Studio studio(*planning::loadScenario("grab_pipe"));
  const cv::Mat clean = studio.take("head_left"), noisy = studio.take("head_left", 2);
  cv::Scalar mean, spread;
  cv::meanStdDev(clean, mean, spread);
  EXPECT_GT(mean[0], 40);
  EXPECT_LT(mean[0], 220);
  EXPECT_GT(spread[0], 15);
  cv::Mat difference;
  cv::subtract(noisy, clean, difference, cv::noArray(), CV_32F);
  cv::meanStdDev(difference, mean, spread);
  EXPECT_NEAR(spread[1], 2.0, 0.15);
  EXPECT_NEAR(mean[1], 0, 0.1);
}

TEST(VirtualPictures, AreTheSameForTheSameInstantAndDifferForAnother) {
  Studio studio(*planning::loadScenario("grab_pipe"));
  auto snapshot = studio.body().snapshot();
  const PictureOrder order{"head_left", studio.rig().lens("head_left"), 2, 7};
  const auto a = studio.maker().take(snapshot, order), b = studio.maker().take(snapshot, order);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a->jpeg, b->jpeg);
  snapshot.time_s += 0.1;
  EXPECT_NE(studio.maker().take(snapshot, order)->jpeg, a->jpeg) << "the noise is another";
}

TEST(VirtualPictures, DarkAndGlareAreSeen) {
  cv::Mat picture(480, 640, CV_8UC3, cv::Scalar::all(120)), dark = picture.clone();
  darken(dark);
  EXPECT_LT(cv::mean(dark)[0], 6);
  addGlare(picture);
  EXPECT_GT(cv::countNonZero(picture.reshape(1) == 255), 640 * 480 * 3 / 20);
}

TEST(VirtualPictures, ZoomMakesThePipeLarger) {
  auto scenario = barScenario();
  scenario.objects[0].body.X_WO.translation() = Vector3d(1.6, 0.13, 0.3);
  Studio studio(scenario, "ptz");
  const double wide = cv::countNonZero(magenta(studio.take("ptz_left")) > 60);
  ASSERT_GT(wide, 50);
  ASSERT_TRUE(studio.rig().setZoom("ptz_left", 0.2).ok());
  studio.rig().tick(0.005);
  for (int i = 0; i < 400; ++i) studio.rig().tick(0.005);
  const double factor = studio.rig().lens("ptz_left").fx / studio.rig().lens("ptz_right").fx;
  EXPECT_GT(factor, 1.3);
  EXPECT_GT(cv::countNonZero(magenta(studio.take("ptz_left")) > 60), 1.3 * wide);
  EXPECT_EQ(studio.rig().mount("ptz_right").translation().norm(), 0) << "at the wide end the lens sits in its link";
  EXPECT_GT(studio.rig().mount("ptz_left").translation().z(), 0.003) << "its entrance pupil moves ahead";
  EXPECT_FALSE(studio.rig().setZoom("ptz_left", -0.1).ok());
  EXPECT_EQ(studio.rig().setZoom("wrist", 0.1).error().code, ErrorCode::kNotFound);
}

TEST(VirtualPictures, WhatIsOutOfFocusIsBlurred) {
  Studio studio(*planning::loadScenario("grab_pipe"), "ptz");
  auto& rig = studio.rig();
  const auto detail = [&](double blur_px) {
    PictureOrder order{"ptz_left", rig.lens("ptz_left")};
    order.blur_px = blur_px;
    cv::Mat grey, edges;
    cv::cvtColor(*studio.maker().render(studio.body().snapshot(), order), grey, cv::COLOR_BGR2GRAY);
    cv::Laplacian(grey, edges, CV_64F);
    return cv::mean(edges.mul(edges))[0];
  };
  rig.see("ptz_left", 1.0);
  EXPECT_LT(rig.blur_px("ptz_left", 1.0), 1e-9) << "it focuses by itself at first";
  ASSERT_TRUE(rig.setFocus("ptz_left", 0).ok());
  for (int i = 0; i < 400; ++i) rig.tick(0.005);
  const double blur = rig.blur_px("ptz_left", 1.0);
  EXPECT_GT(blur, 0.5);
  EXPECT_LT(detail(blur), 0.8 * detail(0));
  EXPECT_EQ(rig.blur_px("wrist", 1.0), 0);
  EXPECT_FALSE(rig.setFocus("ptz_left", 1.5).ok());
}

TEST(VirtualPictures, EveryCameraSeesSomething) {
  for (const char* variant : {"", "ptz"}) {
    Studio studio(*planning::loadScenario("grab_pipe"), variant);
    for (const auto& camera : studio.rig().names()) {
      cv::Scalar mean, spread;
      cv::meanStdDev(studio.take(camera), mean, spread);
      EXPECT_GT(spread[1], 8) << camera;
      EXPECT_GT(mean[1], 25) << camera;
    }
  }
}

TEST(CameraRig, TakesBothOfAPairAtOnceAndTheOthersInTurn) {
  auto rig = CameraRig::load(builtIn());
  ASSERT_TRUE(rig.ok());
  EXPECT_TRUE(rig->takeDue(0).empty()) << "nobody wants pictures";
  for (const auto& camera : rig->names()) rig->want(camera, true);
  std::map<std::string, int> taken;
  for (double t = 0; t < 2 - 1e-9; t += 0.01) {
    for (auto due = rig->takeDue(t); !due.empty(); due = rig->takeDue(t)) {
      if (due.front() == "head_left") {
        EXPECT_EQ(due, (std::vector<std::string>{"head_left", "head_right"}));
      }
      for (const auto& camera : due) ++taken[camera];
    }
  }
  EXPECT_EQ(taken["head_left"], 20);
  EXPECT_EQ(taken["head_right"], 20);
  EXPECT_EQ(taken["wrist"], 10);
  rig->want("head_right", false);
  rig->want("head_left", true, 0.5);
  EXPECT_EQ(rig->takeDue(10), std::vector<std::string>({"drive"}));
}

TEST(RenderThread, DeliversAndReplacesWhatWaits) {
  std::mutex mutex;
  std::vector<double> stamps;
  RenderThread thread(
      builtIn(), emptyScenario(), true,
      [&](const Picture& p) {
        std::lock_guard<std::mutex> lock(mutex);
        stamps.push_back(p.time_s);
      },
      [](const std::string& what) { FAIL() << what; });
  const auto rig = CameraRig::load(builtIn());
  const auto body = bodyOf(emptyScenario());
  for (int i = 1; i <= 50; ++i) {
    auto world = body->snapshot();
    world.time_s = i;
    thread.request({world, {{"wrist", rig->lens("wrist")}}});
  }
  thread.finish();
  EXPECT_TRUE(thread.idle());
  std::lock_guard<std::mutex> lock(mutex);
  ASSERT_FALSE(stamps.empty());
  EXPECT_LT(stamps.size(), 50u) << "most were replaced";
  EXPECT_EQ(stamps.back(), 50) << "the newest is never lost";
}

TEST(VirtualPicturesCampaign, ReportsTheTimeOfAStereoPair) {
  Studio studio(*planning::loadScenario("grab_pipe"));
  const auto snapshot = studio.body().snapshot();
  const auto take = [&](const char* camera) {
    return studio.maker().take(snapshot, {camera, studio.rig().lens(camera), 2, 1}).ok();
  };
  ASSERT_TRUE(take("head_left") && take("head_right"));
  std::vector<double> times;
  for (int i = 0; i < 30; ++i) {
    const auto start = std::chrono::steady_clock::now();
    ASSERT_TRUE(take("head_left") && take("head_right"));
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(times.begin(), times.end());
  std::printf("stereo pair: median %.1f ms, p90 %.1f ms\n", times[15], times[27]);
}

}  // namespace
}  // namespace longarm::virtual_robot
