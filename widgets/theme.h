#pragma once

/// @file
/// Theme: every colour of the window and of what is drawn over pictures, by meaning.

#include <utility>
#include <vector>

#include <QColor>
#include <QString>

#include "planning/motion/clearance.h"
#include "vision/sketch/pointer_event.h"

class QApplication;

namespace longarm::widgets {

/// Pen of one overlay role.
struct RoleStyle {
  QColor color;
  double width = 1.5;              ///< [screen px], whatever the zoom.
  bool dashed = false;
  bool halo = true;                ///< A dark edge under it, so that it shows on any picture.
};

/// Colours by meaning.  Saturated red means stop or fault and nothing else; amber degraded; magenta lost data;
/// blue selection.  A meaning is never carried by colour alone.
struct Theme {
  QString name;                    ///< "dark" or "light"
  QColor window, panel, raised, border;
  QColor text, muted;              ///< Both are readable on window, panel and raised.
  QColor selection, on_selection;
  QColor stop, on_stop;
  QColor amber, on_amber;
  QColor magenta, on_magenta;
  QColor neutral, on_neutral;      ///< A badge that says "as it should be".
  QColor canvas;                   ///< Around a picture.
  QColor scene_top, scene_bottom;  ///< Background of the 3-D scene.

  RoleStyle role(vision::OverlayRole role) const;
  /// Pairs (foreground, background) of text that occur in the window.
  std::vector<std::pair<QColor, QColor>> textPairs() const;

  static Theme dark();
  static Theme light();
  static Theme byName(const QString& name);      ///< Dark for any other word.
};

/// As scene::clearanceColor().
QColor clearanceColour(planning::ClearanceBand band);

/// Contrast ratio of two colours after WCAG 2.1, 1 ... 21.  Pure function.
double contrastRatio(const QColor& a, const QColor& b);

/// The style sheet of the program in the colours of `theme`.
QString styleSheet(const Theme& theme);
/// Style sheet and palette of the whole program.  GUI thread only.
void applyTheme(QApplication& application, const Theme& theme);

}  // namespace longarm::widgets
