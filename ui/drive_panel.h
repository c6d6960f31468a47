#pragma once

/// @file
/// DrivePanel: drives the base while a button or key is held.

#include <map>
#include <optional>

#include "session/controllers/drive_controller.h"
#include "ui/hold_panel.h"

class QComboBox;
class QLabel;
class QSlider;
class QToolButton;

namespace longarm::ui {

/// With the panel focused the arrow keys drive.  GUI thread only.
class DrivePanel final : public HoldPanel {
  Q_OBJECT

 public:
  using Way = session::DriveController::Way;

  explicit DrivePanel(Workbench& bench, QWidget* parent = nullptr);
  QToolButton* button(Way way) const { return m_buttons.at(way); }
  QComboBox* cameras() const { return m_cameras; }

 Q_SIGNALS:
  /// Show it live in the left pane.
  void cameraWanted(const QString& camera);

 protected:
  void keyPressEvent(QKeyEvent* event) override;
  void keyReleaseEvent(QKeyEvent* event) override;

 private:
  QWidget* makePad();
  QWidget* makeChoices();
  void fillCameras();
  void refresh() override;
  bool keyHeld() const override { return !m_keys.empty(); }
  void forgetKeys() override { m_keys.clear(); }
  QString odometry() const;

  std::map<Way, QToolButton*> m_buttons;
  std::map<int, Way> m_keys;  // that are held
  QSlider* m_speed;
  QLabel *m_speed_text, *m_odometry;
  QComboBox* m_cameras;
};

}  // namespace longarm::ui
