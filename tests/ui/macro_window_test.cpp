// Every macro in the real window on the virtual robot, in a scenario that needs it: sketched, planned, looked
// at; one of each group is also played, paused, backed up, corrected and played to its end, all by mouse.
//
// LONGARM_UI_PICTURES=FOLDER keeps a picture of each plan, for docs/macros.md.
#include <cmath>

#include <QBuffer>
#include <QDockWidget>
#include <QFile>
#include <QToolButton>
#include <nlohmann/json.hpp>

#include "planning/world/scenario.h"
#include "tests/ui/window_fixture.h"
#include "ui/simulated_operator.h"

namespace longarm {
namespace {

using Eigen::Vector3d;
using planning::PlayerState;
using ui::ActionId;
using ui::SimulatedHand;
using ui::SimulatedOperator;

constexpr int kMostBytes = 60000;  // of a picture in the documentation

struct MacroCase {
  const char *macro, *scenario;
  ActionId tool;
  const char* object;            // whose frame the points are in
  std::vector<Vector3d> points;  // [m]
  std::map<std::string, double> settings = {};
};

void PrintTo(const MacroCase& c, std::ostream* out) { *out << c.macro << " in " << c.scenario; }

// Corners of the scenarios' bodies: the middle of an axis lies at 0, z along it.
const std::vector<Vector3d> kHandle{{0, 0, 0.10}, {0, 0, -0.10}}, kPipe{{0, 0, -0.2}, {0, 0, 0.2}},
    kAxle{{0, 0, -0.1}, {0, 0, 0.1}}, kPackageEdge{{-0.13, 0.18, -0.12}, {-0.13, -0.18, -0.12}},
    kPanel{{-0.01, 0.25, 0.2}, {-0.01, 0.25, -0.2}, {-0.01, -0.25, -0.2}},
    kCrate{{-0.035, 0.06, 0.05}, {0.035, 0.06, 0.05}, {-0.035, -0.06, 0.05}, {-0.035, 0.06, -0.05}},
    kPackage{{-0.13, 0.18, 0.12}, {0.13, 0.18, 0.12}, {-0.13, -0.18, 0.12}, {-0.13, 0.18, -0.12}},
    kCrateTop{{0, 0, 0.05}}, kPanelMiddle{{-0.01, 0, 0}};

std::vector<MacroCase> played() {
  return {
      {"approach_from_side", "open_door", ActionId::kToolLine, "handle", kHandle, {{"radius", 0.012}}},
      {"grab_pipe", "grab_pipe", ActionId::kToolLine, "pipe", kPipe},
      {"place_disruptor", "package", ActionId::kToolLine, "package", kPackageEdge},
      {"surface_scan", "scan_panel", ActionId::kToolPlane, "panel", kPanel, {{"swath", 0.3}, {"speed", 0.1}}},
      {"move_around_axis",
       "turn_valve",
       ActionId::kToolLine,
       "axle",
       kAxle,
       {{"angle", 0.3}}},
      {"grasp_by_faces", "crate", ActionId::kToolTriad, "crate", kCrate},
      {"touch", "scan_panel", ActionId::kToolPoint, "panel", kPanelMiddle, {{"gap", 0.02}}}};
}

std::vector<MacroCase> shown() {
  return {{"look_at", "crate", ActionId::kToolPoint, "crate", kCrateTop},
          {"move_above", "crate", ActionId::kToolPoint, "crate", kCrateTop},
          {"place_here", "crate", ActionId::kToolPoint, "table", {{0, -0.15, 0.015}}},
          {"move_parallel", "pull_drawer", ActionId::kToolLine, "handle", kHandle},
          {"aim_along_axis", "turn_valve", ActionId::kToolLine, "axle", kAxle},
          {"insert_along", "turn_valve", ActionId::kToolLine, "axle", kAxle},
          {"extract_along", "grab_pipe", ActionId::kToolLine, "pipe", kPipe},
          {"follow_perimeter", "scan_panel", ActionId::kToolPlane, "panel", kPanel, {{"inset", 0.08}}},
          {"press", "scan_panel", ActionId::kToolPlane, "panel", kPanel},
          {"push_face", "crate", ActionId::kToolTriad, "crate", kCrate},
          {"scan_faces", "package", ActionId::kToolTriad, "package", kPackage}};
}

class MacroWindow : public tests::WindowFixture, public ::testing::WithParamInterface<MacroCase> {
 protected:
  void openScenario(const MacroCase& c) {
    openWindow(QStringLiteral("dark"), {1280, 800});
    ui::RobotChoice choice;
    choice.scenario = QString::fromLatin1(c.scenario);
    bench->openRobot(choice);
    op = std::make_unique<SimulatedOperator>(*window, 0);
    ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->robot().linkUp(); }, 60))
        << bench->robot().status().link_text;
    demand(op->waitForLink(60));
  }
  // The points of the case in the world.
  Result<SimulatedOperator::Points> points(const MacroCase& c) const {
    const auto now = op->look();
    if (!now) return now.error();
    const auto object = now->objects.find(c.object);
    if (object == now->objects.end())
      return Error{ErrorCode::kNotFound, std::string("no object ") + c.object};
    SimulatedOperator::Points out;
    for (const auto& p : c.points) out.push_back(object->second * p);
    return out;
  }
  void sketch(const MacroCase& c) {
    demand(op->aim([&] { return points(c); }));
    demand(op->takePair());
    const auto there = points(c);
    ASSERT_TRUE(there.ok()) << there.error().message;
    demand(op->mark(c.tool, *there));
  }
  void planIt(const MacroCase& c) {
    for (const auto& [name, value] : c.settings) {
      const Status set =
          bench->plans().setArgument(QString::fromLatin1(c.macro), QString::fromStdString(name), value);
      ASSERT_TRUE(set.ok()) << set.error().message;
    }
    bench->plans().setBudget(60);
    demand(op->plan(QString::fromLatin1(c.macro), 120));
  }
  // Along the time bar to three quarters and back: nothing moves.
  void preview(const MacroCase& c) {
    const auto joints = bench->robot().runtime()->jointState()->positions;
    auto* bar = window->motion()->bar()->timeBar();
    const double there = 0.75 * bar->duration(), y = bar->height() / 3.0;
    hand.drag(bar, {bar->xOf(0), y}, {bar->xOf(there), y});
    EXPECT_NEAR(bench->play().state().cursor_s, there, 0.2);
    keep(QString::fromLatin1(c.macro));
    hand.drag(bar, {bar->xOf(there), y}, {bar->xOf(0), y});
    EXPECT_LT((bench->robot().runtime()->jointState()->positions - joints).cwiseAbs().maxCoeff(), 0.002);
    EXPECT_FALSE(bench->play().state().loaded);
  }
  // As a small JPEG.
  void keep(const QString& name) {
    const QString pictures = qEnvironmentVariable("LONGARM_UI_PICTURES");
    if (pictures.isEmpty()) return;
    window->scene()->view()->requestRender();
    SimulatedHand::pump(600);
    const QImage image =
        window->screen()->grabWindow(window->winId()).toImage().scaledToWidth(900, Qt::SmoothTransformation);
    for (int quality = 80; quality >= 20; quality -= 5) {
      QByteArray bytes;
      QBuffer buffer(&bytes);
      buffer.open(QIODevice::WriteOnly);
      image.save(&buffer, "JPG", quality);
      if (bytes.size() > kMostBytes && quality > 20) continue;
      QFile file(pictures + QLatin1Char('/') + name + QStringLiteral(".jpg"));
      ASSERT_TRUE(file.open(QIODevice::WriteOnly)) << file.fileName().toStdString();
      file.write(bytes);
      return;
    }
  }

  PlayerState player() const { return bench->robot().status().player; }
  double cursor() const { return bench->robot().status().arm_cursor; }
  // Presses until the motion has got somewhere; a busy machine's watchdogs may stop it on its way.
  bool playUntil(const std::function<bool()>& there) {
    return SimulatedHand::waitFor([&] { return there() || (op->keepPlaying() && there()); }, 180);
  }
  void pause() {
    hand.click(window->motion()->bar()->pauseButton());
    ASSERT_TRUE(SimulatedHand::waitFor([this] { return !bench->play().state().playing; }, 10));
  }
  // One step of 1 mm or 1 degree that the surroundings allow.
  void correct() {
    window->findChild<QDockWidget*>(QStringLiteral("correction"))->raise();
    SimulatedHand::pump(100);
    auto* panel = window->findChild<ui::NudgePanel*>();
    const auto corrected = [this] {
      if (!bench->document().plan()) return false;
      for (const auto& stage : bench->document().plan()->plan.stages) {
        if (stage.name == "correction") return true;
      }
      return false;
    };
    for (const char* way : {"Z\u2212", "Z+", "X+", "Y+"}) {
      for (auto* button : panel->findChildren<QToolButton*>()) {
        if (button->text() != QString::fromUtf8(way) || !button->isEnabled()) continue;
        hand.click(button);
        SimulatedHand::waitFor([this] { return !bench->play().state().correcting; }, 60);
      }
      if (corrected()) return;
    }
    FAIL() << "no correction was possible: " << window->strip()->message().toStdString();
  }
  // As far as the preview of the motion.
  void show(const MacroCase& c) {
    openScenario(c);
    if (HasFatalFailure()) return;
    sketch(c);
    if (HasFatalFailure()) return;
    planIt(c);
    if (HasFatalFailure()) return;
    preview(c);
  }
  void demand(const Status& status) { ASSERT_TRUE(status.ok()) << status.error().message; }

  std::unique_ptr<SimulatedOperator> op;
};

