#include "ui/numbers_dialog.h"

#include <QHeaderView>
#include <QLabel>
#include <QTableWidget>
#include <QVBoxLayout>

#include "core/text.h"

namespace longarm::ui {

using vision::PaneSide;

NumbersDialog::NumbersDialog(session::TargetingController& targeting, QWidget* parent)
    : QDialog(parent), m_targeting(targeting), m_title(new QLabel(this)), m_message(new QLabel(this)), m_table(new QTableWidget(this)) {
  setWindowTitle(tr("Numbers"));
  setModal(false);
  resize(640, 240);
  auto* column = new QVBoxLayout(this);
  column->addWidget(m_title);
  column->addWidget(m_table, 1);
  m_message->setWordWrap(true);
  column->addWidget(m_message);
  m_table->setColumnCount(kColumns);
  m_table->setHorizontalHeaderLabels({tr("x mm"), tr("y mm"), tr("z mm"), tr("left u px"), tr("left v px"), tr("right u px"), tr("right v px")});
  m_table->horizontalHeader()->setSectionResizeMode(QHeaderView::Stretch);
  connect(m_table, &QTableWidget::cellChanged, this, &NumbersDialog::edited);
  for (const auto signal : {&session::TargetingController::featuresChanged, &session::TargetingController::panesChanged}) {
    connect(&m_targeting, signal, this, &NumbersDialog::refresh);
  }
  refresh();
}

QString NumbersDialog::message() const { return m_message->text(); }

void NumbersDialog::refresh() {
  m_filling = true;
  const auto* item = m_targeting.document().item(m_targeting.document().selection().primary);
  m_title->setText(item == nullptr ? tr("Select a feature.") : QString::fromStdString(item->name));
  m_table->setRowCount(item == nullptr ? 0 : item->vertices());
  for (int vertex = 0; item != nullptr && vertex < item->vertices(); ++vertex) fillRow(*item, vertex);
  m_filling = false;
}

void NumbersDialog::fillRow(const session::SketchItem& item, int vertex) {
  const auto& document = m_targeting.document();
  QString texts[kColumns];
  const auto& measured = document.measurement(item.id).feature;
  if (measured && !item.pipe) {
    const Eigen::Vector3d& xyz = measured->vertices[static_cast<std::size_t>(vertex)].xyz;
    for (int axis = 0; axis < 3; ++axis) texts[kX + axis] = QString::fromStdString(formatFixed(xyz(axis) * 1000, 2));
  }
  for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
    const auto* pick = item.pick(document.paneSnapshotId(side), vertex);
    if (pick == nullptr || !pick->placed()) continue;
    for (int axis = 0; axis < 2; ++axis) {
      texts[(side == PaneSide::kLeft ? kLeftU : kRightU) + axis] = QString::fromStdString(formatFixed(pick->pixel(axis), 3));
    }
  }
  for (int column = 0; column < kColumns; ++column) {
    auto* cell = new QTableWidgetItem(texts[column]);
    cell->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
    if (texts[column].isEmpty() || item.locked) cell->setFlags(Qt::ItemIsSelectable);
    m_table->setItem(vertex, column, cell);
  }
}

Status NumbersDialog::apply(const session::SketchItem& item, int vertex, int column, double value) const {
  const auto& document = m_targeting.document();
  if (column <= kZ) {
    Eigen::Vector3d xyz = document.measurement(item.id).feature->vertices[static_cast<std::size_t>(vertex)].xyz;
    xyz(column - kX) = value / 1000;
    return m_targeting.moveVertex(item.id, vertex, xyz);
  }
  const bool left = column < kRightU;
  const SnapshotId snapshot = document.paneSnapshotId(left ? PaneSide::kLeft : PaneSide::kRight);
  Eigen::Vector2d pixel = item.pick(snapshot, vertex)->pixel;
  pixel(column - (left ? kLeftU : kRightU)) = value;
  return m_targeting.movePick(item.id, snapshot, vertex, pixel);
}

void NumbersDialog::edited(int row, int column) {
  const auto* item = m_targeting.document().item(m_targeting.document().selection().primary);
  if (m_filling || item == nullptr) return;
  const auto value = parseNumber(m_table->item(row, column)->text().toStdString());
  const Status done = value ? apply(*item, row, column, *value) : Status{ErrorCode::kInvalidInput, "That is no number. The decimal point is a dot."};
  m_message->setText(done ? QString() : QString::fromStdString(done.error().message));
  if (!done) refresh();
}

}  // namespace longarm::ui
