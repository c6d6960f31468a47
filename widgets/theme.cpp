#include "widgets/theme.h"

#include <cmath>

#include <QApplication>
#include <QFile>
#include <QPalette>

#include "widgets/scene/clearance_look.h"

namespace longarm::widgets {

namespace {

double linear(double channel) {
  return channel <= 0.04045 ? channel / 12.92 : std::pow((channel + 0.055) / 1.055, 2.4);
}

double luminance(const QColor& color) {
  return 0.2126 * linear(color.redF()) + 0.7152 * linear(color.greenF()) + 0.0722 * linear(color.blueF());
}

QColor mixed(const QColor& a, const QColor& b, double share_of_b) {
  const auto mix = [&](double x, double y) { return x + (y - x) * share_of_b; };
  return QColor::fromRgbF(mix(a.redF(), b.redF()), mix(a.greenF(), b.greenF()), mix(a.blueF(), b.blueF()));
}

}  // namespace

Theme Theme::dark() {
  Theme t;
  t.name = QStringLiteral("dark");
  t.window = QColor(0x22, 0x26, 0x2a);
  t.panel = QColor(0x2b, 0x30, 0x35);
  t.raised = QColor(0x36, 0x3c, 0x42);
  t.border = QColor(0x55, 0x5d, 0x65);
  t.text = QColor(0xee, 0xf0, 0xf2);
  t.muted = QColor(0xc3, 0xc9, 0xcf);
  t.selection = QColor(0x1d, 0x4f, 0x86);
  t.on_selection = QColor(0xff, 0xff, 0xff);
  t.stop = QColor(0xb8, 0x0c, 0x17);
  t.on_stop = QColor(0xff, 0xff, 0xff);
  t.amber = QColor(0xff, 0xb0, 0x00);
  t.on_amber = QColor(0x14, 0x14, 0x14);
  t.magenta = QColor(0xff, 0x8a, 0xe6);
  t.on_magenta = QColor(0x1e, 0x05, 0x19);
  t.neutral = QColor(0x45, 0x4c, 0x53);
  t.on_neutral = QColor(0xff, 0xff, 0xff);
  t.canvas = QColor(0x15, 0x17, 0x19);
  t.scene_top = QColor(0x3a, 0x42, 0x4a);
  t.scene_bottom = QColor(0x1c, 0x20, 0x24);
  return t;
}

Theme Theme::light() {
  Theme t;
  t.name = QStringLiteral("light");
  t.window = QColor(0xdf, 0xe2, 0xe5);
  t.panel = QColor(0xec, 0xee, 0xf0);
  t.raised = QColor(0xf9, 0xfa, 0xfb);
  t.border = QColor(0x93, 0x9b, 0xa3);
  t.text = QColor(0x14, 0x17, 0x1a);
  t.muted = QColor(0x3f, 0x46, 0x4d);
  t.selection = QColor(0x0b, 0x4f, 0x96);
  t.on_selection = QColor(0xff, 0xff, 0xff);
  t.stop = QColor(0xb8, 0x0c, 0x17);
  t.on_stop = QColor(0xff, 0xff, 0xff);
  t.amber = QColor(0xff, 0xb0, 0x00);
  t.on_amber = QColor(0x14, 0x14, 0x14);
  t.magenta = QColor(0x8f, 0x00, 0x70);
  t.on_magenta = QColor(0xff, 0xff, 0xff);
  t.neutral = QColor(0xc6, 0xcc, 0xd2);
  t.on_neutral = QColor(0x14, 0x17, 0x1a);
  t.canvas = QColor(0xb4, 0xba, 0xc0);
  t.scene_top = QColor(0xd6, 0xde, 0xe6);
  t.scene_bottom = QColor(0x98, 0xa4, 0xb0);
  return t;
}

QColor clearanceColour(planning::ClearanceBand band) {
  const Eigen::Vector3d rgb = scene::clearanceColor(band);
  return QColor::fromRgbF(rgb[0], rgb[1], rgb[2]);
}

Theme Theme::byName(const QString& name) { return name == QLatin1String("light") ? light() : dark(); }

// Pictures are not themed, so what is drawn over them is the same in both themes.
RoleStyle Theme::role(vision::OverlayRole role) const {
  using vision::OverlayRole;
  using Band = planning::ClearanceBand;
  switch (role) {
    case OverlayRole::kSketch: return {QColor(0xf4, 0xf6, 0xf8), 1.6, false, true};
    case OverlayRole::kSelected: return {QColor(0x4f, 0xb9, 0xff), 2.4, false, true};
    case OverlayRole::kHandle: return {QColor(0xff, 0xff, 0xff), 1.6, false, true};
    case OverlayRole::kActiveHandle: return {QColor(0x4f, 0xb9, 0xff), 2.2, false, true};
    case OverlayRole::kUnplaced: return {QColor(0xff, 0xd2, 0x3f), 1.6, true, true};
    case OverlayRole::kEpipolar: return {QColor(0xff, 0xd2, 0x3f), 1.2, false, true};
    case OverlayRole::kDepthTick: return {QColor(0xff, 0xd2, 0x3f), 1.2, false, true};
    case OverlayRole::kMiss: return {QColor(0xff, 0x8a, 0xe6), 2.0, false, true};
    case OverlayRole::kEllipse: return {QColor(0x4f, 0xb9, 0xff), 1.2, false, true};
    case OverlayRole::kPath: return {clearanceColour(Band::kFree), 2.4, false, true};
    case OverlayRole::kPathNear: return {clearanceColour(Band::kNear), 3.2, false, true};
    case OverlayRole::kPathTight: return {clearanceColour(Band::kTight), 4.2, false, true};
    case OverlayRole::kPathOccluded: return {QColor(0x5c, 0xf0, 0x8c), 1.4, true, true};
    case OverlayRole::kWarning: return {QColor(0xff, 0xb0, 0x00), 2.0, false, true};
    case OverlayRole::kLabel: return {QColor(0xff, 0xff, 0xff), 1.4, false, true};
    case OverlayRole::kBand: return {QColor(0xff, 0xd2, 0x3f), 1.0, false, false};
    case OverlayRole::kMatch: return {QColor(0x7d, 0xf2, 0xe0), 2.2, true, true};
    case OverlayRole::kRival: return {QColor(0x7d, 0xf2, 0xe0), 1.2, true, true};
    case OverlayRole::kSolid: return {QColor(0xf4, 0xf6, 0xf8), 1.0, true, false};
    case OverlayRole::kWorld: return {QColor(0xc3, 0x9b, 0xff), 1.4, false, true};
    case OverlayRole::kKeepOut: return {QColor(0xff, 0x8c, 0x7e), 1.6, false, true};
    case OverlayRole::kWorkspace: return {QColor(0x6f, 0xc8, 0xff), 1.6, true, true};
    case OverlayRole::kOwnLink: return {QColor(0xc8, 0xd4, 0xe0), 1.0, false, false};
    case OverlayRole::kDimension: return {QColor(0xff, 0xe0, 0xa8), 1.6, true, true};
  }
  return {};
}

std::vector<std::pair<QColor, QColor>> Theme::textPairs() const {
  return {{text, window}, {text, panel}, {text, raised}, {muted, window}, {muted, panel}, {muted, raised},
          {on_selection, selection}, {on_stop, stop}, {on_amber, amber}, {on_magenta, magenta},
          {on_neutral, neutral}, {text, canvas}};
}

double contrastRatio(const QColor& a, const QColor& b) {
  const double first = luminance(a) + 0.05;
  const double second = luminance(b) + 0.05;
  return first > second ? first / second : second / first;
}

QString styleSheet(const Theme& theme) {
  QFile file(QStringLiteral(":/styles/console.qss"));
  if (!file.open(QIODevice::ReadOnly)) return {};
  QString sheet = QString::fromUtf8(file.readAll());
  const std::pair<const char*, QColor> tokens[] = {
      {"@window", theme.window}, {"@panel", theme.panel}, {"@raised", theme.raised},
      {"@hover", mixed(theme.raised, theme.text, 0.12)}, {"@pressed", mixed(theme.raised, theme.text, 0.25)},
      {"@border", theme.border}, {"@text", theme.text}, {"@muted", theme.muted},
      {"@disabled", mixed(theme.panel, theme.text, 0.55)},
      {"@selection", theme.selection}, {"@on_selection", theme.on_selection},
      {"@stop", theme.stop}, {"@on_stop", theme.on_stop}, {"@amber", theme.amber}, {"@on_amber", theme.on_amber},
      {"@magenta", theme.magenta}, {"@on_magenta", theme.on_magenta},
      {"@neutral", theme.neutral}, {"@on_neutral", theme.on_neutral}};
  // Longer names hold shorter ones ("@on_stop" holds none, "@text" none): each token ends at a semicolon or blank.
  for (const auto& [token, color] : tokens) {
    for (const char* end : {";", " ", ","}) {
      sheet.replace(QLatin1String(token) + QLatin1String(end), color.name() + QLatin1String(end));
    }
  }
  return sheet;
}

void applyTheme(QApplication& application, const Theme& theme) {
  QPalette palette;
  palette.setColor(QPalette::Window, theme.window);
  palette.setColor(QPalette::WindowText, theme.text);
  palette.setColor(QPalette::Base, theme.panel);
  palette.setColor(QPalette::AlternateBase, theme.raised);
  palette.setColor(QPalette::Text, theme.text);
  palette.setColor(QPalette::Button, theme.raised);
  palette.setColor(QPalette::ButtonText, theme.text);
  palette.setColor(QPalette::ToolTipBase, theme.raised);
  palette.setColor(QPalette::ToolTipText, theme.text);
  palette.setColor(QPalette::Highlight, theme.selection);
  palette.setColor(QPalette::HighlightedText, theme.on_selection);
  palette.setColor(QPalette::PlaceholderText, theme.muted);
  application.setPalette(palette);
  application.setStyleSheet(styleSheet(theme));
}

}  // namespace longarm::widgets
