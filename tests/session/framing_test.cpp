// Framing: pan, tilt and zoom that make points fill a picture; and the controllers that command them.
#include <cmath>

#include <gtest/gtest.h>

#include "session/controllers/aim_controller.h"
#include "session/controllers/calibrated_camera.h"
#include "session/controllers/framing.h"
#include "session/controllers/snapshot_maker.h"
#include "session/controllers/watch_controller.h"
#include "session/controllers/zoom_drive.h"
#include "tests/session/event_loop.h"
#include "tests/session/still_robot.h"

namespace longarm::session {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::StillRobot;

class CameraFraming : public testing::EventLoopTest {
 protected:
  void open(const std::string& variant) {
    auto loaded = planning::loadBuiltInWorkcell(variant);
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    m_cell = std::make_shared<const planning::Workcell>(std::move(*loaded));
    m_robot = std::make_unique<StillRobot>(m_cell);
    m_aim.setFeed(m_robot.get());
    m_aim.setWorkcell(m_cell);
    QObject::connect(&m_aim, &AimController::failed, [this](const QString& what) { m_said += what.toStdString() + "\n"; });
  }
  vision::View view(const std::string& camera) const {
    return cameraView(*m_cell, camera, m_robot->state(), *m_robot->zoomAt(camera, 0)).value();
  }

