#include "ui/calibrate_library_panel.h"

#include <algorithm>
#include <cmath>

#include <QDateTime>
#include <QDoubleSpinBox>
#include <QFile>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QSplitter>
#include <QTableWidget>
#include <QVBoxLayout>

#include "calibration/intrinsics/compare_cameras.h"
#include "core/clock.h"
#include "session/controllers/calibrated_camera.h"
#include "ui/calibrate_parts.h"

namespace longarm::ui {

using calibration::HealthLevel;
using vision::OverlayRole;

namespace {

constexpr double kSame_px = 1e-6;
constexpr double kDegPerRad = 57.29577951308232;

QString wordOf(HealthLevel level) {
  switch (level) {
    case HealthLevel::kUnknown: return QObject::tr("not known yet");
    case HealthLevel::kGood: return QObject::tr("good");
    case HealthLevel::kDoubtful: return QObject::tr("doubtful");
    case HealthLevel::kKnocked: return QObject::tr("KNOCKED?");
  }
  return {};
}

QString ageText(double days) {
  if (days < 0) return QStringLiteral("-");
  return days < 1 ? QObject::tr("%1 h").arg(24 * days, 0, 'f', 0) : QObject::tr("%1 d").arg(days, 0, 'f', 0);
}

}  // namespace

CalibrateLibraryPanel::CalibrateLibraryPanel(Workbench& bench, Appearance& appearance, QWidget* parent) : QWidget(parent), m_bench(bench) {
  auto* row = pageRow(this);
  row->addWidget(buildTables(appearance), 3);
  row->addWidget(buildDifference(appearance), 2);
  bind();
  refresh();
}

QWidget* CalibrateLibraryPanel::buildTables(Appearance& appearance) {
  const auto [frame, column] = framedColumn(this);
  auto* head = new QLabel(tr("Cameras, pan-tilts, objects"), frame);
  head->setObjectName(QStringLiteral("title"));
  column->addWidget(head);
  m_cameras = plainTable({tr("Name"), tr("In use"), tr("Age"), tr("Rays \u00b1 px"), tr("Off px"), tr("Health")}, frame);
  column->addWidget(m_cameras, 1);
  m_health = wordLabel(frame);
  m_health->setMinimumHeight(34);
  column->addWidget(m_health);
  auto* line = new QHBoxLayout;
  m_repose = new QPushButton(tr("Calibrate its pose..."), frame);
  line->addWidget(m_repose);
  line->addStretch(1);
  column->addLayout(line);
  auto* title = new QLabel(tr("Calibrations of it"), frame);
  title->setObjectName(QStringLiteral("title"));
  column->addWidget(title);
  m_records = plainTable({tr("Made"), tr("Kind"), tr("Points"), tr("rms px"), tr("Rays \u00b1 px"), tr("Note")}, frame);
  column->addWidget(m_records, 1);
  auto* row = new QHBoxLayout;
  m_use = holdButton(tr("Hold to use this one"), appearance, frame);
  m_again = new QPushButton(tr("Solve again"), frame);
  m_export = new QPushButton(tr("Export..."), frame);
  row->addWidget(m_use);
  row->addWidget(m_again);
  row->addWidget(m_export);
  row->addStretch(1);
  column->addLayout(row);
  return frame;
}

QWidget* CalibrateLibraryPanel::buildDifference(Appearance& appearance) {
  const auto [frame, column, row, canvas] = pictureFrame(appearance, this);
  m_canvas = canvas;
  auto* title = new QLabel(tr("Against the one in use, at"), frame);
  m_depth = new QDoubleSpinBox(frame);
  m_depth->setRange(0.05, 100);
  m_depth->setValue(1);
  m_depth->setSuffix(QStringLiteral(" m"));
  m_depth->setToolTip(tr("Working depth of the millimetres"));
  row->addWidget(title);
  row->addWidget(m_depth);
  row->addStretch(1);
  m_difference = wordLabel(frame);
  m_difference->setMinimumHeight(64);
  column->addWidget(m_difference);
  return frame;
}

void CalibrateLibraryPanel::bind() {
  connect(m_cameras, &QTableWidget::itemSelectionChanged, this, &CalibrateLibraryPanel::refreshRecords);
  connect(m_records, &QTableWidget::itemSelectionChanged, this, &CalibrateLibraryPanel::refreshDifference);
  connect(m_depth, qOverload<double>(&QDoubleSpinBox::valueChanged), this, &CalibrateLibraryPanel::refreshDifference);
  connect(m_use, &widgets::HoldButton::held, this, &CalibrateLibraryPanel::use);
  connect(m_repose, &QPushButton::clicked, this, [this] { Q_EMIT poseWanted(chosenCamera()); });
  connect(m_export, &QPushButton::clicked, this, [this] {
    const auto record = m_bench.calibration().library().find(chosenRecord().toStdString());
    if (record) exportTo(*record);
  });
  connect(m_again, &QPushButton::clicked, this, [this] { m_bench.calibration().solveAgain(chosenRecord().toStdString()); });
  connect(&m_bench.calibration(), &session::CalibrationController::placed, this, &CalibrateLibraryPanel::refresh);
  connect(&m_bench.calibration(), &session::CalibrationController::libraryChanged, this, &CalibrateLibraryPanel::refresh);
  connect(&m_bench.calibration(), &session::CalibrationController::applied, this, &CalibrateLibraryPanel::refresh);
  connect(&m_bench.health(), &session::HealthController::changed, this, [this] {
    if (isVisible()) refreshCameras();
  });
  connect(&m_bench.robot(), &RobotSession::stopChanged, this, &CalibrateLibraryPanel::refreshDifference);
}

void CalibrateLibraryPanel::exportTo(const session::CalibrationRecord& record) {
  const bool camera = record.subject == session::Subject::kCamera;
  const QStringList filters = camera ? QStringList{tr("ROS camera file (*.yaml)"), tr("OpenCV YAML (*.yml)"), tr("OpenCV XML (*.xml)")} : QStringList{tr("Placement (*.json)")};
  askWhereToSave(this, tr("Export the calibration"), QString::fromStdString(record.name) + (camera ? QStringLiteral(".yaml") : QStringLiteral(".json")), filters,
                 [this, camera, from = record.file](const QString& to) {
                   Status written;
                   if (camera) {
                     const auto file = vision::readCameraFile(from);
                     written = file ? vision::writeCameraFile(to.toStdString(), *file) : Status(file.error());
                   } else {
                     const auto placement = session::readPlacement(from);
                     written = placement ? session::writePlacement(to.toStdString(), *placement) : Status(placement.error());
                   }
                   m_bench.say(written ? tr("Calibration exported to %1").arg(to) : QString::fromStdString(written.error().message));
                 });
}

QString CalibrateLibraryPanel::difference() const { return m_difference->text(); }

void CalibrateLibraryPanel::choose(const QString& camera) {
  for (int row = 0; row < m_cameras->rowCount(); ++row) {
    const auto* item = m_cameras->item(row, 0);
    const bool is_camera = item->data(Qt::UserRole).toInt() == static_cast<int>(session::Subject::kCamera);
    if (is_camera && item->data(Qt::UserRole + 1).toString() == camera) m_cameras->selectRow(row);
  }
}

void CalibrateLibraryPanel::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  refresh();
}

