#pragma once

/// @file
/// RecordedPanel: records motions of the arm, and edits what was recorded.

#include <QWidget>

#include "session/controllers/motion_recorder.h"
#include "ui/workbench.h"

class QComboBox;
class QPushButton;
class QTableWidget;

namespace longarm::ui {

class ElidedLabel;

/// Replaying is the business of the motions' own buttons, where the canned ones are.  GUI thread only.
class RecordedPanel final : public QWidget {
  Q_OBJECT

 public:
  explicit RecordedPanel(Workbench& bench, QWidget* parent = nullptr);
  QPushButton* recordButton() const { return m_record; }
  QPushButton* insertButton() const { return m_insert; }
  QPushButton* deleteButton() const { return m_delete; }
  QComboBox* list() const { return m_list; }
  QTableWidget* points() const { return m_points; }

 private:
  void refresh();
  void refreshButtons();
  void fillPoints();
  void record();
  void insertHere();
  void report(const Status& status);
  QString chosen() const;

  Workbench& m_bench;
  QPushButton *m_record, *m_plan, *m_remove, *m_insert, *m_delete;
  QComboBox* m_list;
  QTableWidget* m_points;
  ElidedLabel* m_state;
  bool m_filling = false;
};

}  // namespace longarm::ui
