#pragma once

/// @file
/// ZoomCurve: focal length over the zoom setting, with the calibrated settings.

#include <QWidget>

#include "ui/appearance.h"
#include "vision/camera/zoom_camera.h"

namespace longarm::ui {

/// The interpolated curve on a logarithmic scale; nodes as dots, nominal ones hollow.  GUI thread only.
class ZoomCurve final : public QWidget {
  Q_OBJECT

 public:
  explicit ZoomCurve(Appearance& appearance, QWidget* parent = nullptr);
  void setTable(const vision::ZoomCamera& table, double setting);
  QSize sizeHint() const override { return {460, 320}; }

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  Appearance& m_appearance;
  vision::ZoomCamera m_table;
  double m_setting = 0;
};

}  // namespace longarm::ui
