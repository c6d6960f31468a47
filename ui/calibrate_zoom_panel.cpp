#include "ui/calibrate_zoom_panel.h"

#include <algorithm>

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFileInfo>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QTableWidget>
#include <QTimer>
#include <QVBoxLayout>

#include "ui/calibrate_parts.h"

namespace longarm::ui {

using calibration::TrafficLight;

namespace {

constexpr int kSettle_ms = 1500;           // Between the two commands of an approach.

}  // namespace

CalibrateZoomPanel::CalibrateZoomPanel(Workbench& bench, Appearance& appearance, QWidget* parent)
    : QWidget(parent), m_bench(bench) {
  auto* row = pageRow(this);
  const auto [left, column] = framedColumn(this);
  m_curve = new ZoomCurve(appearance, left);
  column->addWidget(m_curve, 1);
  column->addWidget(buildTable(), 1);
  row->addWidget(left, 1);
  row->addWidget(buildSteps(appearance));
  bind();
  refresh();
}

QWidget* CalibrateZoomPanel::buildTable() {
  m_nodes = plainTable({tr("Zoom"), tr("fx px"), tr("Focal error %"), tr("Boresight px"), tr("Picture px"), tr("Verdict")}, this);
  m_nodes->setToolTip(tr("Each setting predicted from all others: what lies between settings is about as wrong"));
  return m_nodes;
}

QWidget* CalibrateZoomPanel::buildSteps(Appearance& appearance) {
  const auto [side, column] = framedColumn(this, 340);
  auto* form = new QFormLayout;
  m_camera = new QComboBox(side);
  m_setting = new QDoubleSpinBox(side);
  m_setting->setRange(0, 1);
  m_setting->setDecimals(3);
  m_setting->setSingleStep(0.05);
  form->addRow(tr("Camera"), m_camera);
  form->addRow(tr("Setting"), m_setting);
  column->addLayout(form);
  m_advised = new QPushButton(tr("Take the advised setting"), side);
  m_go = new QPushButton(tr("1  Turn the lens there"), side);
  auto* second = wordLabel(side);
  second->setText(tr("2  Calibrate it with a board (Lens)"));
  m_add = new QPushButton(tr("3  Add that lens at this setting"), side);
  for (QWidget* each : {static_cast<QWidget*>(m_advised), static_cast<QWidget*>(m_go), static_cast<QWidget*>(second), static_cast<QWidget*>(m_add)}) column->addWidget(each);
  m_advice = wordLabel(side);
  column->addWidget(m_advice);
  m_warnings = wordLabel(side, true);
  column->addWidget(m_warnings, 1);
  auto* row = new QHBoxLayout;
  m_open = new QPushButton(tr("Open XML..."), side);
  m_folder = new QPushButton(tr("From files..."), side);
  m_remove = new QPushButton(tr("Remove"), side);
  row->addWidget(m_open);
  row->addWidget(m_folder);
  row->addWidget(m_remove);
  column->addLayout(row);
  auto* last = new QHBoxLayout;
  m_clear = new QPushButton(tr("Start anew"), side);
  m_save = new QPushButton(tr("Save XML..."), side);
  last->addWidget(m_clear);
  last->addWidget(m_save);
  column->addLayout(last);
  m_use = holdButton(tr("Hold to use this table"), appearance, side);
  column->addWidget(m_use);
  return side;
}

void CalibrateZoomPanel::bind() {
  connect(m_camera, qOverload<int>(&QComboBox::currentIndexChanged), this, [this] {
    if (isVisible()) m_bench.live().setWatched({m_camera->currentData().toString()});
    refresh();
  });
  connect(m_setting, qOverload<double>(&QDoubleSpinBox::valueChanged), this, &CalibrateZoomPanel::refresh);
  connect(m_advised, &QPushButton::clicked, this, [this] {
    if (!model().advised().empty()) m_setting->setValue(model().advised().front());
  });
  connect(m_go, &QPushButton::clicked, this, &CalibrateZoomPanel::go);
  connect(m_add, &QPushButton::clicked, this, [this] { model().addLens(m_camera->currentData().toString().toStdString(), m_setting->value()); });
  connect(m_remove, &QPushButton::clicked, this, [this] {
    if (m_nodes->currentRow() >= 0) model().removeNode(static_cast<std::size_t>(m_nodes->currentRow()));
  });
  connect(m_clear, &QPushButton::clicked, &model(), &session::ZoomController::clear);
  connect(m_open, &QPushButton::clicked, this, [this] {
    askForFiles(this, tr("Zoom camera"), {tr("Zoom cameras (*.xml)"), tr("All files (*)")}, false, [this](const QStringList& files) { model().openFile(files.front()); });
  });
  connect(m_folder, &QPushButton::clicked, this, [this] {
    askForFiles(this, tr("One of the calibrations at single settings"), {tr("Calibrations (*.yaml *.yml *.xml *.csv)")}, false,
                [this](const QStringList& files) { model().openFolder(QFileInfo(files.front()).path()); });
  });
  connect(m_save, &QPushButton::clicked, this, [this] {
    askWhereToSave(this, tr("Save the zoom camera"), m_camera->currentData().toString() + QStringLiteral(".xml"), {tr("Zoom cameras (*.xml)")},
                   [this](const QString& file) { model().save(file); });
  });
  connect(m_use, &widgets::HoldButton::held, this, [this] { model().use(m_camera->currentData().toString().toStdString()); });
  connect(&m_bench.robot(), &RobotSession::stopChanged, this, &CalibrateZoomPanel::refreshDrive);
  connect(&model(), &session::ZoomController::changed, this, &CalibrateZoomPanel::refresh);
  connect(&model(), &session::ZoomController::saved, this, [this](const QString& file) { m_bench.say(tr("Zoom camera saved to %1").arg(file)); });
  connect(&m_bench.calibration().intrinsics(), &session::IntrinsicsController::changed, this, &CalibrateZoomPanel::refreshDrive);
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, &CalibrateZoomPanel::refreshDrive);
}

