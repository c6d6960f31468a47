// Colours: contrast, meaning, and that the style sheet names no colour that is not in the theme.
#include <cmath>

#include <QFile>
#include <QRegularExpression>
#include <gtest/gtest.h>

#include "widgets/icon.h"
#include "widgets/theme.h"

namespace longarm::widgets {
namespace {

TEST(Theme, ComputesTheContrastOfKnownPairs) {
  EXPECT_NEAR(contrastRatio(Qt::white, Qt::black), 21, 1e-9);
  EXPECT_NEAR(contrastRatio(QColor(0x77, 0x77, 0x77), Qt::white), 4.48, 0.01);   // the example of WCAG's notes
  EXPECT_DOUBLE_EQ(contrastRatio(Qt::red, Qt::red), 1);
}

TEST(Theme, GivesEveryTextAContrastOfSixOrMore) {
  for (const Theme& theme : {Theme::dark(), Theme::light()}) {
    for (const auto& [text, ground] : theme.textPairs()) {
      EXPECT_GE(contrastRatio(text, ground), 6.0)
          << theme.name.toStdString() << ": " << text.name().toStdString() << " on " << ground.name().toStdString();
    }
  }
}

TEST(Theme, KeepsSaturatedRedForStopAlone) {
  for (const Theme& theme : {Theme::dark(), Theme::light()}) {
    const auto isRed = [](const QColor& c) {
      return c.hsvSaturationF() > 0.6 && c.valueF() > 0.5 && (c.hsvHue() < 15 || c.hsvHue() > 345);
    };
    EXPECT_TRUE(isRed(theme.stop));
    for (const QColor& other : {theme.window, theme.panel, theme.raised, theme.border, theme.text, theme.muted,
                                theme.selection, theme.amber, theme.magenta, theme.neutral, theme.canvas}) {
      EXPECT_FALSE(isRed(other)) << other.name().toStdString();
    }
    for (int role = 0; role <= static_cast<int>(vision::OverlayRole::kOwnLink); ++role) {
      EXPECT_FALSE(isRed(theme.role(static_cast<vision::OverlayRole>(role)).color)) << "role " << role;
    }
  }
}

// Brettel, Vienot & Mollon's dichromat simulation, linear approximation for deuteranopia (Vienot 1999).
QColor asDeuteranope(const QColor& c) {
  const auto lin = [](double v) { return std::pow(v, 2.2); };
  const double r = lin(c.redF()), g = lin(c.greenF()), b = lin(c.blueF());
  const double red_green = 0.29275 * r + 0.70725 * g;
  const double blue = -0.02234 * r + 0.02234 * g + b;
  const auto back = [](double v) { return std::pow(std::min(1.0, std::max(0.0, v)), 1 / 2.2); };
  return QColor::fromRgbF(back(red_green), back(red_green), back(blue));
}

TEST(Theme, KeepsStatusColoursApartForADeuteranope) {
  for (const Theme& theme : {Theme::dark(), Theme::light()}) {
    const QColor status[] = {theme.stop, theme.amber, theme.magenta, theme.selection, theme.neutral};
    for (int i = 0; i < 5; ++i) {
      for (int k = i + 1; k < 5; ++k) {
        const QColor a = asDeuteranope(status[i]), b = asDeuteranope(status[k]);
        const double distance = std::hypot(std::hypot(a.red() - b.red(), a.green() - b.green()), a.blue() - b.blue());
        EXPECT_GT(distance, 40) << theme.name.toStdString() << ": colours " << i << " and " << k;
      }
    }
  }
}

// What the way of the tool is drawn in: apart from one another, and from the ground of the scene.
TEST(Theme, KeepsClearanceColoursApartForADeuteranope) {
  using Band = planning::ClearanceBand;
  const Band bands[] = {Band::kFree, Band::kNear, Band::kTight};
  const auto distance = [](const QColor& a, const QColor& b) {
    return std::hypot(std::hypot(a.red() - b.red(), a.green() - b.green()), a.blue() - b.blue());
  };
  for (int i = 0; i < 3; ++i) {
    const QColor a = asDeuteranope(clearanceColour(bands[i]));
    for (int k = i + 1; k < 3; ++k) EXPECT_GT(distance(a, asDeuteranope(clearanceColour(bands[k]))), 60) << i << " and " << k;
    EXPECT_GT(distance(a, asDeuteranope(Theme::dark().scene_top)), 60) << i;
  }
  const Theme theme = Theme::dark();
  EXPECT_LT(theme.role(vision::OverlayRole::kPath).width, theme.role(vision::OverlayRole::kPathNear).width) << "not by colour alone";
  EXPECT_LT(theme.role(vision::OverlayRole::kPathNear).width, theme.role(vision::OverlayRole::kPathTight).width);
}

TEST(Theme, FillsEveryWordOfTheStyleSheet) {
  for (const Theme& theme : {Theme::dark(), Theme::light()}) {
    const QString sheet = styleSheet(theme);
    EXPECT_FALSE(sheet.isEmpty());
    EXPECT_FALSE(QString(sheet).remove(QRegularExpression(QStringLiteral("/\\*[^*]*\\*/"))).contains(QLatin1Char('@')));
  }
  EXPECT_NE(styleSheet(Theme::dark()), styleSheet(Theme::light()));
}

TEST(Icon, ExistsForActionsAndIsEmptyForOthers) {
  for (const char* action : {"snapshot-take", "tool-line", "transport-play", "edit-undo", "macro-grab-pipe"}) {
    const QIcon drawn = icon(QString::fromLatin1(action), Theme::dark());
    ASSERT_FALSE(drawn.isNull()) << action;
    const QImage image = drawn.pixmap(24).toImage();
    int painted = 0;
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) painted += qAlpha(image.pixel(x, y)) > 128;
    }
    EXPECT_GT(painted, 20) << action;
  }
  EXPECT_TRUE(icon(QStringLiteral("no-such-action"), Theme::dark()).isNull());
}

}  // namespace
}  // namespace longarm::widgets
