// The transport: stages, what must be held, what moves by itself, and the words for it.
#include <gtest/gtest.h>
#include <QLabel>
#include <QLineEdit>
#include <QSettings>
#include <QSignalSpy>
#include <QTest>
#include <QToolButton>

#include "tests/ui/panel_rig.h"
#include "ui/macro_panel.h"
#include "ui/motion_panel.h"
#include "ui/play_settings.h"
#include "ui/simulated_hand.h"

namespace longarm::ui {
namespace {

using tests::PanelRig;
using widgets::TransportBar;

struct Rig : PanelRig {
  QSettings settings{folder.filePath(QStringLiteral("s.ini")), QSettings::IniFormat};
  MotionPanel panel{bench, actions, appearance};
  PlaySettings play_settings{bench, actions, settings};
  QSignalSpy said{&bench, &Workbench::said};
  Rig() { panel.show(); }
  QString badge() const {
    const auto* label = panel.findChild<QLabel*>(QStringLiteral("badge"));
    return label->isVisibleTo(&panel) ? label->text() : QString();
  }
};

TEST(MotionPanel, HoldToRunAndAutoPlayAreOffSaidPlainlyAndRemembered) {
  Rig rig;
  EXPECT_FALSE(rig.actions.at(ActionId::kHoldToRun)->isChecked());
  EXPECT_FALSE(rig.actions.at(ActionId::kAutoPlay)->isChecked());
  EXPECT_TRUE(rig.badge().isEmpty());
  rig.actions.at(ActionId::kAutoPlay)->trigger();
  EXPECT_TRUE(rig.bench.autoPlay());
  EXPECT_EQ(rig.badge(), QStringLiteral("AUTO-PLAY"));
  EXPECT_TRUE(rig.said.last().at(0).toString().contains(QStringLiteral("at once")));
  rig.actions.at(ActionId::kHoldToRun)->trigger();
  EXPECT_TRUE(rig.bench.hand().holdToRun());
  EXPECT_EQ(rig.badge(), QStringLiteral("HOLD TO RUN")) << "it wins over auto-play";
  Workbench later(rig.folder.filePath(QStringLiteral("other")));
  Actions actions(rig.appearance);
  PlaySettings kept(later, actions, rig.settings);
  EXPECT_TRUE(later.autoPlay());
  EXPECT_TRUE(actions.at(ActionId::kHoldToRun)->isChecked());
}

TEST(MotionPanel, AutoPlayIsToldWhereMotionsAreChosen) {
  Rig rig;
  MacroPanel macros(rig.bench, rig.actions, rig.appearance);
  EXPECT_TRUE(macros.outcome().contains(QStringLiteral("before Play")));
  rig.bench.setAutoPlay(true);
  EXPECT_TRUE(macros.outcome().contains(QStringLiteral("as soon as"))) << macros.outcome().toStdString();
  rig.bench.hand().setHoldToRun(true);
  EXPECT_TRUE(macros.outcome().contains(QStringLiteral("before Play")));
}

TEST(MotionPanel, KeysThatMustBeHeldAreToldWhenTheyAreLetGoOf) {
  Rig rig;
  rig.bench.hand().setHoldToRun(true);
  QWidget elsewhere;
  elsewhere.show();
  QTest::keyPress(&elsewhere, Qt::Key_P);
  EXPECT_TRUE(rig.bench.hand().held());
  QTest::keyRelease(&elsewhere, Qt::Key_P);
  EXPECT_FALSE(rig.bench.hand().held());
  QLineEdit field;
  field.show();
  QTest::keyClicks(&field, QStringLiteral("pb"));
  EXPECT_EQ(field.text(), QStringLiteral("pb")) << "text stays text";
  EXPECT_FALSE(rig.bench.hand().held());
  rig.bench.hand().setHoldToRun(false);
  QTest::keyPress(&elsewhere, Qt::Key_P);
  EXPECT_FALSE(rig.bench.hand().held()) << "then it is a shortcut";
}

TEST(MotionPanel, EveryButtonThatMovesSaysWhyItCannot) {
  Rig rig;
  for (const auto key : {TransportBar::Key::kPlay, TransportBar::Key::kBackUp, TransportBar::Key::kStage,
                         TransportBar::Key::kStageBack}) {
    EXPECT_FALSE(rig.panel.bar()->keyButton(key)->isEnabled());
    EXPECT_TRUE(rig.panel.bar()->keyButton(key)->toolTip().contains(QStringLiteral("no plan")));
  }
  for (const auto id : {ActionId::kStage, ActionId::kStageBack})
    EXPECT_FALSE(rig.actions.whyNot(id).isEmpty());
}

}  // namespace
}  // namespace longarm::ui
