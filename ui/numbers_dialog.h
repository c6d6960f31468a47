#pragma once

/// @file
/// NumbersDialog: a feature's vertices as numbers that can be changed.

#include <QDialog>

#include "session/controllers/targeting_controller.h"

class QLabel;
class QTableWidget;

namespace longarm::ui {

/// One line per vertex: its place in millimetres, and its pixel in both panes.  Follows the primary selection and the document;
/// each number entered is one undo step.  Not modal.  GUI thread only.
class NumbersDialog final : public QDialog {
  Q_OBJECT

 public:
  enum Column { kX, kY, kZ, kLeftU, kLeftV, kRightU, kRightV, kColumns };

  explicit NumbersDialog(session::TargetingController& targeting, QWidget* parent = nullptr);
  QTableWidget* table() const { return m_table; }
  QString message() const;

 private:
  void refresh();
  void fillRow(const session::SketchItem& item, int vertex);
  void edited(int row, int column);
  Status apply(const session::SketchItem& item, int vertex, int column, double value) const;

  session::TargetingController& m_targeting;
  QLabel *m_title, *m_message;
  QTableWidget* m_table;
  bool m_filling = false;
};

}  // namespace longarm::ui
