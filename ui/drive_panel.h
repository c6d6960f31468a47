#pragma once

/// @file
/// DrivePanel: drives the base while a button or key is held.

#include <map>
#include <optional>

#include <QWidget>

#include "session/controllers/drive_controller.h"
#include "ui/workbench.h"

class QComboBox;
class QLabel;
class QSlider;
class QToolButton;

namespace longarm::ui {

class ElidedLabel;

/// With the panel focused the arrow keys drive.  Everything is let go of when the panel is hidden, the focus
/// goes or the window is left.  GUI thread only.
class DrivePanel final : public QWidget {
  Q_OBJECT

 public:
  using Way = session::DriveController::Way;

  explicit DrivePanel(Workbench& bench, QWidget* parent = nullptr);
  QToolButton* button(Way way) const { return m_buttons.at(way); }
  QComboBox* cameras() const { return m_cameras; }
  QString message() const;

 Q_SIGNALS:
  /// Show it live in the left pane.
  void cameraWanted(const QString& camera);

 protected:
  void keyPressEvent(QKeyEvent* event) override;
  void keyReleaseEvent(QKeyEvent* event) override;
  void hideEvent(QHideEvent* event) override;
  void focusOutEvent(QFocusEvent* event) override;

 private:
  QWidget* makePad();
  QWidget* makeChoices();
  void fillCameras();
  void refresh();
  void letGo();
  QString odometry() const;

  Workbench& m_bench;
  std::map<Way, QToolButton*> m_buttons;
  std::map<int, Way> m_keys;  // that are held
  QSlider* m_speed;
  QLabel *m_speed_text, *m_odometry;
  QComboBox* m_cameras;
  ElidedLabel* m_state;
  QString m_refusal;
};

}  // namespace longarm::ui