void CalibrateLibraryPanel::refresh() {
  refreshCameras();
  refreshRecords();
}

void CalibrateLibraryPanel::refreshCameras() {
  const auto& workcell = m_bench.document().workcell();
  const QString chosen = chosenCamera();
  const auto subject = chosenSubject();
  const QSignalBlocker quiet(m_cameras);
  m_cameras->setRowCount(workcell ? static_cast<int>(workcell->cameras.size() + workcell->pan_tilts.size() + workcell->objects.size()) : 0);
  int row = 0;
  if (workcell) {
    for (const auto& camera : workcell->cameras) fillCamera(row++, camera.name);
    for (const auto& unit : workcell->pan_tilts) fillPlace(row++, session::Subject::kPanTilt, unit.name);
    for (const auto& object : workcell->objects) fillPlace(row++, session::Subject::kObject, object.name);
  }
  for (row = 0; row < m_cameras->rowCount(); ++row) {
    const auto* item = m_cameras->item(row, 0);
    if (item->data(Qt::UserRole + 1).toString() == chosen && item->data(Qt::UserRole).toInt() == static_cast<int>(subject)) m_cameras->selectRow(row);
  }
  if (m_cameras->rowCount() > 0 && !m_cameras->selectionModel()->hasSelection()) m_cameras->selectRow(0);
  const auto health = m_bench.health().of(chosenCamera().toStdString());
  const auto camera = m_bench.calibration().fileInUse(chosenCamera().toStdString(), zoomOf(chosenCamera()));
  QString text = QString::fromStdString(health.why);
  if (!text.isEmpty() && camera) text += tr(" That is %1 mm at 1 m.").arg(1000 * health.off_px / camera->camera.fx, 0, 'f', 1);
  if (text.isEmpty()) text = tr("Picks placed off their curve (Ctrl), and corners clicked under Pose, tell whether a camera was knocked.");
  m_health->setText(text);
}

