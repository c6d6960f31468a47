// What the scene draws, checked in pictures: everything stands where the camera model says that it is seen.
#include <gtest/gtest.h>
#include <vtkRenderer.h>  // vtkRenderingCore

#include "planning/macros/macro.h"
#include "tests/planning/pipe_scene.h"
#include "tests/widgets/scene/scene_rig.h"
#include "widgets/scene/clearance_look.h"
#include "widgets/scene/dimension_rep.h"
#include "widgets/scene/frustum_rep.h"
#include "widgets/scene/ground_grid_rep.h"
#include "widgets/scene/lens_warp.h"
#include "widgets/scene/plan_rep.h"
#include "widgets/scene/robot_rep.h"
#include "widgets/scene/sketch_rep.h"
#include "widgets/scene/world_rep.h"

namespace longarm::scene {
namespace {

using tests::SceneRig;

constexpr double kHalfPixel = 0.6;  // A drawn outline is whole pixels.

planning::WorldObject ball(const Eigen::Vector3d& at, double radius) {
  planning::WorldObject object;
  object.name = "ball";
  object.shape = planning::Sphere{radius};
  object.X_WO.translation() = at;
  object.rgba = {0.9, 0.9, 0.9, 1};
  return object;
}

SketchItem pointItem(const Eigen::Vector3d& at, const Eigen::Matrix3d& covariance) {
  SketchItem item;
  item.feature.kind = vision::FeatureKind::kPoint;
  item.feature.vertices.resize(1);
  item.feature.vertices[0].xyz = at;
  item.feature.vertices[0].covariance = covariance;
  return item;
}

TEST_F(SceneRig, DrawsABallWhereTheCameraModelSeesIt) {
  WorldRep world;
  world.addTo(renderer());
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.4, 0.5, -0.3), Eigen::Vector3d(-0.5, -0.4, 0.2)}) {
    world.update({ball(at, 0.02)});
    const Eigen::Vector2d wanted = *m_view.project(at);
    const cv::Mat mask = drawn(shot());
    ASSERT_GT(cv::countNonZero(mask), 8);
    EXPECT_LT((middle(mask) - wanted).norm(), kHalfPixel) << at.transpose();
  }
}

TEST_F(SceneRig, BodiesOfALinkFollowItAndVanishWithIt) {
  WorldRep world;
  world.addTo(renderer());
  auto held = ball({0.1, 0, 0}, 0.03);
  held.attached_link = "tool_tip";
  Pose X_WL = Pose::Identity();
  X_WL.translation() = Eigen::Vector3d(0, 0.3, 0.1);
  world.update({held}, {{"tool_tip", X_WL}});
  EXPECT_LT((middle(drawn(shot())) - *m_view.project({0.1, 0.3, 0.1})).norm(), kHalfPixel);
  world.update({held}, {});
  EXPECT_EQ(cv::countNonZero(drawn(shot())), 0);
}

TEST_F(SceneRig, AnEllipsoidIsAsWideAsTheCovarianceSays) {
  SketchRep sketch;
  sketch.setLook({1, false, true, {0.2, 0.9, 0.9}, {1, 0.6, 0.1}});
  sketch.addTo(renderer());
  const Eigen::Vector3d sigma(0.01, 0.05, 0.02);  // depth, left-right, up-down
  sketch.update({pointItem({0, 0, 0}, sigma.cwiseAbs2().asDiagonal())});
  const cv::Rect box = extent(drawn(shot()));
  const double chi = std::sqrt(kChi2Of95Percent3), px_per_m = m_view.camera.fx / 2;
  EXPECT_NEAR(box.width, 2 * chi * sigma.y() * px_per_m, 2);
  EXPECT_NEAR(box.height, 2 * chi * sigma.z() * px_per_m, 2);
}

