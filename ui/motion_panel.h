#pragma once

/// @file
/// MotionPanel: the transport bar bound to the plan and the player.

#include <QWidget>

#include "ui/actions.h"
#include "ui/workbench.h"
#include "widgets/transport_bar.h"

namespace longarm::ui {

/// GUI thread only.
class MotionPanel final : public QWidget {
  Q_OBJECT

 public:
  MotionPanel(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent = nullptr);
  widgets::TransportBar* bar() const { return m_bar; }

 private:
  void bindBar();
  void bindActions();
  void refresh();
  void refreshStages();
  QString caption() const;

  Workbench& m_bench;
  Actions& m_actions;
  widgets::TransportBar* m_bar;
};

}  // namespace longarm::ui
