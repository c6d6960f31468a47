// A door opened, a valve turned, a drawer pulled by their templates in the real window on the virtual robot: marked, dropped,
// their action pressed; every motion looked at, played, paused, backed up, corrected and finished by mouse.
#include <cmath>

#include <QComboBox>
#include <QPushButton>

#include "tests/ui/played_window.h"

namespace longarm {
namespace {

using Eigen::Vector3d;
using ui::ActionId;
using ui::SimulatedHand;

struct TemplateCase {
  const char *name, *action, *scenario;
  ActionId tool;
  const char* object;            // whose frame the points are in
  std::vector<Vector3d> points;  // [m]
  const char* mechanism;         // what the judge sees move ...
  double by, within;             // ... and how far [rad or m]
};

void PrintTo(const TemplateCase& c, std::ostream* out) { *out << c.name << " in " << c.scenario; }

class TemplateWindow : public tests::PlayedWindow, public ::testing::WithParamInterface<TemplateCase> {
 protected:
  void drop(const QString& name) {
    auto* panel = window->templates();
    window->findChild<QDockWidget*>(QStringLiteral("templates"))->raise();
    SimulatedHand::pump(100);
    panel->kinds()->setCurrentIndex(panel->kinds()->findData(name));
    Q_EMIT panel->kinds()->activated(panel->kinds()->currentIndex());
    ASSERT_TRUE(panel->dropButton()->isEnabled()) << panel->dropButton()->toolTip().toStdString();
    hand.click(panel->dropButton());
    ASSERT_EQ(bench->world().items().size(), 1u);
  }
  void press(const QString& action) {
    window->findChild<QDockWidget*>(QStringLiteral("templates"))->raise();
    auto* button = window->templates()->actionButton(action);
    ASSERT_NE(button, nullptr);
    ASSERT_TRUE(SimulatedHand::waitFor([&] { return button->isEnabled(); }, 20)) << button->toolTip().toStdString();
    hand.click(button);
    ASSERT_TRUE(bench->templates().running()) << whyNot();
  }
  // A motion of the action that waits for Play; none: the action has ended.
  bool shown() {
    const auto waits = [this] {
      const auto& plan = bench->document().plan();
      return bench->plans().state() == session::PlanController::State::kIdle && plan && plan->plan.ok() && plan->id != m_done;
    };
    SimulatedHand::waitFor([&] { return waits() || !bench->templates().running(); }, 120);
    return bench->templates().running() && waits();
  }

  PlanId m_done;
};

TEST_P(TemplateWindow, IsDroppedPlannedPlayedPausedBackedUpCorrectedAndFinished) {
  const TemplateCase& c = GetParam();
  openScenario(c.scenario);
  if (!HasFatalFailure()) sketch(c.tool, c.object, c.points);
  if (!HasFatalFailure()) drop(QString::fromLatin1(c.name));
  if (HasFatalFailure()) return;
  bench->plans().setBudget(60);
  demand(op->resetStop());
  press(QString::fromLatin1(c.action));
  int motions = 0;
  for (; motions < 3 && shown() && !HasFatalFailure(); ++motions) {
    preview(QString::fromLatin1(c.name) + QString::number(motions + 1));
    playAndCorrect();
    if (HasFatalFailure()) return;
    EXPECT_TRUE(bench->templates().running()) << "a correction is part of the motion: " << whyNot();
    finish();
    m_done = bench->document().plan()->id;
  }
  EXPECT_EQ(motions, 2) << "to the handle, and with it: " << whyNot();
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return !bench->templates().running(); }, 10)) << bench->templates().progress().toStdString();
  const auto told = judge();
  EXPECT_NEAR(told.at("mechanisms").at(c.mechanism).get<double>(), c.by, c.within) << whyNot();
  EXPECT_FALSE(told.at("held").get<std::string>().empty());
  EXPECT_TRUE(contacts().empty()) << told.dump();
}

INSTANTIATE_TEST_SUITE_P(
    Every, TemplateWindow,
    ::testing::Values(
        TemplateCase{"door", "open", "open_door", ActionId::kToolPlane, "door", {{-0.01, 0.225, 0.2}, {-0.01, 0.225, -0.2}, {-0.01, -0.225, -0.2}}, "door_hinge", 0.6, 0.05},
        TemplateCase{"valve", "turn", "turn_valve", ActionId::kToolPoint, "hub", {{0, 0, -0.02}}, "wheel", 0.6, 0.08},
        TemplateCase{"drawer", "pull", "pull_drawer", ActionId::kToolPlane, "front", {{-0.01, 0.22, 0.09}, {-0.01, 0.22, -0.09}, {-0.01, -0.22, -0.09}}, "drawer", 0.12, 0.02}),
    [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace longarm