TEST_F(SceneRig, SketchedLinesEndAtTheirVerticesAndHiddenOnesAreGone) {
  SketchItem line;
  line.feature.kind = vision::FeatureKind::kLine;
  line.feature.vertices.resize(2);
  line.feature.vertices[0].xyz = {0, 0.4, 0.2};
  line.feature.vertices[1].xyz = {0.2, -0.4, -0.1};
  SketchRep sketch;
  sketch.setLook({1, false, false, {0.2, 0.9, 0.9}, {1, 0.6, 0.1}});
  sketch.addTo(renderer());
  sketch.update({line});
  const cv::Rect box = extent(drawn(shot()));
  const Eigen::Vector2d a = *m_view.project({0, 0.4, 0.2}), b = *m_view.project({0.2, -0.4, -0.1});
  EXPECT_NEAR(box.x, a.x(), 6);  // the vertices' squares reach beyond the ends
  EXPECT_NEAR(box.x + box.width, b.x(), 6);
  line.visible = false;
  sketch.update({line});
  EXPECT_EQ(cv::countNonZero(drawn(shot())), 0);
}

TEST_F(SceneRig, AMeasuredWayRunsFromPlaceToPlaceWithItsTextAtTheMiddle) {
  DimensionRep dimension;
  dimension.addTo(renderer());
  const Eigen::Vector3d a(0, 0.4, 0.2), b(0.2, -0.4, -0.1);
  dimension.update({a, b}, {});
  const cv::Mat bare = drawn(shot());
  const cv::Rect way = extent(bare);
  const Eigen::Vector2d at_a = *m_view.project(a), at_b = *m_view.project(b), middle = *m_view.project((a + b) / 2);
  EXPECT_NEAR(way.x, at_a.x(), 6);
  EXPECT_NEAR(way.x + way.width, at_b.x(), 6);
  EXPECT_GT(bare.at<uchar>(cv::Point(static_cast<int>(std::lround(middle.x())), static_cast<int>(std::lround(middle.y())))), 0);
  dimension.update({a, b}, "402.1 mm");
  const cv::Mat text = drawn(shot()) - bare;
  ASSERT_GT(cv::countNonZero(text), 40);
  const cv::Rect written = extent(text);
  EXPECT_LT(std::abs(written.x - middle.x()), 30);
  EXPECT_LT(std::abs(written.y + written.height - middle.y()), 30);
  dimension.update({}, "402.1 mm");
  EXPECT_EQ(cv::countNonZero(drawn(shot())), 0);
  dimension.update({a, Eigen::Vector3d::Constant(std::nan(""))}, "?");
  EXPECT_EQ(cv::countNonZero(drawn(shot())), 0);
}

TEST_F(SceneRig, ASelectedFeatureHasTheColourOfSelection) {
  SketchRep sketch;
  SketchLook look;
  look.names = look.ellipsoids = false;
  sketch.setLook(look);
  sketch.addTo(renderer());
  auto item = pointItem({0, 0, 0}, Eigen::Matrix3d::Zero());
  item.selected = true;
  sketch.update({item});
  const Eigen::Vector2d at = *m_view.project({0, 0, 0});
  const auto bgr = shot().at<cv::Vec3b>(static_cast<int>(at.y()), static_cast<int>(at.x()));
  EXPECT_NEAR(bgr[2], 255 * look.selected_color[0], 12);
  EXPECT_NEAR(bgr[1], 255 * look.selected_color[1], 12);
}

// Seen from the snapshot's own place, its picture in the scene is the picture itself, lens included.
TEST_F(SceneRig, AFrustumShowsItsPictureWhereItWasTaken) {
  vision::View view = m_view;
  view.camera.distortion = {-0.2, 0.05, 0.001, -0.0005, 0};
  cv::Mat picture(view.camera.height, view.camera.width, CV_8UC3, cv::Scalar(40, 40, 40));
  const std::vector<cv::Point> marks = {{60, 50}, {160, 120}, {260, 60}, {70, 200}, {250, 190}};
  for (const auto& m : marks) cv::circle(picture, m, 5, cv::Scalar(255, 255, 255), -1);
  FrustumRep frustum;
  FrustumLook look;
  look.opacity = 1;
  look.lines = false;
  frustum.setLook(look);
  frustum.update(view, picture);
  frustum.addTo(renderer());
  cv::Mat seen, grey;
  cv::cvtColor(shot(), grey, cv::COLOR_BGR2GRAY);
  for (const auto& m : marks) {
    const auto n = view.camera.normalisedOfPixel({static_cast<double>(m.x), static_cast<double>(m.y)});
    ASSERT_TRUE(n.ok());
    const Eigen::Vector2d straight = m_view.camera.pixelOfNormalised(*n);  // the renderer has no lens
    cv::Mat window = cv::Mat::zeros(grey.size(), CV_8U);
    cv::circle(window, {static_cast<int>(straight.x()), static_cast<int>(straight.y())}, 11, 255, -1);
    EXPECT_LT((middle((grey > 150) & window) - straight).norm(), 1.0) << m.x << ", " << m.y;
  }
}

