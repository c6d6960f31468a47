#pragma once

/// @file
/// StopPanel: the STOP octagon and, apart from it, the reset that must be held.

#include <QWidget>

#include "ui/actions.h"
#include "ui/workbench.h"
#include "widgets/hold_button.h"
#include "widgets/stop_button.h"

namespace longarm::ui {

/// GUI thread only.
class StopPanel final : public QWidget {
  Q_OBJECT

 public:
  StopPanel(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent = nullptr);
  widgets::StopButton* stopButton() const { return m_stop; }
  widgets::HoldButton* resetButton() const { return m_reset; }

 private:
  void refresh();

  Workbench& m_bench;
  Actions& m_actions;
  widgets::StopButton* m_stop;
  widgets::HoldButton* m_reset;
};

}  // namespace longarm::ui
