// The motions of the selection, their settings, and what is told of a plan.
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFocusEvent>
#include <QPushButton>
#include <QSettings>
#include <QTemporaryDir>
#include <QToolButton>
#include <gtest/gtest.h>

#include "session/commands/sketch_commands.h"
#include "tests/session/synthetic_views.h"
#include "ui/macro_memory.h"
#include "ui/macro_panel.h"

namespace longarm::ui {
namespace {

using vision::FeatureKind;
using vision::PaneSide;

class MacroPanelTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto workcell = planning::loadBuiltInWorkcell();
    ASSERT_TRUE(workcell.ok()) << workcell.error().message;
    bench.setWorkcell(std::make_shared<const planning::Workcell>(std::move(*workcell)));
    panel = std::make_unique<MacroPanel>(bench, actions, appearance);
    panel->resize(520, 260);
    panel->show();
  }

  void select(FeatureKind kind, const std::vector<Eigen::Vector3d>& points, bool measured = true) {
    if (bench.document().snapshots().empty()) {
      bench.history().push(session::addSnapshots(bench.document(), {tests::snapshotOf(1, scene.left), tests::snapshotOf(2, scene.right)}));
    }
    session::SketchItem item;
    item.id = bench.document().nextFeatureId();
    item.kind = kind;
    item.name = "mark";
    for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
      if (side == PaneSide::kRight && !measured) continue;
      for (std::size_t i = 0; i < points.size(); ++i) {
        item.setPick(bench.document().paneSnapshotId(side), static_cast<int>(i), {scene.pixel(side, points[i]), session::PickState::kFree});
      }
    }
    bench.history().push(session::addItem(item));
    bench.document().select(session::Selection::of(item.id));
  }
  /// Files named by LONGARM_UI_PICTURES, for looking at the panel.
  void look(const char* name) const {
    const QString to = qEnvironmentVariable("LONGARM_UI_PICTURES");
    QCoreApplication::processEvents();
    if (!to.isEmpty()) panel->grab().save(to + QLatin1Char('/') + QLatin1String(name) + QStringLiteral(".png"));
  }
  QPushButton* button(const char* name) const { return panel->button(QString::fromLatin1(name)); }
  bool shown(const char* name) const { return button(name)->isVisibleTo(panel.get()); }

  QTemporaryDir folder;
  Appearance appearance{QStringLiteral("dark")};
  Workbench bench{folder.filePath(QStringLiteral("autosave"))};
  Actions actions{appearance};
  std::unique_ptr<MacroPanel> panel;
  tests::StereoScene scene;
};

TEST_F(MacroPanelTest, ShowsExactlyWhatTakesTheSelection) {
  EXPECT_TRUE(shown("home"));
  EXPECT_FALSE(shown("touch"));
  select(FeatureKind::kPoint, {scene.a});
  for (const char* name : {"touch", "look_at", "move_above", "place_here"}) EXPECT_TRUE(shown(name)) << name;
  for (const char* name : {"home", "grab_pipe", "surface_scan", "push_face"}) EXPECT_FALSE(shown(name)) << name;
  select(FeatureKind::kLine, {scene.a, scene.b});
  for (const char* name : {"grab_pipe", "move_around_axis", "place_disruptor", "extract_along"}) EXPECT_TRUE(shown(name)) << name;
  EXPECT_FALSE(shown("touch"));
  look("macro_line");
  bench.document().select({});
  EXPECT_TRUE(shown("home"));
}

TEST_F(MacroPanelTest, TakesFewerColumnsWhereItIsNarrow) {
  select(FeatureKind::kLine, {scene.a, scene.b});
  EXPECT_LE(panel->minimumSizeHint().width(), 400) << "it shares 1280 px with two others";
  const auto threeInARow = [this](int width) {
    panel->resize(width, 400);
    QCoreApplication::processEvents();
    return button("grab_pipe")->y() == button("approach_from_side")->y();
  };
  EXPECT_TRUE(threeInARow(900));
  EXPECT_FALSE(threeInARow(400));
  for (const char* name : {"grab_pipe", "move_around_axis", "extract_along"}) EXPECT_LE(button(name)->geometry().right(), panel->width()) << name;
}

TEST_F(MacroPanelTest, SaysWhyWhatIsShownCannotBeDone) {
  select(FeatureKind::kPoint, {scene.a}, false);
  EXPECT_TRUE(shown("touch"));
  EXPECT_FALSE(button("touch")->isEnabled());
  EXPECT_TRUE(button("touch")->toolTip().contains(QStringLiteral("Not now"))) << button("touch")->toolTip().toStdString();
}

TEST_F(MacroPanelTest, MarksWhatIsKnownLessWellThanNeeded) {
  select(FeatureKind::kPoint, {scene.a});
  EXPECT_TRUE(button("touch")->text().contains(QStringLiteral("ask")) || button("touch")->text().contains(QStringLiteral("no go")))
      << button("touch")->text().toStdString();
  EXPECT_EQ(button("look_at")->text(), QStringLiteral("Look At"));
  EXPECT_TRUE(button("touch")->toolTip().contains(QStringLiteral("95 %")));
}

