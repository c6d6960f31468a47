#pragma once

/// @file
/// ZoomBar: zoom and focus of the camera that a pane shows live.

#include <QWidget>

#include "ui/workbench.h"

class QLabel;
class QSlider;
class QToolButton;

namespace longarm::ui {

/// Seen while the pane is live and its camera zooms.  Buttons act while they are held; so do Page up and Page down in
/// `keys` (with Shift: focus).  GUI thread only.
class ZoomBar final : public QWidget {
  Q_OBJECT

 public:
  /// @param keys  the picture, whose keys it listens to; borrowed
  ZoomBar(vision::PaneSide side, Workbench& bench, QWidget* keys, QWidget* parent = nullptr);

  /// Whether the pane is live.
  void setLive(bool live);

  QToolButton* wider() const { return m_wider; }
  QToolButton* closer() const { return m_closer; }
  QToolButton* focusItself() const { return m_auto; }
  QSlider* slider() const { return m_slider; }
  QLabel* value() const { return m_value; }

  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  QString camera() const { return m_bench.paneCamera(m_side); }
  QToolButton* heldButton(const QString& text, const QString& tip, void (session::ZoomDrive::*hold)(const QString&, int),
                          int direction);
  void refresh();

  vision::PaneSide m_side;
  Workbench& m_bench;
  bool m_live = false;
  QToolButton *m_wider, *m_closer, *m_near, *m_far, *m_auto;
  QSlider* m_slider;
  QLabel* m_value;
};

}  // namespace longarm::ui
