// Every action: icon, tooltip with its key, reason when disabled; no key means two things.
#include <map>

#include <QFile>
#include <QTest>
#include <gtest/gtest.h>

#include "ui/actions.h"
#include "ui/shortcut_sheet.h"

namespace longarm::ui {
namespace {

struct Rig {
  Appearance appearance{QStringLiteral("dark")};
  Actions actions{appearance};
};

TEST(Actions, EachHasATextATipAndTheIconItNames) {
  Rig rig;
  for (const auto& spec : actionTable()) {
    const QAction* action = rig.actions.at(spec.id);
    EXPECT_FALSE(action->text().isEmpty());
    EXPECT_FALSE(action->toolTip().isEmpty()) << spec.text;
    if (*spec.icon == '\0') continue;
    EXPECT_TRUE(QFile::exists(QStringLiteral(":/icons/%1.svg").arg(QString::fromLatin1(spec.icon)))) << spec.icon;
    EXPECT_FALSE(action->icon().isNull()) << spec.text;
  }
}

TEST(Actions, NoKeyMeansTwoThingsAndSpaceAndDigitsAreTaken) {
  Rig rig;
  std::map<QString, QString> owner{{QStringLiteral("Space"), QStringLiteral("STOP")}, {QStringLiteral("Pause"), QStringLiteral("STOP")}};
  for (int digit = 1; digit <= 9; ++digit) {
    owner[QString::number(digit)] = QStringLiteral("camera");
    owner[QStringLiteral("Alt+%1").arg(digit)] = QStringLiteral("camera");
  }
  for (const auto& spec : actionTable()) {
    for (const auto& key : rig.actions.at(spec.id)->shortcuts()) {
      const QString text = key.toString(QKeySequence::PortableText);
      ASSERT_FALSE(text.isEmpty()) << spec.text << " names a key that Qt does not know: " << spec.keys;
      EXPECT_EQ(owner.count(text), 0U) << text.toStdString() << " is " << spec.text << " and " << owner[text].toStdString();
      owner[text] = QString::fromLatin1(spec.text);
    }
  }
}

TEST(Actions, EveryWordOfTheKeyTableBecameAKey) {
  Rig rig;
  for (const auto& spec : actionTable()) {
    const int words = QString::fromLatin1(spec.keys).split(QLatin1Char(' '), Qt::SkipEmptyParts).size();
    EXPECT_EQ(rig.actions.at(spec.id)->shortcuts().size(), words) << spec.keys;
  }
}

TEST(Actions, ADisabledOneSaysWhyAndForgetsItWhenEnabled) {
  Rig rig;
  QAction* action = rig.actions.at(ActionId::kTakePair);
  const QString before = action->toolTip();
  EXPECT_TRUE(before.contains(QStringLiteral("Ctrl+T"))) << before.toStdString();
  rig.actions.setWhyNot(ActionId::kTakePair, QStringLiteral("The link is <lost>."));
  EXPECT_FALSE(action->isEnabled());
  EXPECT_TRUE(action->toolTip().contains(QStringLiteral("The link is &lt;lost&gt;."))) << "told text is no markup";
  rig.actions.setWhyNot(ActionId::kTakePair, {});
  EXPECT_TRUE(action->isEnabled());
  EXPECT_EQ(action->toolTip(), before);
}

TEST(Actions, TakeTheColoursOfANewTheme) {
  Rig rig;
  const auto pixel = [&] { return rig.actions.at(ActionId::kUndo)->icon().pixmap(24, 24).toImage(); };
  const QImage dark = pixel();
  rig.appearance.setTheme(QStringLiteral("light"));
  EXPECT_NE(pixel(), dark);
}

TEST(ShortcutSheet, NamesEveryKeyOfEveryAction) {
  Rig rig;
  const QString page = shortcutPage(rig.actions);
  for (const auto& spec : actionTable()) {
    for (const auto& key : rig.actions.at(spec.id)->shortcuts()) {
      EXPECT_TRUE(page.contains(key.toString(QKeySequence::NativeText).toHtmlEscaped())) << spec.text;
    }
  }
  EXPECT_TRUE(page.contains(QStringLiteral("STOP")));
}

}  // namespace
}  // namespace longarm::ui
