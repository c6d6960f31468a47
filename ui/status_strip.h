#pragma once

/// @file
/// StatusStrip: mode, link, authority, arm, video and the last thing that was said; always visible.

#include <QFrame>
#include <QTimer>

#include "ui/actions.h"
#include "ui/workbench.h"
#include "widgets/status_lamp.h"

class QLabel;
class QProgressBar;
class QToolButton;

namespace longarm::ui {

class ElidedLabel;

/// Binds robot and planner to lamps.  GUI thread only.
class StatusStrip final : public QFrame {
  Q_OBJECT

 public:
  StatusStrip(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent = nullptr);

  /// The sentence shown now; empty when it has grown old.
  QString message() const;
  widgets::StatusLamp* cameraLamp() const { return m_cameras; }

 Q_SIGNALS:
  void healthWanted(const QString& camera);        ///< The lamp of a doubtful camera was clicked.

 private:
  void applyTheme();
  void showMode();
  void showLink();
  void showArm();
  void showVideo();
  void showCameras();
  void showProgress();
  void showMessage(const QString& sentence);

  Workbench& m_bench;
  Appearance& m_appearance;
  QLabel *m_mode, *m_planning;
  ElidedLabel* m_message;
  widgets::StatusLamp *m_link, *m_arm, *m_owner, *m_video, *m_cameras;
  QProgressBar* m_progress;
  QToolButton *m_cancel, *m_restart;
  QTimer m_forget;
  QStringList m_said;                      // Newest first, for the tooltip.
  QString m_link_trouble;                // the sentence of a link that is not up, while it is not
};

}  // namespace longarm::ui
