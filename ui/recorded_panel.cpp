#include "ui/recorded_panel.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLineEdit>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>

#include "ui/elided_label.h"

namespace longarm::ui {

RecordedPanel::RecordedPanel(Workbench& bench, QWidget* parent) : QWidget(parent), m_bench(bench) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(6, 6, 6, 4);
  column->setSpacing(4);
  auto* head = new QHBoxLayout;
  m_record = new QPushButton(this);
  m_list = new QComboBox(this);
  m_list->setEditable(true);
  m_list->setInsertPolicy(QComboBox::NoInsert);
  m_list->setToolTip(tr("The recorded motions; type to give the shown one another name"));
  m_plan = new QPushButton(tr("Plan it"), this);
  m_remove = new QPushButton(tr("Delete motion"), this);
  for (QWidget* each : {static_cast<QWidget*>(m_record), static_cast<QWidget*>(m_list),
                        static_cast<QWidget*>(m_plan), static_cast<QWidget*>(m_remove)}) {
    head->addWidget(each, each == m_list ? 1 : 0);
  }
  column->addLayout(head);
  auto* middle = new QHBoxLayout;
  m_points = new QTableWidget(0, 2, this);
  m_points->setHorizontalHeaderLabels({tr("Way-point"), tr("Joints, degrees")});
  m_points->horizontalHeader()->setSectionResizeMode(0, QHeaderView::ResizeToContents);
  m_points->horizontalHeader()->setSectionResizeMode(1, QHeaderView::Stretch);
  m_points->setSelectionBehavior(QAbstractItemView::SelectRows);
  m_points->setSelectionMode(QAbstractItemView::SingleSelection);
  m_points->verticalHeader()->hide();
  m_points->verticalHeader()->setDefaultSectionSize(24);
  m_points->setShowGrid(false);
  middle->addWidget(m_points, 1);
  auto* side = new QVBoxLayout;
  m_insert = new QPushButton(tr("Insert here"), this);
  m_insert->setToolTip(tr("Inserts where the arm is now, after the selected way-point"));
  m_delete = new QPushButton(tr("Delete point"), this);
  side->addWidget(m_insert);
  side->addWidget(m_delete);
  side->addStretch(1);
  middle->addLayout(side);
  column->addLayout(middle, 1);
  m_state = new ElidedLabel(this);
  column->addWidget(m_state);
  for (auto* each : {m_record, m_plan, m_remove, m_insert, m_delete}) each->setFocusPolicy(Qt::TabFocus);

  auto& recorder = m_bench.recorder();
  connect(m_record, &QPushButton::clicked, this, &RecordedPanel::record);
  connect(m_plan, &QPushButton::clicked, this, [this] {
    const auto* motion = m_bench.recorder().motion(chosen());
    if (motion == nullptr) return;
    m_bench.document().select({});  // what takes nothing is there when nothing is selected
    m_bench.plan(QString::fromStdString(planning::macroName(*motion)));
  });
  connect(m_remove, &QPushButton::clicked, this, [this] { report(m_bench.recorder().remove(chosen())); });
  connect(m_insert, &QPushButton::clicked, this, &RecordedPanel::insertHere);
  connect(m_delete, &QPushButton::clicked, this,
          [this] { report(m_bench.recorder().removeWaypoint(chosen(), m_points->currentRow())); });
  connect(m_list, qOverload<int>(&QComboBox::currentIndexChanged), this, &RecordedPanel::fillPoints);
  connect(m_list->lineEdit(), &QLineEdit::editingFinished, this, [this] {
    if (m_filling || m_list->currentText() == chosen() || chosen().isEmpty()) return;
    report(m_bench.recorder().rename(chosen(), m_list->currentText()));
    refresh();
  });
  connect(m_points, &QTableWidget::cellChanged, this, [this](int row, int cell) {
    if (!m_filling && cell == 0)
      report(m_bench.recorder().renameWaypoint(chosen(), row, m_points->item(row, cell)->text()));
  });
  connect(m_points, &QTableWidget::itemSelectionChanged, this, &RecordedPanel::refreshButtons);
  connect(&recorder, &session::MotionRecorder::changed, this, &RecordedPanel::refresh);
  connect(&recorder, &session::MotionRecorder::recordingChanged, this, &RecordedPanel::refreshButtons);
  connect(&m_bench.robot(), &RobotSession::polledSlowly, this, &RecordedPanel::refreshButtons);
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, &RecordedPanel::refreshButtons);
  refresh();
}

