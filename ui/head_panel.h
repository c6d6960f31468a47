#pragma once

/// @file
/// HeadPanel: aims the cameras and works the gripper.

#include <QWidget>

#include "ui/actions.h"
#include "ui/workbench.h"
#include "widgets/aim_stick.h"
#include "widgets/value_label.h"

class QCheckBox;
class QLabel;

namespace longarm::ui {

/// GUI thread only.
class HeadPanel final : public QWidget {
  Q_OBJECT

 public:
  HeadPanel(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent = nullptr);
  widgets::AimStick* stick() const { return m_stick; }
  QCheckBox* watch() const { return m_watch; }

 private:
  void bindGripper();
  void refresh();

  Workbench& m_bench;
  Actions& m_actions;
  widgets::AimStick* m_stick;
  widgets::ValueLabel *m_pan, *m_tilt;
  QLabel *m_head, *m_gripper;
  QCheckBox* m_watch;
};

}  // namespace longarm::ui
