#pragma once

/// @file
/// MacroPanel: what the robot can do with the selection, or by itself when nothing is selected.

#include <map>

#include <QWidget>

#include "ui/actions.h"
#include "ui/workbench.h"

class QGridLayout;
class QLabel;
class QPushButton;

namespace longarm::ui {

/// A button per macro of the workcell.  Pressing one plans and shows; nothing moves.  GUI thread only.
class MacroPanel final : public QWidget {
  Q_OBJECT

 public:
  MacroPanel(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent = nullptr);
  QPushButton* button(const QString& macro) const;         ///< Null if there is none.

 private:
  void bindActions();
  void refresh();
  void refreshPlan();
  void rebuild(const std::vector<session::MacroRow>& rows);
  void applyTheme();

  Workbench& m_bench;
  Actions& m_actions;
  Appearance& m_appearance;
  QGridLayout* m_grid;
  QLabel *m_target, *m_outcome;
  std::map<QString, QPushButton*> m_buttons;
};

}  // namespace longarm::ui