TEST_P(MacroWindow, IsSketchedPlannedPlayedPausedBackedUpCorrectedAndFinished) {
  const MacroCase& c = GetParam();
  show(c);
  if (HasFatalFailure()) return;
  demand(op->resetStop());
  demand(op->openGripper());
  if (bench->play().state().ask) bench->play().acceptAccuracy();
  const double duration = bench->play().state().duration_s;
  ASSERT_TRUE(playUntil([&] { return cursor() > 0.3 * duration; }))
      << window->strip()->message().toStdString();
  pause();
  const double paused = cursor();
  SimulatedHand::pump(400);
  EXPECT_EQ(cursor(), paused) << "a paused arm stands";
  hand.click(window->motion()->bar()->backUpButton());
  EXPECT_TRUE(SimulatedHand::waitFor([&] { return cursor() < paused - 0.15; }, 30));
  pause();
  correct();
  if (HasFatalFailure()) return;
  bench->play().setSpeed(2);
  ASSERT_TRUE(playUntil([this] { return player() == PlayerState::kDone; }))
      << window->strip()->message().toStdString();
  const auto answer = bench->robot().runtime()->callService("/virtual_robot/truth", "{}");
  ASSERT_TRUE(answer.ok()) << answer.error().message;
  EXPECT_TRUE(nlohmann::json::parse(*answer).at("contacts").empty()) << *answer;
}

class MacroPicturesCampaign : public MacroWindow {};

TEST_P(MacroPicturesCampaign, IsSketchedPlannedAndShown) { show(GetParam()); }

std::string nameOf(const ::testing::TestParamInfo<MacroCase>& info) { return info.param.macro; }

INSTANTIATE_TEST_SUITE_P(Groups, MacroWindow, ::testing::ValuesIn(played()), nameOf);
INSTANTIATE_TEST_SUITE_P(Others, MacroPicturesCampaign, ::testing::ValuesIn(shown()), nameOf);

}  // namespace
}  // namespace longarm
