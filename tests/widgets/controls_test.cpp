// STOP, hold button, stick, transport, camera tiles, lamps: what they emit and when.
#include <vector>

#include <QApplication>
#include <QMouseEvent>
#include <QSignalSpy>
#include <QSlider>
#include <QTest>
#include <QToolButton>
#include <gtest/gtest.h>

#include "widgets/aim_stick.h"
#include "widgets/camera_strip.h"
#include "widgets/hold_button.h"
#include "widgets/mode_frame.h"
#include "widgets/status_lamp.h"
#include "widgets/stop_button.h"
#include "widgets/transport_bar.h"
#include "widgets/value_label.h"

namespace longarm::widgets {
namespace {

void mouse(QWidget& widget, QEvent::Type type, QPointF at, Qt::MouseButton button, Qt::MouseButtons buttons) {
  QMouseEvent event(type, at, widget.mapToGlobal(at.toPoint()), button, buttons, Qt::NoModifier);
  QApplication::sendEvent(&widget, &event);
}

TEST(StopButton, ActsOnPressWithAnyButtonAndIsLargeEnough) {
  StopButton stop;
  stop.resize(stop.sizeHint());
  QSignalSpy spy(&stop, &StopButton::stopPressed);
  mouse(stop, QEvent::MouseButtonPress, {50, 50}, Qt::LeftButton, Qt::LeftButton);
  EXPECT_EQ(spy.count(), 1);
  mouse(stop, QEvent::MouseButtonPress, {50, 50}, Qt::RightButton, Qt::RightButton);
  EXPECT_EQ(spy.count(), 2);
  EXPECT_GE(stop.minimumSizeHint().width(), 96);           // 25 mm at 96 dots per inch
  EXPECT_GE(stop.minimumSizeHint().height(), 96);
  for (const auto state : {StopButton::State::kReady, StopButton::State::kRequested, StopButton::State::kConfirmed}) {
    stop.setState(state);
    EXPECT_GT(QColor(stop.grab().toImage().pixel(56, 16)).saturation(), 120);
  }
}

TEST(HoldButton, ActsOnlyAfterItWasHeldLongEnough) {
  HoldButton button(QStringLiteral("Reset"), 120);
  button.show();
  QSignalSpy spy(&button, &HoldButton::held);
  mouse(button, QEvent::MouseButtonPress, {10, 10}, Qt::LeftButton, Qt::LeftButton);
  mouse(button, QEvent::MouseButtonRelease, {10, 10}, Qt::LeftButton, Qt::NoButton);
  EXPECT_FALSE(spy.wait(200));
  mouse(button, QEvent::MouseButtonPress, {10, 10}, Qt::LeftButton, Qt::LeftButton);
  EXPECT_TRUE(spy.wait(2000));
  EXPECT_EQ(spy.count(), 1);
  EXPECT_FALSE(spy.wait(200)) << "once per hold";
  mouse(button, QEvent::MouseButtonRelease, {10, 10}, Qt::LeftButton, Qt::NoButton);
}

struct Stick {
  AimStick stick;
  std::vector<QPointF> said;
  Stick() {
    stick.resize(100, 100);
    stick.show();
    QObject::connect(&stick, &AimStick::deflected, &stick, [this](double x, double y) { said.emplace_back(x, y); });
  }
};

TEST(AimStick, GivesRightAndUpAsPositiveAndSpringsBack) {
  Stick s;
  mouse(s.stick, QEvent::MouseButtonPress, {50, 50}, Qt::LeftButton, Qt::LeftButton);
  EXPECT_TRUE(s.said.empty()) << "the middle is dead";
  mouse(s.stick, QEvent::MouseMove, {99, 50}, Qt::NoButton, Qt::LeftButton);
  ASSERT_EQ(s.said.size(), 1u);
  EXPECT_NEAR(s.said[0].x(), 1, 1e-12);
  EXPECT_NEAR(s.said[0].y(), 0, 1e-12);
  mouse(s.stick, QEvent::MouseMove, {50, 1}, Qt::NoButton, Qt::LeftButton);
  EXPECT_NEAR(s.said.back().y(), 1, 1e-12);
  mouse(s.stick, QEvent::MouseButtonRelease, {50, 1}, Qt::LeftButton, Qt::NoButton);
  EXPECT_EQ(s.said.back(), QPointF(0, 0));
}

TEST(AimStick, LetsGoWhenHiddenOrDisabledWhileHeld) {
  for (const bool hide : {true, false}) {
    Stick s;
    mouse(s.stick, QEvent::MouseButtonPress, {90, 50}, Qt::LeftButton, Qt::LeftButton);
    ASSERT_FALSE(s.said.empty());
    if (hide) s.stick.hide(); else s.stick.setEnabled(false);
    EXPECT_EQ(s.said.back(), QPointF(0, 0));
    EXPECT_EQ(s.stick.deflection(), QPointF(0, 0));
  }
}

TEST(TransportBar, EnablesWhatItsStateAllowsAndSaysWhyNot) {
  TransportBar bar;
  TransportState state;
  state.why_not = QStringLiteral("Plan a motion first.");
  bar.setState(state);
  EXPECT_FALSE(bar.playButton()->isEnabled());
  EXPECT_TRUE(bar.playButton()->toolTip().contains(QStringLiteral("Plan a motion")));
  EXPECT_FALSE(bar.backUpButton()->isEnabled());
  state.loaded = state.can_play = state.can_back_up = state.can_scrub = true;
  bar.setState(state);
  EXPECT_TRUE(bar.playButton()->isEnabled());
  std::vector<TransportBar::Key> pressed;
  QObject::connect(&bar, &TransportBar::pressed, &bar, [&pressed](TransportBar::Key key) { pressed.push_back(key); });
  bar.playButton()->click();
  bar.backUpButton()->click();
  EXPECT_EQ(pressed, (std::vector<TransportBar::Key>{TransportBar::Key::kPlay, TransportBar::Key::kBackUp}));
  state.playing = true;
  bar.setState(state);
  EXPECT_FALSE(bar.playButton()->isEnabled());
  EXPECT_TRUE(bar.backUpButton()->isEnabled()) << "backing up is possible while playing";
}

TEST(TransportBar, ChangesSpeedInTenthsAndNeverEmitsWhatItIsTold) {
  TransportBar bar;
  QSignalSpy spy(&bar, &TransportBar::speedWanted);
  TransportState state;
  state.speed = -0.7;
  bar.setState(state);
  EXPECT_EQ(spy.count(), 0);
  EXPECT_EQ(bar.speedSlider()->value(), -7);
  bar.stepSpeed(1);
  ASSERT_EQ(spy.count(), 1);
  EXPECT_NEAR(spy.takeFirst().at(0).toDouble(), -0.6, 1e-12);
  state.speed = 2;
  bar.setState(state);
  bar.stepSpeed(3);
  EXPECT_NEAR(spy.takeFirst().at(0).toDouble(), 2, 1e-12);
}

TEST(TimeBar, ScrubsWhereItIsPressedOnlyWhenAllowed) {
  TimeBar bar;
  bar.resize(218, 44);
  bar.setStages({{QStringLiteral("transit"), 0, 6}, {QStringLiteral("approach"), 6, 10}}, 10);
  QSignalSpy spy(&bar, &TimeBar::scrubbed);
  mouse(bar, QEvent::MouseButtonPress, {bar.xOf(4), 10}, Qt::LeftButton, Qt::LeftButton);
  EXPECT_EQ(spy.count(), 0);
  bar.setScrubbable(true);
  mouse(bar, QEvent::MouseButtonPress, {bar.xOf(4), 10}, Qt::LeftButton, Qt::LeftButton);
  ASSERT_EQ(spy.count(), 1);
  EXPECT_NEAR(spy.takeFirst().at(0).toDouble(), 4, 1e-9);
  mouse(bar, QEvent::MouseMove, {9999, 10}, Qt::NoButton, Qt::LeftButton);
  EXPECT_NEAR(spy.takeFirst().at(0).toDouble(), 10, 1e-9);
  bar.grab();
}

// Higher is more room, in three colours, and in words where the mouse rests.
TEST(TimeBar, ShowsClearanceOverTimeAndTellsItInMillimetres) {
  TimeBar bar;
  bar.resize(218, 56);
  bar.setStages({{QStringLiteral("transit"), 0, 6}, {QStringLiteral("act"), 6, 10, QStringLiteral("the gripper opens")}}, 10);
  const QImage without = bar.grab().toImage();
  bar.setClearance({{0, 0.2}, {2, 0.2}, {3, 0.04}, {5, 0.04}, {6, 0.01}, {10, 0.01}});
  const QImage with = bar.grab().toImage();
  const auto columnOf = [&](double t, const QColor& color) {
    int high = 0;
    for (int y = 0; y < 16; ++y) high += with.pixelColor(static_cast<int>(bar.xOf(t)), y).rgb() == color.rgb();
    return high;
  };
  const int free = columnOf(1, clearanceColour(planning::ClearanceBand::kFree)), near = columnOf(4, clearanceColour(planning::ClearanceBand::kNear)),
            tight = columnOf(8, clearanceColour(planning::ClearanceBand::kTight));
  EXPECT_GE(free, 10);
  EXPECT_GT(free, near);
  EXPECT_GT(near, tight);
  EXPECT_GE(tight, 2) << "even touching shows";
  EXPECT_NE(with, without);
  EXPECT_EQ(bar.textAt(4), QStringLiteral("4.0 s, transit: clearance 40 mm"));
  EXPECT_EQ(bar.textAt(8), QStringLiteral("8.0 s, act (then the gripper opens): clearance 10 mm"));
  EXPECT_TRUE(bar.textAt(1).contains(QStringLiteral("100 mm or more"))) << bar.textAt(1).toStdString();
  EXPECT_NEAR(bar.timeOf(bar.xOf(7)), 7, 1e-9);
  bar.setClearance({});
  EXPECT_EQ(bar.grab().toImage(), without);
}

TEST(CameraStrip, TellsWhichCameraForWhichPane) {
  CameraStrip strip;
  strip.setCameras({QStringLiteral("head_left"), QStringLiteral("wrist")});
  strip.resize(140, 260);
  strip.show();
  QSignalSpy spy(&strip, &CameraStrip::chosen);
  auto* tile = strip.tile(QStringLiteral("wrist"));
  ASSERT_NE(tile, nullptr);
  EXPECT_EQ(strip.tile(QStringLiteral("nothing")), nullptr);
  mouse(*tile, QEvent::MouseButtonPress, {5, 5}, Qt::LeftButton, Qt::LeftButton);
  mouse(*tile, QEvent::MouseButtonPress, {5, 5}, Qt::RightButton, Qt::RightButton);
  ASSERT_EQ(spy.count(), 2);
  EXPECT_EQ(spy[0].at(0).toString(), QStringLiteral("wrist"));
  EXPECT_FALSE(spy[0].at(1).toBool());
  EXPECT_TRUE(spy[1].at(1).toBool());
  tile->setPicture(QImage(64, 48, QImage::Format_RGB32));
  for (const double age : {0.05, 0.4, 12.3}) {
    tile->setAge(age);
    tile->grab();
  }
  strip.setCameras({});
}

TEST(StatusLamp, KeepsItsWidthWhateverItSays) {
  StatusLamp lamp;
  lamp.setReserve(QStringLiteral("link lost for 99.9 s"));
  const QSize size = lamp.sizeHint();
  for (const auto level : {StatusLamp::Level::kOk, StatusLamp::Level::kBusy, StatusLamp::Level::kDegraded,
                           StatusLamp::Level::kLost, StatusLamp::Level::kFault}) {
    lamp.setStatus(level, QStringLiteral("up"));
    EXPECT_EQ(lamp.sizeHint(), size);
    lamp.grab();
  }
}

TEST(StatusLamp, ShowsMarkupInTextsOfTheRobotAsText) {
  StatusLamp lamp;
  lamp.setStatus(StatusLamp::Level::kFault, QStringLiteral("x"), QStringLiteral("<img src=/etc/passwd>"));
  EXPECT_FALSE(lamp.toolTip().contains(QLatin1Char('<')));
}

TEST(ValueLabel, ShowsAPointAndADash) {
  ValueLabel label(QStringLiteral("mm"), 1, -8888.8);
  EXPECT_EQ(label.text(), QStringLiteral("–"));
  label.setValue(-12.345);
  EXPECT_EQ(label.text(), QStringLiteral("-12.3 mm"));
}

TEST(ModeFrame, HatchesItsBorderOnlyInVirtual) {
  ModeFrame frame;
  frame.resize(200, 100);
  const auto colours = [&] {
    const QImage shot = frame.grab().toImage();
    std::set<QRgb> seen;
    for (int x = 0; x < 200; ++x) seen.insert(shot.pixel(x, 3));
    return seen.size();
  };
  frame.setMode(ModeLook::kVirtual);
  EXPECT_GT(colours(), 2u);
  frame.setMode(ModeLook::kLive);
  EXPECT_EQ(colours(), 1u);
  frame.setMode(ModeLook::kReplay);
  EXPECT_EQ(colours(), 2u);
}

}  // namespace
}  // namespace longarm::widgets