QString RecordedPanel::chosen() const { return m_list->currentData().toString(); }

void RecordedPanel::report(const Status& status) {
  if (!status) m_bench.say(QString::fromStdString(status.error().message));
}

void RecordedPanel::refresh() {
  const QString before = chosen();
  const int row = m_points->currentRow();
  m_filling = true;
  m_list->clear();
  for (const auto& motion : m_bench.recorder().motions())
    m_list->addItem(QString::fromStdString(motion.name), QString::fromStdString(motion.name));
  const int again = m_list->findData(before);
  m_list->setCurrentIndex(again >= 0 ? again : m_list->count() - 1);
  m_filling = false;
  fillPoints();
  if (row >= 0 && row < m_points->rowCount()) m_points->selectRow(row);
}

void RecordedPanel::fillPoints() {
  if (m_filling) return;
  m_filling = true;
  const auto* motion = m_bench.recorder().motion(chosen());
  m_points->setRowCount(motion != nullptr ? static_cast<int>(motion->waypoints.size()) : 0);
  for (int i = 0; i < m_points->rowCount(); ++i) {
    const auto& point = motion->waypoints[static_cast<std::size_t>(i)];
    QStringList degrees;
    for (const double joint : point.joints) degrees << QString::number(joint * 180 / M_PI, 'f', 1);
    m_points->setItem(i, 0, new QTableWidgetItem(QString::fromStdString(point.name)));
    auto* joints = new QTableWidgetItem(degrees.join(QStringLiteral(", ")));
    joints->setFlags(Qt::ItemIsSelectable | Qt::ItemIsEnabled);
    m_points->setItem(i, 1, joints);
  }
  m_filling = false;
  refreshButtons();
}

void RecordedPanel::refreshButtons() {
  const auto& recorder = m_bench.recorder();
  const QString ready = m_bench.robot().whyNotReady();
  const auto set = [](QPushButton* button, const QString& why, const QString& does) {
    button->setEnabled(why.isEmpty());
    button->setToolTip(why.isEmpty() ? does : why);
  };
  const QString none = chosen().isEmpty() ? tr("Nothing was recorded yet.") : QString();
  m_record->setText(recorder.recording() ? tr("End recording") : tr("Record"));
  set(m_record, recorder.recording() ? QString() : ready,
      recorder.recording() ? tr("Keeps what the arm has done since the start")
                           : tr("Keeps what the arm does from now on, by jogging or playing"));
  set(m_plan, none.isEmpty() ? m_bench.whyNotPlan() : none,
      tr("Plans it from where the arm is; nothing moves before Play"));
  set(m_remove, none, tr("Deletes the shown motion with its file"));
  set(m_insert, none.isEmpty() ? ready : none,
      tr("Inserts where the arm is now, after the selected way-point"));
  set(m_delete,
      !none.isEmpty()              ? none
      : m_points->currentRow() < 0 ? tr("Select a way-point first.")
                                   : QString(),
      tr("Deletes the selected way-point"));
  m_state->setFullText(recorder.recording()
                           ? tr("recording: %1 places so far").arg(recorder.samples())
                           : tr("Recorded motions stand beside the canned ones when nothing is selected."));
}

void RecordedPanel::record() {
  auto& recorder = m_bench.recorder();
  if (!recorder.recording()) return report(recorder.start());
  const auto name = recorder.finish();
  if (!name) return report(name.error());
  m_list->setCurrentIndex(m_list->findData(*name));
}

void RecordedPanel::insertHere() {
  const auto joints =
      m_bench.robot().runtime() != nullptr ? m_bench.robot().runtime()->jointState() : nullptr;
  if (!joints) return m_bench.say(tr("The robot's joints are not known yet."));
  const int row = m_points->currentRow();
  report(m_bench.recorder().insertWaypoint(chosen(), row < 0 ? m_points->rowCount() : row + 1, *joints));
}

}  // namespace longarm::ui
