#pragma once

/// @file
/// CamerasPanel: the strip of live thumbnails.

#include <QWidget>

#include "ui/appearance.h"
#include "ui/workbench.h"
#include "widgets/camera_strip.h"

class QLabel;
class QScrollArea;

namespace longarm::ui {

/// GUI thread only.
class CamerasPanel final : public QWidget {
  Q_OBJECT

 public:
  CamerasPanel(Workbench& bench, Appearance& appearance, QWidget* parent = nullptr);
  ~CamerasPanel() override;
  widgets::CameraStrip* strip() const { return m_strip; }

 Q_SIGNALS:
  void chosen(const QString& camera, longarm::vision::PaneSide side);

 private:
  void rebuild();
  void refreshAges();
  void refreshHealth();
  void bindKeys();
  void chooseNumber(int number, vision::PaneSide side);

  Workbench& m_bench;
  widgets::CameraStrip* m_strip;
  QScrollArea* m_scroll;
  QLabel* m_empty;
  std::vector<QString> m_cameras;
  int m_observer = 0;
};

}  // namespace longarm::ui
