#include "ui/board_form.h"

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QSpinBox>

#include "ui/calibrate_fields.h"
#include "ui/calibrate_parts.h"

namespace longarm::ui {

using calibration::BoardKind;

BoardForm::BoardForm(QWidget* parent) : QWidget(parent) {
  m_form = new QFormLayout(this);
  m_form->setContentsMargins(0, 0, 0, 0);
  m_kind = new QComboBox(this);
  m_kind->addItems({tr("Chessboard"), tr("ChArUco"), tr("Grid of circles")});
  m_columns = countBox(this, 9);
  m_rows = countBox(this, 6);
  auto* size = new QHBoxLayout;
  size->addWidget(m_columns, 1);
  size->addWidget(new QLabel(QStringLiteral("\u00d7"), this));
  size->addWidget(m_rows, 1);
  m_square = lengthBox(this, 25, 0.1);
  m_marker = lengthBox(this, 0, 0);
  m_marker->setSpecialValueText(tr("3/4 of a square"));
  m_form->addRow(tr("Board"), m_kind);
  m_form->addRow(tr("Inner corners"), size);
  m_form->addRow(tr("Square"), m_square);
  m_form->addRow(tr("Marker"), m_marker);
  m_columns->setToolTip(tr("Corners where four squares meet: a board of 10 x 7 squares has 9 x 6"));
  m_rows->setToolTip(m_columns->toolTip());
  m_square->setToolTip(tr("Side of a square, or distance of two circles. A wrong length makes every distance wrong in proportion."));
  for (auto* box : {m_columns, m_rows}) connect(box, qOverload<int>(&QSpinBox::valueChanged), this, &BoardForm::take);
  for (auto* box : {m_square, m_marker}) connect(box, qOverload<double>(&QDoubleSpinBox::valueChanged), this, &BoardForm::take);
  connect(m_kind, qOverload<int>(&QComboBox::currentIndexChanged), this, &BoardForm::take);
  take();
}

calibration::BoardSpec BoardForm::board() const {
  calibration::BoardSpec board;
  board.kind = static_cast<BoardKind>(m_kind->currentIndex());
  board.columns = m_columns->value();
  board.rows = m_rows->value();
  board.square = m_square->value() / 1000;
  board.marker = board.kind == BoardKind::kCharuco ? m_marker->value() / 1000 : 0;
  return board;
}

void BoardForm::setBoard(const calibration::BoardSpec& board) {
  m_filling = true;
  m_kind->setCurrentIndex(static_cast<int>(board.kind));
  m_columns->setValue(board.columns);
  m_rows->setValue(board.rows);
  m_square->setValue(1000 * board.square);
  m_marker->setValue(1000 * board.marker);
  m_filling = false;
  take();
}

void BoardForm::take() {
  const bool charuco = m_kind->currentIndex() == static_cast<int>(BoardKind::kCharuco);
  setWhyNot(m_marker, charuco ? QString() : tr("only ChArUco boards have markers."), tr("Side of a marker; left at zero: three quarters of a square"));
  if (m_filling) return;
  const auto now = board();
  if (now.marker >= now.square) Q_EMIT refused(tr("A marker must be smaller than its square."));
  else Q_EMIT boardChanged();
}

}  // namespace longarm::ui