TEST_F(SceneRig, AFrustumWithoutASizeDrawsNothing) {
  FrustumRep frustum;
  vision::View view = m_view;
  view.camera.width = view.camera.height = 0;
  frustum.update(view, cv::Mat());
  frustum.addTo(renderer());
  EXPECT_EQ(cv::countNonZero(drawn(shot())), 0);
}

TEST_F(SceneRig, TheRobotIsDrawnAtItsJointsAndLeavesNothingBehind) {
  const auto& cell = tests::builtIn();
  m_view.X_WC.translation() = Eigen::Vector3d(-4, 0, 0.5);
  {
    RobotRep robot(cell.model);
    robot.addTo(renderer());
    robot.update(tests::configuration(cell, "home"));
    const cv::Mat home = shot();
    robot.update(tests::configuration(cell, "ready"));
    const cv::Mat ready = shot();
    EXPECT_GT(cv::countNonZero(drawn(home)), 1500);
    EXPECT_GT(cv::countNonZero(drawn(cv::abs(home - ready))), 300) << "the arm moved";
    const auto box = robot.bounds();
    EXPECT_GT(box.sizes().z(), 0.6);
    robot.setVisible(false);
    EXPECT_EQ(cv::countNonZero(drawn(shot())), 0);
  }
  EXPECT_EQ(cv::countNonZero(drawn(shot())), 0) << "props outlived their representation";
}

void showTrailAlone(PlanRep& rep, const planning::Plan& plan, vtkRenderer* renderer) {
  PlanLook look;
  look.axes_at_stages = false;
  rep.setLook(look);
  rep.addTo(renderer);
  rep.update(plan);
  rep.setGhostVisible(false);
}

TEST_F(SceneRig, APlansTrailRunsThroughTheToolTip) {
  const auto& cell = tests::builtIn();
  auto context = tests::contextOf(cell);
  const auto macros = planning::makeMacros(cell);
  const planning::Plan plan = planning::findMacro(macros, "ready")->plan(context, nullptr);
  ASSERT_TRUE(plan.ok()) << plan.reason;
  PlanRep rep(cell.model, cell.arm.tip_link);
  showTrailAlone(rep, plan, renderer());
  m_view.X_WC.translation() = Eigen::Vector3d(-4, 0, 0.7);
  const cv::Mat mask = drawn(shot());
  ASSERT_GT(cv::countNonZero(mask), 10);
  for (const Pose& X : toolTrail(*cell.model, cell.arm.tip_link, plan, 12)) {
    const Eigen::Vector2d at = *m_view.project(X.translation());
    const cv::Rect near(static_cast<int>(at.x()) - 2, static_cast<int>(at.y()) - 2, 5, 5);
    EXPECT_GT(cv::countNonZero(mask(near & cv::Rect(0, 0, mask.cols, mask.rows))), 0) << X.translation().transpose();
  }
}

