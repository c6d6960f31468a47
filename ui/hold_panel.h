#pragma once

/// @file
/// HoldPanel: what panels have in common that move something while a button or key is held.

#include <QWidget>

#include "session/controllers/dead_man_switch.h"
#include "ui/workbench.h"

class QHBoxLayout;

namespace longarm::ui {

class ElidedLabel;

/// A row of controls over a line that says what goes on.  Everything is let go of when the panel is hidden, when it loses the
/// focus while a key is held, and when the window is left.  GUI thread only.
class HoldPanel : public QWidget {
  Q_OBJECT

 public:
  QString message() const;                             ///< The line below.

 protected:
  /// Both are borrowed and outlive this.
  HoldPanel(Workbench& bench, session::DeadManSwitch& held, QWidget* parent);

  virtual void refresh() = 0;
  virtual bool keyHeld() const = 0;
  virtual void forgetKeys() = 0;

  void hideEvent(QHideEvent* event) override;
  void focusOutEvent(QFocusEvent* event) override;

  Workbench& m_bench;
  QHBoxLayout* m_row;
  ElidedLabel* m_state;
  QString m_refusal;                                   // of the last command; empty: it was taken

 private:
  void letGo();

  session::DeadManSwitch& m_held;
};

}  // namespace longarm::ui
