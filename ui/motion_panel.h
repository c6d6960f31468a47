#pragma once

/// @file
/// MotionPanel: the transport bar bound to the plan and the player.

#include <QWidget>

class QKeyEvent;

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

 protected:
  /// Keys that must be held are no shortcuts: those do not tell when they are let go of.
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void bindBar();
  void bindActions();
  void refresh();
  void refreshStages();
  QString caption() const;
  QString badge() const;
  bool heldKey(const QObject* watched, const QKeyEvent& key, bool press);

  Workbench& m_bench;
  Actions& m_actions;
  widgets::TransportBar* m_bar;
  int m_key = 0;  // that is held
};

}  // namespace longarm::ui
