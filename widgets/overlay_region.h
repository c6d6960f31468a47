#pragma once

/// @file
/// Which part of a widget an overlay covers: a drag repaints that part, not the whole picture under it.

#include <QFontMetricsF>
#include <QRegion>
#include <QSize>

#include "widgets/overlay_painter.h"

namespace longarm::widgets {

/// What must be repainted when `before` gives way to `after`: all that either covers, made of tiles, without the
/// shapes that both hold at the same place of the list.  Never less than what paintOverlay() with the same `look`
/// and `to_widget` would change.  @param metrics of the font the labels are painted in
QRegion changedRegion(const vision::Overlay& before, const vision::Overlay& after, const Theme& theme,
                      const PixelToWidget& to_widget, const OverlayLook& look, const QFontMetricsF& metrics,
                      const QSize& widget);

}  // namespace longarm::widgets