// Each step of the trail has the colour of the least room that was seen on it.
TEST_F(SceneRig, ThePlansTrailHasTheColoursOfItsClearance) {
  const auto& cell = tests::builtIn();
  const auto macros = planning::makeMacros(cell);
  planning::Plan plan = planning::findMacro(macros, "ready")->plan(tests::contextOf(cell), nullptr);
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const double whole = plan.trajectory.duration();
  plan.clearance = {{0, 0.2}, {0.5 * whole, 0.2}, {0.5 * whole, 0.01}, {whole, 0.01}};
  PlanRep rep(cell.model, cell.arm.tip_link);
  showTrailAlone(rep, plan, renderer());
  m_view.X_WC.translation() = Eigen::Vector3d(-4, 0, 0.7);
  const cv::Mat picture = shot();
  const auto count = [&](planning::ClearanceBand band) {
    const Eigen::Vector3d rgb = 255 * clearanceColor(band);
    cv::Mat same;
    cv::inRange(picture, cv::Scalar(rgb[2] - 12, rgb[1] - 12, rgb[0] - 12), cv::Scalar(rgb[2] + 12, rgb[1] + 12, rgb[0] + 12), same);
    return cv::countNonZero(same);
  };
  EXPECT_GT(count(planning::ClearanceBand::kFree), 5);
  EXPECT_GT(count(planning::ClearanceBand::kTight), 5);
  EXPECT_EQ(count(planning::ClearanceBand::kNear), 0);
  plan.clearance.clear();
  rep.update(plan);
  rep.setGhostVisible(false);
  EXPECT_GT(cv::countNonZero(cv::Mat(shot() != picture).reshape(1)), 0) << "one colour where nothing is told";
}

TEST_F(SceneRig, ScrubbingAPlanMovesItsGhost) {
  const auto& cell = tests::builtIn();
  const auto macros = planning::makeMacros(cell);
  const planning::Plan plan = planning::findMacro(macros, "ready")->plan(tests::contextOf(cell), nullptr);
  ASSERT_TRUE(plan.ok()) << plan.reason;
  PlanRep rep(cell.model, cell.arm.tip_link);
  rep.addTo(renderer());
  rep.update(plan);
  m_view.X_WC.translation() = Eigen::Vector3d(-4, 0, 0.5);
  const cv::Mat start = shot();
  rep.scrub(plan.trajectory.duration());
  EXPECT_GT(cv::countNonZero(drawn(cv::abs(start - shot()))), 200);
  rep.clear();
  EXPECT_EQ(cv::countNonZero(drawn(shot())), 0);
}

TEST_F(SceneRig, ARefusedPlanMarksThePoseThatFailed) {
  const auto& cell = tests::builtIn();
  planning::Plan plan;
  plan.status = planning::PlanStatus::kUnreachable;
  Pose X = Pose::Identity();
  X.translation() = Eigen::Vector3d(0, 0.2, 0.1);
  plan.failed_pose = X;
  PlanRep rep(cell.model, cell.arm.tip_link);
  rep.addTo(renderer());
  rep.update(plan);
  const cv::Mat mask = drawn(shot());
  ASSERT_GT(cv::countNonZero(mask), 5);
  EXPECT_LT((middle(mask) - *m_view.project(X.translation())).norm(), 12);
}

TEST_F(SceneRig, TheLensWarpPutsPicturesWhereTheRealLensDoes) {
  vision::CameraModel camera = m_view.camera;
  camera.distortion = {-0.25, 0.08, 0.001, -0.0008, 0};
  camera.skew = 0.4;
  const auto warp = LensWarp::make(camera, 480, 360);
  ASSERT_TRUE(warp.ok()) << warp.error().message;
  m_renderer->resize(480, 360);
  WorldRep world;
  world.addTo(renderer());
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(0, 0.7, 0.5), Eigen::Vector3d(0, -0.6, -0.5), Eigen::Vector3d(0, 0, 0)}) {
    world.update({ball(at, 0.025)});
    m_renderer->lookFrom(m_view.X_WC, warp->pinhole());
    const cv::Mat mask = drawn(warp->apply(m_renderer->render()));
    vision::View real = m_view;
    real.camera = camera;
    EXPECT_LT((middle(mask) - *real.project(at)).norm(), kHalfPixel) << at.transpose();
  }
  EXPECT_FALSE(LensWarp::make({}, 480, 360).ok());
}

}  // namespace
}  // namespace longarm::scene