  std::shared_ptr<const planning::Workcell> m_cell;
  std::unique_ptr<StillRobot> m_robot;
  AimController m_aim;
  std::string m_said;
};

TEST_F(CameraFraming, ARegionOfThePictureFillsIt) {
  open("ptz");
  const auto before = view("ptz_left");
  const Vector2d a(420, 300), b(500, 380);
  const auto region = *regionAt(before, a, b, 3);
  m_aim.frameRegion("ptz_left", a, b);
  EXPECT_EQ(m_said, "");
  const auto after = view("ptz_left");
  EXPECT_GT(after.camera.fx, 3 * before.camera.fx);
  EXPECT_NEAR(spread(after, region), FramingWish().fill, 0.01);
  Eigen::AlignedBox2d seen;
  for (const auto& p : region) seen.extend(*after.project(p));
  EXPECT_NEAR(seen.center().x(), 319.5, 6);
  EXPECT_NEAR(seen.center().y(), 239.5, 6);
  EXPECT_EQ(*after.zoom, **m_robot->zoomAt("ptz_left", 0));
}

TEST_F(CameraFraming, ManyRegionsStayWithinThePictureAndTheLimits) {
  open("ptz");
  const auto limits = [&](const char* joint) {
    const auto& found = m_cell->model->joints()[static_cast<std::size_t>(*m_cell->model->jointIndex(joint))];
    return std::pair(found.lower, found.upper);
  };
  for (int i = 0; i < 40; ++i) {
    m_robot->setJoint("ptz_left_pan_joint", -1.0 + 0.05 * i);
    m_robot->setJoint("ptz_left_tilt_joint", 0.3 * std::sin(i));
    (void)m_robot->setZoom("ptz_left", 0.02 * i);
    m_said.clear();
    const auto now = view("ptz_left");
    const Vector2d a(100 + 7 * i, 60 + 5 * i), b = a + Vector2d(30 + 3 * i, 90 - i);
    const auto region = *regionAt(now, a, b, 3);
    m_aim.frameRegion("ptz_left", a, b);
    const double part = spread(view("ptz_left"), region);
    EXPECT_LE(part, FramingWish().fill + 0.01) << i << ": " << m_said;
    EXPECT_TRUE(!m_said.empty() || part > FramingWish().fill / 2) << i;
    for (const char* joint : {"ptz_left_pan_joint", "ptz_left_tilt_joint"}) {
      EXPECT_GE(m_robot->joint(joint), limits(joint).first);
      EXPECT_LE(m_robot->joint(joint), limits(joint).second);
    }
  }
}

TEST_F(CameraFraming, WhatCannotBeHadIsSaid) {
  open("ptz");
  m_aim.framePoints("ptz_left", {{0.9, 0.2, 5.0}, {0.8, 0.3, 5.0}});
  EXPECT_NE(m_said.find("as far as it can"), std::string::npos) << m_said;
  m_said.clear();
  m_aim.framePoints("ptz_left", {{60, 1, 1}, {60, 1.02, 1}});
  EXPECT_NE(m_said.find("as far as it is calibrated"), std::string::npos) << m_said;
  m_said.clear();
  m_aim.framePoints("ptz_left", {{0.8, -2, 0.3}, {0.8, 2, 0.3}});
  EXPECT_NE(m_said.find("does not fit"), std::string::npos) << m_said;
  m_said.clear();
  m_aim.framePoints("wrist", {{1, 0, 0.5}});
  EXPECT_NE(m_said.find("No pan-tilt aims camera wrist"), std::string::npos) << m_said;
  m_aim.framePoints("ptz_left", {});
  EXPECT_NE(m_said.find("nothing to look at"), std::string::npos) << m_said;
}

TEST_F(CameraFraming, WithoutAZoomItIsBroughtToTheMiddle) {
  open("");
  const Vector3d p(1.2, 0.3, 0.4);
  m_aim.framePoints("head_left", {p});
  EXPECT_EQ(m_said, "");
  const auto after = view("head_left");
  EXPECT_FALSE(after.zoom.has_value());
  EXPECT_NEAR((*after.project(p) - Vector2d(319.5, 239.5)).norm(), 0, 0.5);
  EXPECT_EQ(m_robot->zooms, 0);
}

TEST_F(CameraFraming, TurnsAreFinerWhenZoomedIn) {
  open("ptz");
  m_aim.setPanTilt("ptz_left");
  const double start = m_robot->joint("ptz_left_pan_joint");
  m_aim.step(0.1, 0);
  const double wide = std::abs(m_robot->joint("ptz_left_pan_joint") - start);
  (void)m_robot->setZoom("ptz_left", 0.8);
  m_aim.setPanTilt("ptz_left");
  m_aim.step(0.1, 0);
  const double narrow = std::abs(m_robot->joint("ptz_left_pan_joint") - start) - wide;
  EXPECT_NEAR(wide, 0.1, 1e-9);
  EXPECT_NEAR(std::abs(narrow), 0.1 / 8, 1e-3);
}

TEST_F(CameraFraming, HeldZoomMovesUntilItIsReleased) {
  open("ptz");
  ZoomDrive drive;
  drive.setFeed(m_robot.get());
  drive.setWorkcell(m_cell);
  EXPECT_TRUE(drive.zooms("ptz_left"));
  EXPECT_FALSE(drive.whyNot("wrist").isEmpty());
  drive.holdZoom("ptz_left", 1);
  const bool moved = waitFor([&] {
    m_robot->time_s += 0.05;
    return *drive.zoom("ptz_left") > 0.1;
  });
  ASSERT_TRUE(moved);
  EXPECT_GT(*drive.magnification("ptz_left"), 1.2);
  drive.release();
  const double there = *drive.zoom("ptz_left");
  const int commands = m_robot->zooms;
  for (int i = 0; i < 10; ++i) QCoreApplication::processEvents(QEventLoop::AllEvents, 20);
  EXPECT_EQ(*drive.zoom("ptz_left"), there);
  EXPECT_EQ(m_robot->zooms, commands);
  drive.setFocus("ptz_left", 0.4);
  EXPECT_EQ(*drive.focus("ptz_left"), 0.4);
}

// The operator's own hand goes first; STOP and a resting arm end it.
TEST_F(CameraFraming, WatchingFollowsTheToolSlowlyAndGivesWay) {
  open("ptz");
  WatchController watch;
  watch.setFeed(m_robot.get());
  watch.setWorkcell(m_cell);
  const auto tool = [&] {
    Eigen::VectorXd q = m_cell->model->neutral();
    m_cell->model->assign(m_robot->state(), q);
    return Vector3d(m_cell->model->forward(q, *m_cell->model->linkIndex(m_cell->arm.tip_link)).translation());
  };
  for (const auto& [joint, position] : m_cell->poses.at("ready")) m_robot->setJoint(joint, position);
  m_robot->setJoint("ptz_left_pan_joint", 1.5);            // looks away
  ASSERT_GT(spread(view("ptz_left"), {tool()}), 1);
  const auto run = [&](int ticks, bool moving, bool stopped) {
    double fastest = 0;
    for (int i = 0; i < ticks; ++i) {
      const double before = m_robot->joint("ptz_left_pan_joint");
      m_robot->time_s += 0.1;
      watch.refresh(moving, stopped);
      fastest = std::max(fastest, std::abs(m_robot->joint("ptz_left_pan_joint") - before) / 0.1);
    }
    return fastest;
  };
  EXPECT_EQ(run(10, false, false), 0) << "the arm rests";
  EXPECT_EQ(run(10, true, true), 0) << "STOP";
  watch.setOn(false);
  EXPECT_EQ(run(10, true, false), 0) << "switched off";
  watch.setOn(true);
  watch.giveWay("ptz_left");
  EXPECT_EQ(run(40, true, false), 0) << "the operator aims";
  const double fastest = run(120, true, false);
  EXPECT_GT(fastest, 0.1);
  EXPECT_LE(fastest, 0.85);
  EXPECT_LT(spread(view("ptz_left"), {tool()}), 0.8);
  EXPECT_GT(**m_robot->zoomAt("ptz_left", 0), 0.05) << "and comes closer";
  const int turns = m_robot->turns;
  run(20, true, false);
  EXPECT_EQ(m_robot->turns, turns) << "a tool in the middle is left there";
}

}  // namespace
}  // namespace longarm::session
