#pragma once

/// @file
/// MacroPanel: what the robot can do with the selection, or by itself when nothing is selected; what can be set for it,
/// and what came of planning it.

#include <map>

#include <QStringList>
#include <QTimer>
#include <QWidget>

#include "ui/actions.h"
#include "ui/macro_form.h"
#include "ui/workbench.h"

class QGridLayout;
class QLabel;
class QPushButton;

namespace longarm::ui {

/// Shows a button per macro that takes what is selected.  Pressing one plans and shows; nothing moves.  A change of the
/// settings of the motion shown plans it again while the arm has not begun it.  GUI thread only.
class MacroPanel final : public QWidget {
  Q_OBJECT

 public:
  MacroPanel(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent = nullptr);
  QPushButton* button(const QString& macro) const;         ///< Of any macro, shown or not; null if there is none.
  MacroForm* form() const { return m_form; }
  QString outcome() const;                                 ///< What is told of the plan.

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void bindActions();
  void refresh();
  void refreshPlan();
  void rebuild(const std::vector<session::MacroRow>& rows);
  void layOut(const std::vector<session::MacroRow>& rows);
  void place();
  int columnsThatFit() const;
  void showButton(const session::MacroRow& row);
  void showReach();
  void showReachOf(const session::MacroRow& row);
  void choose(const QString& macro);
  void replanIfShown(const QString& macro);
  QString whatHappens() const;
  QStringList told(const planning::Plan& plan) const;
  bool offered(const session::MacroRow& row) const;
  void applyTheme();

  Workbench& m_bench;
  Actions& m_actions;
  Appearance& m_appearance;
  QGridLayout* m_grid;
  QLabel *m_target, *m_outcome;
  MacroForm* m_form;
  QTimer m_replan;
  QString m_chosen;                        // Whose settings are shown.
  QStringList m_laid_out;
  int m_columns = 0;
  std::map<QString, QPushButton*> m_buttons;
};

}  // namespace longarm::ui