// The setting at which a zoom camera is looked at: where it stands, else where its table begins.
std::optional<double> CalibrateLibraryPanel::zoomOf(const QString& camera) const {
  const auto& workcell = m_bench.document().workcell();
  const auto* spec = workcell ? workcell->camera(camera.toStdString()) : nullptr;
  const auto calibration = spec != nullptr ? session::calibrationOf(*spec) : Result<std::shared_ptr<const vision::CameraCalibration>>(ErrorCode::kNotFound, "");
  if (!calibration || !(*calibration)->hasTable()) return std::nullopt;
  const auto now = m_bench.zoomDrive().zoom(camera);
  return now ? now : std::optional<double>((*calibration)->range().first);
}

void CalibrateLibraryPanel::fillCamera(int row, const std::string& name) {
  const auto record = m_bench.calibration().recordInUse(name);
  const auto health = m_bench.health().of(name);
  const auto file = m_bench.calibration().fileInUse(name, zoomOf(QString::fromStdString(name)));
  const auto sure = file ? session::meanUncertainty(*file) : std::nullopt;
  setCell(m_cameras, row, 0, QString::fromStdString(name));
  setCell(m_cameras, row, 1, record ? QString::fromStdString(record->kind) : tr("workcell's file"));
  setCell(m_cameras, row, 2, ageText(m_bench.health().ageDays(name)));
  setCell(m_cameras, row, 3, sure ? QString::number(*sure, 'f', 3) : tr("not stated"));
  setCell(m_cameras, row, 4, health.samples > 0 ? QString::number(health.off_px, 'f', 1) : QStringLiteral("-"));
  setCell(m_cameras, row, 5, wordOf(health.level));
  m_cameras->item(row, 0)->setData(Qt::UserRole, static_cast<int>(session::Subject::kCamera));
  m_cameras->item(row, 0)->setData(Qt::UserRole + 1, QString::fromStdString(name));
}

void CalibrateLibraryPanel::fillPlace(int row, session::Subject subject, const std::string& name) {
  const auto record = m_bench.calibration().recordInUse(subject, name);
  const double days = record ? (wallTime_s() - record->wall_time_s) / 86400 : -1;
  const QString kind = subject == session::Subject::kPanTilt ? tr("pan-tilt %1") : tr("object %1");
  setCell(m_cameras, row, 0, kind.arg(QString::fromStdString(name)));
  setCell(m_cameras, row, 1, record ? QString::fromStdString(record->kind) : tr("workcell's file"));
  setCell(m_cameras, row, 2, ageText(days));
  for (const int column : {3, 4, 5}) setCell(m_cameras, row, column, QStringLiteral("-"));
  m_cameras->item(row, 0)->setData(Qt::UserRole, static_cast<int>(subject));
  m_cameras->item(row, 0)->setData(Qt::UserRole + 1, QString::fromStdString(name));
}

session::Subject CalibrateLibraryPanel::chosenSubject() const {
  const auto* item = m_cameras->currentRow() >= 0 ? m_cameras->item(m_cameras->currentRow(), 0) : nullptr;
  return item != nullptr ? static_cast<session::Subject>(item->data(Qt::UserRole).toInt()) : session::Subject::kCamera;
}

std::optional<session::CalibrationRecord> CalibrateLibraryPanel::recordInUse() const {
  const auto subject = chosenSubject();
  const std::string name = chosenCamera().toStdString();
  return subject == session::Subject::kCamera ? m_bench.calibration().recordInUse(name) : m_bench.calibration().recordInUse(subject, name);
}

