#pragma once

/// @file
/// A window on a scenario of the virtual robot, and what an operator does there with a plan: looks at it, plays, pauses,
/// backs up, corrects and finishes it, all by mouse.

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <QBuffer>
#include <QDockWidget>
#include <QFile>
#include <QToolButton>
#include <nlohmann/json.hpp>

#include "tests/ui/window_fixture.h"
#include "ui/simulated_operator.h"

namespace longarm::tests {

class PlayedWindow : public WindowFixture {
 protected:
  using Points = std::vector<Eigen::Vector3d>;

  static constexpr int kMostBytes = 60000;  // of a picture in the documentation

  void openScenario(const std::string& scenario, const QSize& size = {1280, 800}) {
    openWindow(QStringLiteral("dark"), size);
    ui::RobotChoice choice;
    choice.scenario = QString::fromStdString(scenario);
    bench->openRobot(choice);
    op = std::make_unique<ui::SimulatedOperator>(*window, 0);
    ASSERT_TRUE(ui::SimulatedHand::waitFor([this] { return bench->robot().linkUp(); }, 60)) << bench->robot().status().link_text;
    demand(op->waitForLink(60));
  }
  // Points given in an object's frame, in the world.
  Result<ui::SimulatedOperator::Points> pointsOn(const std::string& object, const Points& points) const {
    const auto now = op->look();
    if (!now) return now.error();
    const auto found = now->objects.find(object);
    if (found == now->objects.end()) return Error{ErrorCode::kNotFound, "no object " + object};
    ui::SimulatedOperator::Points out;
    for (const auto& p : points) out.push_back(found->second * p);
    return out;
  }
  void sketch(ui::ActionId tool, const std::string& object, const Points& points) {
    demand(op->aim([&] { return pointsOn(object, points); }));
    demand(op->takePair());
    const auto there = pointsOn(object, points);
    ASSERT_TRUE(there.ok()) << there.error().message;
    demand(op->mark(tool, *there));
  }
  void planIt(const QString& macro, const std::map<std::string, double>& arguments) {
    for (const auto& [name, value] : arguments) demand(bench->plans().setArgument(macro, QString::fromStdString(name), value));
    bench->plans().setBudget(60);
    demand(op->plan(macro, 120));
  }
  // Along the time bar to three quarters and back: nothing moves.
  void preview(const QString& picture) {
    const auto joints = bench->robot().runtime()->jointState()->positions;
    auto* bar = window->motion()->bar()->timeBar();
    const double there = 0.75 * bar->duration(), y = bar->height() / 3.0;
    hand.drag(bar, {bar->xOf(0), y}, {bar->xOf(there), y});
    EXPECT_NEAR(bench->play().state().cursor_s, there, 0.2);
    keep(picture);
    hand.drag(bar, {bar->xOf(there), y}, {bar->xOf(0), y});
    EXPECT_LT((bench->robot().runtime()->jointState()->positions - joints).cwiseAbs().maxCoeff(), 0.002);
    EXPECT_FALSE(bench->play().state().loaded);
  }
  // As a small JPEG.
  void keep(const QString& name) {
    const QString pictures = qEnvironmentVariable("LONGARM_UI_PICTURES");
    if (pictures.isEmpty()) return;
    window->scene()->view()->requestRender();
    ui::SimulatedHand::pump(600);
    const QImage image = window->screen()->grabWindow(window->winId()).toImage().scaledToWidth(900, Qt::SmoothTransformation);
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

  // Asked anew: what was polled last may be of before a correction.
  planning::PlayerState player() const { return bench->robot().runtime()->status().player; }
  double cursor() const { return bench->robot().runtime()->status().arm_cursor; }
  // Presses until the motion has got somewhere; a busy machine's watchdogs may stop it on its way.
  bool playUntil(const std::function<bool()>& there) {
    return ui::SimulatedHand::waitFor([&] { return there() || (op->keepPlaying() && there()); }, 180);
  }
  std::string whyNot() const {
    return window->strip()->message().toStdString() + " " + bench->play().state().why_not_play.toStdString();
  }
  void pause() {
    hand.click(window->motion()->bar()->pauseButton());
    ASSERT_TRUE(ui::SimulatedHand::waitFor([this] { return !bench->play().state().playing; }, 10));
  }
  bool corrected() const {
    if (!bench->document().plan()) return false;
    const auto& stages = bench->document().plan()->plan.stages;
    return std::any_of(stages.begin(), stages.end(), [](const auto& stage) { return stage.name == "correction"; });
  }
  // One step of 1 mm or 1 degree that the surroundings allow.
  void correct() {
    window->findChild<QDockWidget*>(QStringLiteral("correction"))->raise();
    ui::SimulatedHand::pump(100);
    auto* panel = window->findChild<ui::NudgePanel*>();
    for (const char* way : {"Z\u2212", "Z+", "X+", "Y+"}) {
      for (auto* button : panel->findChildren<QToolButton*>()) {
        if (button->text() != QString::fromUtf8(way) || !button->isEnabled()) continue;
        hand.click(button);
        ui::SimulatedHand::waitFor([this] { return !bench->play().state().correcting; }, 60);
      }
      if (corrected()) return;
    }
    FAIL() << "no correction was possible: " << window->strip()->message().toStdString();
  }
  // Plays the plan on the table a part of its way, pauses, backs up a little, and corrects.
  void playAndCorrect() {
    if (bench->play().state().ask) bench->play().acceptAccuracy();
    ASSERT_NE(bench->document().plan()->plan.go, "no_go") << whyNot();
    const double duration = bench->play().state().duration_s;
    ASSERT_TRUE(playUntil([&] { return cursor() > 0.3 * duration; })) << whyNot();
    pause();
    const double paused = cursor();
    ui::SimulatedHand::pump(400);
    EXPECT_EQ(cursor(), paused) << "a paused arm stands";
    hand.click(window->motion()->bar()->backUpButton());
    EXPECT_TRUE(ui::SimulatedHand::waitFor([&] { return cursor() < paused - 0.15; }, 30));
    pause();
    correct();
  }
  void finish() {
    bench->play().setSpeed(2);
    ASSERT_TRUE(playUntil([this] { return player() == planning::PlayerState::kDone; })) << whyNot();
  }
  Eigen::Vector3d toolNow() const {
    const auto& cell = *bench->document().workcell();
    Eigen::VectorXd q = cell.model->neutral();
    cell.model->assign(*bench->robot().runtime()->jointState(), q);
    return cell.model->forward(q, *cell.model->linkIndex(cell.arm.tip_link)).translation();
  }
  nlohmann::json judge() const {
    const auto answer = bench->robot().runtime()->callService("/virtual_robot/truth", "{}");
    EXPECT_TRUE(answer.ok()) << answer.error().message;
    return answer ? nlohmann::json::parse(*answer) : nlohmann::json::object();
  }
  // What touched what, but for the robot with these objects.
  std::vector<std::string> contacts(const std::set<std::string>& but_with = {}) const {
    std::vector<std::string> out;
    const nlohmann::json told = judge();   // lives through the loop
    for (const auto& contact : told.at("contacts")) {
      const std::string a = contact.at("a"), b = contact.at("b");
      if (but_with.count(a) == 0 && but_with.count(b) == 0) out.push_back(a + " and " + b);
    }
    return out;
  }
  void demand(const Status& status) { ASSERT_TRUE(status.ok()) << status.error().message; }

  std::unique_ptr<ui::SimulatedOperator> op;
};

}  // namespace longarm::tests
