// Space and Pause stop the robot wherever the focus is.
#include <QDialog>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalSpy>
#include <QTest>
#include <QVBoxLayout>
#include <gtest/gtest.h>

#include "ui/stop_keys.h"

namespace longarm::ui {
namespace {

struct Rig {
  bool armed = true;
  StopKeys keys{[this] { return armed; }};
  QSignalSpy spy{&keys, &StopKeys::stopPressed};
  QWidget window;
  QLineEdit* field = new QLineEdit(&window);
  QPushButton* button = new QPushButton(QStringLiteral("b"), &window);

  Rig() {
    auto* column = new QVBoxLayout(&window);
    column->addWidget(field);
    column->addWidget(button);
    window.show();
    window.activateWindow();
  }
};

TEST(StopKeys, SpaceStopsFromATextFieldAndTypesNothingWhileTheArmCanMove) {
  Rig rig;
  rig.field->setFocus();
  QTest::keyClicks(rig.field, QStringLiteral("a b"));
  EXPECT_EQ(rig.field->text(), QStringLiteral("ab"));
  EXPECT_EQ(rig.spy.count(), 1);
}

TEST(StopKeys, SpaceIsABlankInATextFieldWhileNothingCanMove) {
  Rig rig;
  rig.armed = false;
  rig.field->setFocus();
  QTest::keyClicks(rig.field, QStringLiteral("a b"));
  EXPECT_EQ(rig.field->text(), QStringLiteral("a b"));
  EXPECT_EQ(rig.spy.count(), 0);
}

TEST(StopKeys, SpaceNeverPressesTheButtonThatHasTheFocus) {
  for (const bool armed : {true, false}) {
    Rig rig;
    rig.armed = armed;
    QSignalSpy clicked(rig.button, &QPushButton::clicked);
    rig.button->setFocus();
    QTest::keyClick(rig.button, Qt::Key_Space);
    EXPECT_EQ(clicked.count(), 0);
    EXPECT_EQ(rig.spy.count(), 1);
  }
}

TEST(StopKeys, PauseStopsAlways) {
  Rig rig;
  rig.armed = false;
  rig.field->setFocus();
  QTest::keyClick(rig.field, Qt::Key_Pause);
  EXPECT_EQ(rig.spy.count(), 1);
}

TEST(StopKeys, AKeyHeldDownStopsOnce) {
  Rig rig;
  QTest::keyPress(rig.button, Qt::Key_Space);
  for (int i = 0; i < 5; ++i) {
    QKeyEvent repeated(QEvent::KeyPress, Qt::Key_Space, Qt::NoModifier, QStringLiteral(" "), true);
    QApplication::sendEvent(rig.button, &repeated);
  }
  EXPECT_EQ(rig.spy.count(), 1);
}

TEST(StopKeys, WorkWithADialogOpen) {
  Rig rig;
  QDialog dialog(&rig.window);
  QLineEdit name(&dialog);
  dialog.show();
  name.setFocus();
  QTest::keyClick(&name, Qt::Key_Space);
  EXPECT_EQ(rig.spy.count(), 1);
  EXPECT_TRUE(name.text().isEmpty());
}

TEST(StopKeys, LeaveOtherKeysAlone) {
  Rig rig;
  rig.field->setFocus();
  QTest::keyClicks(rig.field, QStringLiteral("xyz"));
  EXPECT_EQ(rig.field->text(), QStringLiteral("xyz"));
  EXPECT_EQ(rig.spy.count(), 0);
}

}  // namespace
}  // namespace longarm::ui