QString CalibrateLibraryPanel::chosenCamera() const {
  const auto* item = m_cameras->currentRow() >= 0 ? m_cameras->item(m_cameras->currentRow(), 0) : nullptr;
  return item != nullptr ? item->data(Qt::UserRole + 1).toString() : QString();
}

QString CalibrateLibraryPanel::chosenRecord() const {
  const auto* item = m_records->currentRow() >= 0 ? m_records->item(m_records->currentRow(), 0) : nullptr;
  return item != nullptr ? item->data(Qt::UserRole).toString() : QString();
}

void CalibrateLibraryPanel::refreshRecords() {
  const auto& plain = m_bench.calibration().plainWorkcell();
  const QString camera = chosenCamera();
  const auto records = plain && !camera.isEmpty() ? m_bench.calibration().library().records(plain->name, camera.toStdString(), chosenSubject()) : std::vector<session::CalibrationRecord>{};
  const auto in_use = recordInUse();
  const QString chosen = chosenRecord();
  {
    const QSignalBlocker quiet(m_records);
    m_records->setRowCount(static_cast<int>(records.size()) + (camera.isEmpty() ? 0 : 1));
    for (int row = 0; row < static_cast<int>(records.size()); ++row) {
      const auto& record = records[static_cast<std::size_t>(row)];
      const QString made = QDateTime::fromMSecsSinceEpoch(static_cast<qint64>(1000 * record.wall_time_s)).toString(QStringLiteral("yyyy-MM-dd HH:mm"));
      const bool used = in_use && in_use->id == record.id;
      setCell(m_records, row, 0, made + (used ? tr(" (in use)") : QString()));
      m_records->item(row, 0)->setData(Qt::UserRole, QString::fromStdString(record.id));
      setCell(m_records, row, 1, QString::fromStdString(record.kind));
      setCell(m_records, row, 2, QString::number(record.observations));
      setCell(m_records, row, 3, QString::number(record.rms_px, 'f', 3));
      setCell(m_records, row, 4, record.uncertainty_px < 0 ? QStringLiteral("-") : QString::number(record.uncertainty_px, 'f', 3));
      setCell(m_records, row, 5, QString::fromStdString(record.note));
    }
    if (!camera.isEmpty()) {
      const int last = static_cast<int>(records.size());
      setCell(m_records, last, 0, tr("workcell's own file") + (in_use ? QString() : tr(" (in use)")));
      m_records->item(last, 0)->setData(Qt::UserRole, QString());
      for (int column = 1; column < 6; ++column) setCell(m_records, last, column, QString());
    }
    int again = 0;
    for (int row = 0; row < m_records->rowCount(); ++row) {
      if (!chosen.isEmpty() && m_records->item(row, 0)->data(Qt::UserRole).toString() == chosen) again = row;
    }
    if (m_records->rowCount() > 0) m_records->selectRow(again);
  }
  const bool is_camera = !camera.isEmpty() && chosenSubject() == session::Subject::kCamera;
  setWhyNot(m_repose, is_camera ? QString() : tr("no camera is chosen."), tr("Click known corners in a picture and put the camera right: two minutes"));
  refreshDifference();
}