QString CalibrateZoomPanel::advice() const { return m_advice->text(); }

void CalibrateZoomPanel::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  fillCameras(m_camera, m_bench.document().workcell().get());
  m_bench.live().setWatched({m_camera->currentData().toString()});
  refresh();
}

void CalibrateZoomPanel::hideEvent(QHideEvent* event) {
  m_bench.live().setWatched({});
  QWidget::hideEvent(event);
}

QString CalibrateZoomPanel::whyNotGo() const {
  const auto& workcell = m_bench.document().workcell();
  const auto* camera = workcell ? workcell->camera(m_camera->currentData().toString().toStdString()) : nullptr;
  if (camera == nullptr) return tr("no camera is chosen.");
  if (!camera->zooms) return tr("camera %1 has no zoom.").arg(m_camera->currentText());
  return m_bench.robot().whyNotReady();
}

// Always from below, so that play in the drive is taken up the same way.
void CalibrateZoomPanel::go() {
  const std::string camera = m_camera->currentData().toString().toStdString();
  int delay = 0;
  for (const double setting : session::ZoomController::approach(m_setting->value())) {
    QTimer::singleShot(delay, this, [this, camera, setting] {
      auto* runtime = m_bench.robot().runtime();
      const Status sent = runtime != nullptr ? runtime->setZoom(camera, setting) : Status(ErrorCode::kDisconnected, "No robot is connected.");
      if (!sent) m_bench.say(QString::fromStdString(sent.error().message));
    });
    delay += kSettle_ms;
  }
}

void CalibrateZoomPanel::refresh() {
  const auto& nodes = model().table().nodes;
  m_nodes->setRowCount(static_cast<int>(nodes.size()));
  for (int row = 0; row < m_nodes->rowCount(); ++row) {
    const auto& node = nodes[static_cast<std::size_t>(row)];
    setCell(m_nodes, row, 0, QString::number(node.zoom, 'g', 4));
    setCell(m_nodes, row, 1, QString::number(node.interior[0], 'f', 1));
    for (int column = 2; column < 5; ++column) setCell(m_nodes, row, column, QStringLiteral("-"));
    setCell(m_nodes, row, 5, vision::isNominal(node) ? tr("nominal, not measured") : tr("an end: cannot be predicted"));
    for (const auto& miss : model().misses()) {
      if (miss.zoom != node.zoom) continue;
      setCell(m_nodes, row, 2, QString::number(100 * miss.focal_error, 'f', 2));
      setCell(m_nodes, row, 3, QString::number(miss.boresight_px.norm(), 'f', 2));
      setCell(m_nodes, row, 4, QString::number(miss.error_px, 'f', 2));
      const QString light = miss.light == TrafficLight::kGreen ? tr("good") : miss.light == TrafficLight::kAmber ? tr("fair: calibrate between") : tr("poor: calibrate between");
      setCell(m_nodes, row, 5, miss.nominal ? tr("nominal, not measured") : light);
    }
  }
  m_curve->setTable(model().table(), m_setting->value());
  const auto& advised = model().advised();
  QString text;
  if (nodes.empty()) text = tr("Begin with the two ends, 0 and %1.").arg(model().lastSetting(m_camera->currentData().toString().toStdString()));
  else if (nodes.size() == 1) text = tr("Calibrate the other end too.");
  else if (!advised.empty()) text = tr("Calibrate at zoom %1 next: predictions there are the worst.").arg(advised.front(), 0, 'g', 3);
  else text = model().light() == TrafficLight::kGreen ? tr("Every setting is predicted well by the others: the table is good.") : tr("One more setting in the middle would tell how good the table is.");
  m_advice->setText(text);
  QStringList warnings;
  for (const auto& warning : model().warnings()) warnings << QString::fromStdString(warning);
  m_warnings->setText(warnings.join(QLatin1Char('\n')));
  setWhyNot(m_advised, advised.empty() ? tr("no setting is advised.") : QString(), tr("Where another calibration would help most"));
  setWhyNot(m_remove, nodes.empty() ? tr("the table is empty.") : QString(), tr("Remove the selected setting"));
  setWhyNot(m_clear, nodes.empty() ? tr("the table is empty.") : QString(), tr("Forget all settings"));
  setWhyNot(m_save, model().whyNotSave(), tr("Write the table as a zoom camera's XML"));
  refreshDrive();
}

void CalibrateZoomPanel::refreshDrive() {
  QString why = model().whyNotSave();
  if (why.isEmpty() && !m_bench.zoomDrive().zooms(m_camera->currentData().toString())) why = tr("camera %1 has no zoom.").arg(m_camera->currentText());
  if (why.isEmpty()) why = m_bench.whyNotCalibrate();
  setWhyNot(m_use, why, tr("The camera is measured with by this table from now on, at every zoom; snapshots keep their lens"));
  setWhyNot(m_go, whyNotGo(), tr("First a little below, then to the setting: always from the same side"));
  setWhyNot(m_add, model().whyNotAddLens(m_camera->currentData().toString().toStdString(), m_setting->value()), tr("The newest result of the board becomes the table's entry at this setting"));
}

}  // namespace longarm::ui