TEST_F(MacroPanelTest, TheFormShowsMillimetresAndWritesMetres) {
  select(FeatureKind::kPoint, {scene.a});
  button("touch")->click();
  EXPECT_TRUE(panel->form()->macro().isEmpty()) << "it cannot be planned without a robot, nor set up by a disabled button";
  QFocusEvent focus(QEvent::FocusIn, Qt::TabFocusReason);
  QCoreApplication::sendEvent(button("touch"), &focus);
  ASSERT_EQ(panel->form()->macro(), QStringLiteral("touch"));
  QDoubleSpinBox* stand_off = panel->form()->number(QStringLiteral("stand_off"));
  ASSERT_NE(stand_off, nullptr);
  EXPECT_EQ(stand_off->value(), 100);
  EXPECT_EQ(stand_off->suffix(), QStringLiteral(" mm"));
  EXPECT_EQ(stand_off->minimum(), 20);
  EXPECT_EQ(stand_off->maximum(), 500);
  EXPECT_FALSE(panel->form()->defaultsButton()->isEnabled());
  look("macro_form");
  stand_off->setValue(125);
  EXPECT_NEAR(bench.plans().arguments(QStringLiteral("touch")).at("stand_off"), 0.125, 1e-12);
  QComboBox* from = panel->form()->choice(QStringLiteral("from"));
  ASSERT_NE(from, nullptr);
  from->setCurrentIndex(1);
  EXPECT_EQ(bench.plans().arguments(QStringLiteral("touch")).at("from"), 1);
  EXPECT_TRUE(panel->form()->defaultsButton()->isEnabled());
  panel->form()->defaultsButton()->click();
  EXPECT_EQ(stand_off->value(), 100);
  EXPECT_EQ(from->currentIndex(), 0);
}

TEST_F(MacroPanelTest, EveryParameterOfEveryMacroCanBeSetToItsLimits) {
  MacroForm form(bench.plans());
  for (const auto& row : bench.plans().macros()) {
    form.setMacro(row);
    for (const auto& parameter : row.parameters) {
      const QString name = QString::fromStdString(parameter.name);
      if (auto* box = form.number(name)) {
        for (const double end : {box->minimum(), box->maximum()}) {
          box->setValue(end);
          const double value = bench.plans().arguments(row.name).at(parameter.name);
          EXPECT_NEAR(value, end == box->minimum() ? parameter.lower : parameter.upper, 1e-3) << row.name.toStdString() << " " << parameter.name;
        }
      } else {
        ASSERT_NE(form.choice(name), nullptr) << parameter.name;
        EXPECT_EQ(form.choice(name)->count(), static_cast<int>(parameter.upper - parameter.lower) + 1) << row.name.toStdString() << " " << parameter.name;
      }
    }
  }
}

TEST_F(MacroPanelTest, SettingsAreRememberedFromRunToRun) {
  QSettings settings(folder.filePath(QStringLiteral("s.ini")), QSettings::IniFormat);
  {
    MacroMemory memory(bench.plans(), settings);
    ASSERT_TRUE(bench.plans().setArgument(QStringLiteral("touch"), QStringLiteral("gap"), 0.015).ok());
    ASSERT_TRUE(bench.plans().setArgument(QStringLiteral("surface_scan"), QStringLiteral("swath"), 0.05).ok());
    bench.plans().resetArguments(QStringLiteral("surface_scan"));
  }
  bench.plans().setSettings({});
  settings.setValue(QStringLiteral("macros/touch/stand_off"), QStringLiteral("much"));
  MacroMemory memory(bench.plans(), settings);
  EXPECT_EQ(bench.plans().arguments(QStringLiteral("touch")).at("gap"), 0.015);
  EXPECT_EQ(bench.plans().arguments(QStringLiteral("touch")).at("stand_off"), 0.10) << "what is no number is not taken";
  EXPECT_EQ(bench.plans().settings().count("surface_scan"), 0u);
}

TEST_F(MacroPanelTest, TellsCodeStageSentenceAndAdviceOfAFailure) {
  session::PlanRecord record;
  record.macro = "touch";
  record.plan.status = planning::PlanStatus::kApproachBlocked;
  record.plan.reason = "The stage stops after 40 % of its way.";
  record.plan.failed_stage = "approach";
  record.plan.advice = {"Drive 0.20 m forwards."};
  bench.document().setPlan(record);
  look("macro_refused");
  const QString told = panel->outcome();
  for (const char* part : {"approach blocked", "\u201capproach\u201d", "stops after 40 %", "What would help", "Drive 0.20 m forwards."}) {
    EXPECT_TRUE(told.contains(QString::fromUtf8(part))) << part << " is not in: " << told.toStdString();
  }
}

TEST_F(MacroPanelTest, TellsTheStagesOfAPlan) {
  session::PlanRecord record;
  record.macro = "touch";
  record.plan.status = planning::PlanStatus::kOk;
  record.plan.stages = {{"transit", 0, 3.2, false}, {"approach", 3.2, 5.7, true}};
  record.plan.notes = {"The gripper's ends touch first."};
  bench.document().setPlan(record);
  EXPECT_TRUE(panel->outcome().contains(QStringLiteral("transit 3.2 s \u2192 approach 2.5 s"))) << panel->outcome().toStdString();
  EXPECT_TRUE(panel->outcome().contains(QStringLiteral("ends touch first")));
}

}  // namespace
}  // namespace longarm::ui