void CalibrateLibraryPanel::refreshDifference() {
  const QString camera = chosenCamera();
  const auto& plain = m_bench.calibration().plainWorkcell();
  const bool is_place = chosenSubject() != session::Subject::kCamera;
  const auto* spec = plain && !is_place ? plain->camera(camera.toStdString()) : nullptr;
  const auto in_use = recordInUse();
  const QString id = chosenRecord();
  const auto record = m_bench.calibration().library().find(id.toStdString());
  QString why = m_records->currentRow() < 0 || (spec == nullptr && !is_place) ? tr("no calibration is chosen.") : QString();
  setWhyNot(m_again, why.isEmpty() && !record ? tr("the workcell's own file has no raw data.") : why, tr("Make it anew from the raw data kept with it; the answer is kept beside it, not in use"));
  setWhyNot(m_export, why.isEmpty() && !record ? tr("the workcell's own file is a file already.") : why, tr("Write it as a file"));
  if (why.isEmpty() && (in_use ? in_use->id : std::string()) == id.toStdString()) why = tr("it is in use.");
  if (why.isEmpty()) why = m_bench.whyNotCalibrate();
  setWhyNot(m_use, why, tr("Use this calibration from now on"));
  if (is_place) return refreshPlacement(record);
  if (spec == nullptr) return m_canvas->clearPicture(tr("No camera."));
  const auto now = m_bench.calibration().fileInUse(camera.toStdString(), zoomOf(camera));
  auto other = *spec;
  if (record) other.calibration = record->file;
  const auto read = session::calibrationOf(other);
  const auto then = read ? (*read)->at(zoomOf(camera)) : Result<vision::CameraFile>(read.error());
  if (!now || !then) return m_canvas->clearPicture(QString::fromStdString(now ? then.error().message : now.error().message));
  // The camera in its link, whether the file says so or not: what was mounted anew differs too.
  auto a = *now, b = *then;
  for (auto* file : {&a, &b}) {
    if (file->pose && read && (*read)->hasTable()) file->pose->parent = spec->link;
    if (!file->pose || file->pose->parent != spec->link) file->pose = PoseInParent{spec->link, Pose::Identity()};
  }
  const auto difference = calibration::compareCameras(a, b, m_depth->value(), true);
  if (!difference) return m_canvas->clearPicture(QString::fromStdString(difference.error().message));
  const cv::Mat& live = m_bench.live().picture(camera);
  m_canvas->setPicture(live.empty() ? cv::Mat(a.camera.height, a.camera.width, CV_8U, cv::Scalar(70)) : live);
  vision::Overlay overlay;
  const double arrow = difference->max_px > 0 ? std::min(40.0, 0.06 * a.camera.width / difference->max_px) : 1;
  for (const auto& place : difference->map) {
    if (difference->max_px < kSame_px) break;
    addLine(&overlay, OverlayRole::kMiss, {place.pixel, place.pixel + arrow * place.difference_px});
  }
  m_canvas->setOverlay(overlay);
  m_difference->setText(tr("%1 px rms, %2 px at most: %3 mm at %4 m. A turn of %5\u00b0 explains it but for %6 px rms. Arrows are drawn %7-fold.")
                            .arg(QString::number(difference->rms_px, 'f', 3), QString::number(difference->max_px, 'f', 3), QString::number(difference->max_mm, 'f', 2),
                                 QString::number(m_depth->value(), 'f', 2), QString::number(kDegPerRad * difference->turn.norm(), 'f', 3),
                                 QString::number(difference->after_turn_rms_px, 'f', 3), QString::number(arrow, 'f', 0)));
}

// Of a pan-tilt or object: how far the chosen placement is from the one in use, and how sure it is.
void CalibrateLibraryPanel::refreshPlacement(const std::optional<session::CalibrationRecord>& record) {
  const auto place = m_bench.calibration().placementOf(chosenSubject(), chosenCamera().toStdString(), record ? record->id : std::string());
  const auto in_use = m_bench.calibration().recordInUse(chosenSubject(), chosenCamera().toStdString());
  const auto now = m_bench.calibration().placementOf(chosenSubject(), chosenCamera().toStdString(), in_use ? in_use->id : std::string());
  m_canvas->clearPicture(tr("A placement has no picture:\nits difference stands below."));
  if (!place || !now) return m_difference->setText(QString::fromStdString(place ? now.error().message : place.error().message));
  const Pose &a = now->pose.pose, &b = place->pose.pose;
  m_difference->setText(tr("%1 mm and %2\u00b0 from the one in use; stated to %3 mm (1 sigma, one metre from its origin).")
                            .arg(QString::number(1000 * (a.translation() - b.translation()).norm(), 'f', 2),
                                 QString::number(kDegPerRad * angleBetween(a.linear(), b.linear()), 'f', 3),
                                 record ? QString::number(1000 * place->uncertaintyAtOneMetre(), 'f', 2) : QStringLiteral("-")));
}

void CalibrateLibraryPanel::use() {
  if (!m_use->isEnabled()) return;
  const bool camera = chosenSubject() == session::Subject::kCamera;
  const std::string name = chosenCamera().toStdString(), id = chosenRecord().toStdString();
  const Status used = camera ? m_bench.calibration().use(name, id) : m_bench.calibration().usePlacement(chosenSubject(), name, id);
  if (!used) m_bench.say(QString::fromStdString(used.error().message));
}

}  // namespace longarm::ui
