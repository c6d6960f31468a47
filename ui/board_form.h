#pragma once

/// @file
/// BoardForm: which calibration board is held before the cameras.

#include <QWidget>

#include "calibration/intrinsics/board_detector.h"

class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QSpinBox;

namespace longarm::ui {

/// Rows of a form; more may be added below them.  GUI thread only.
class BoardForm final : public QWidget {
  Q_OBJECT

 public:
  explicit BoardForm(QWidget* parent = nullptr);

  calibration::BoardSpec board() const;
  void setBoard(const calibration::BoardSpec& board);
  QFormLayout* form() const { return m_form; }

 Q_SIGNALS:
  void boardChanged();
  void refused(const QString& sentence);

 private:
  void take();

  QFormLayout* m_form;
  QComboBox* m_kind;
  QSpinBox *m_columns, *m_rows;
  QDoubleSpinBox *m_square, *m_marker;
  bool m_filling = false;
};

}  // namespace longarm::ui
