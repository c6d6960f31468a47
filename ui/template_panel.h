#pragma once

/// @file
/// TemplatePanel: doors, valves and drawers: dropped onto the sketch, sized, and worked by their macros.

#include <QWidget>

#include "ui/workbench.h"

class QComboBox;
class QFormLayout;
class QHBoxLayout;
class QLabel;
class QPushButton;

namespace longarm::ui {

/// GUI thread only.
class TemplatePanel final : public QWidget {
  Q_OBJECT

 public:
  explicit TemplatePanel(Workbench& bench, QWidget* parent = nullptr);

  QComboBox* kinds() const { return m_kinds; }
  QPushButton* dropButton() const { return m_drop; }
  QComboBox* dropped() const { return m_dropped; }
  QPushButton* actionButton(const QString& name) const;
  QLabel* message() const { return m_message; }

 private:
  WorldItemId chosen() const;
  void refresh();
  void refreshKinds();
  void refreshDropped();
  void refreshActions();
  void refreshForm();
  void drop();

  Workbench& m_bench;
  QComboBox *m_kinds, *m_dropped;
  QPushButton *m_drop, *m_remove, *m_cancel;
  QLabel* m_message;
  QWidget *m_form, *m_actions;
  WorldItemId m_shown;                     // whose form is built
};

}  // namespace longarm::ui
