#include "session/calibration/calibration_controller.h"

#include <algorithm>

#include <QStandardPaths>

#include "core/clock.h"
#include "core/text.h"

namespace longarm::session {

namespace {

constexpr double kWorse = 1.1;             // So much larger an uncertainty is worth a word.

std::string folderOf(const QString& given) {
  if (!given.isEmpty()) return given.toStdString();
  const QString place = QStandardPaths::writableLocation(QStandardPaths::AppLocalDataLocation);
  return place.toStdString() + "/calibrations";
}

bool sameSize(const vision::CameraModel& a, const vision::CameraModel& b) {
  return a.width <= 0 || b.width <= 0 || (a.width == b.width && a.height == b.height);
}

// Covariance of lens and pose together; what the two files say of each other's part is not kept.
Eigen::MatrixXd joined(const vision::CameraFile& file, const CameraChange& change) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(16, 16);
  if (file.covariance) out.topLeftCorner<10, 10>() = file.covariance->topLeftCorner<10, 10>();
  if (file.covariance && file.covariance->rows() == 16) out.bottomRightCorner<6, 6>() = file.covariance->bottomRightCorner<6, 6>();
  if (change.lens) out.topLeftCorner<10, 10>() = change.lens_covariance;
  if (change.X_LC) out.bottomRightCorner<6, 6>() = change.pose_covariance;
  return out;
}

}  // namespace

std::optional<double> meanUncertainty(const vision::CameraFile& file) {
  if (!file.covariance || file.covariance->topLeftCorner<10, 10>().isZero(0)) return std::nullopt;
  const auto map = calibration::lensUncertainty(file.camera, file.covariance->topLeftCorner<10, 10>(), 17, 13);
  return map ? std::optional<double>(map->mean_px) : std::nullopt;
}

CalibrationController::CalibrationController(Document& document, JobRunner& jobs, const QString& library_folder, QObject* parent)
    : QObject(parent), m_document(document), m_library(folderOf(library_folder)), m_intrinsics(jobs) {}

std::shared_ptr<const planning::Workcell> CalibrationController::workcellInUse() const {
  if (!m_plain) return nullptr;
  auto changed = std::make_shared<planning::Workcell>(*m_plain);
  bool any = false;
  for (auto& camera : changed->cameras) {
    const auto record = m_library.find(m_library.inUse(m_plain->name, camera.name));
    if (!record) continue;
    camera.calibration = record->file;
    any = true;
  }
  for (auto& object : changed->objects) {
    const auto placed = m_placed.find(object.name);
    if (placed == m_placed.end()) continue;
    object.X_WO = placed->second;
    any = true;
  }
  return any ? changed : m_plain;
}

Result<vision::CameraFile> CalibrationController::fileInUse(const std::string& camera) const {
  const auto& workcell = m_document.workcell();
  const auto* spec = workcell ? workcell->camera(camera) : nullptr;
  if (spec == nullptr) return Error{ErrorCode::kNotFound, "The workcell has no camera \"" + camera + "\"."};
  return vision::readCameraFile(spec->calibration);
}

std::optional<CalibrationRecord> CalibrationController::recordInUse(const std::string& camera) const {
  if (!m_plain) return std::nullopt;
  return m_library.find(m_library.inUse(m_plain->name, camera));
}

Result<vision::CameraFile> CalibrationController::changed(const CameraChange& change) const {
  auto file = fileInUse(change.camera);
  if (!file) return file.error();
  if (change.lens) {
    if (!sameSize(*change.lens, file->camera)) {
      const auto size = [](const vision::CameraModel& c) { return std::to_string(c.width) + " x " + std::to_string(c.height); };
      return Error{ErrorCode::kInvalidInput, "The pictures were " + size(*change.lens) + " pixels, camera " + change.camera + " gives " +
                                                 size(file->camera) + ". Choose the camera that took the pictures."};
    }
  }
  vision::CameraFile out = *file;
  out.covariance = joined(*file, change);
  if (change.lens) {
    out.camera = *change.lens;
    if (out.camera.width <= 0) out.camera.width = file->camera.width;
    if (out.camera.height <= 0) out.camera.height = file->camera.height;
  }
  out.camera.name = change.camera;
  const std::string& link = m_document.workcell()->camera(change.camera)->link;
  if (change.X_LC) out.pose = PoseInParent{link, *change.X_LC};
  else if (!out.pose || out.pose->parent != link) out.pose = PoseInParent{link, Pose::Identity()};
  return out;
}

QString CalibrationController::whyWorse(const CameraChange& change) const {
  if (!change.lens) return {};
  const auto now = fileInUse(change.camera), then = changed(change);
  if (!now || !then) return {};
  const auto a = meanUncertainty(*now), b = meanUncertainty(*then);
  if (!a || !b || *b <= kWorse * *a) return {};
  return tr("Less certain than the calibration in use: %1 px against %2 px on average over the picture.")
      .arg(QString::number(*b, 'f', 3), QString::number(*a, 'f', 3));
}

Status CalibrationController::apply(const CameraChange& change) {
  const auto file = changed(change);
  if (!file) return file.error();
  CalibrationRecord record;
  record.workcell = m_plain ? m_plain->name : std::string();
  record.camera = change.camera;
  record.kind = change.kind;
  record.note = change.note;
  record.wall_time_s = wallTime_s();
  record.observations = change.observations;
  record.rms_px = change.rms_px;
  record.uncertainty_px = meanUncertainty(*file).value_or(-1);
  const auto kept = m_library.add(record, *file, change.raw, change.raw_ending);
  if (!kept) return kept.error();
  return use(change.camera, kept->id);
}

Status CalibrationController::use(const std::string& camera, const std::string& id) {
  if (!m_plain || m_plain->camera(camera) == nullptr) return {ErrorCode::kNotFound, "The workcell has no camera \"" + camera + "\"."};
  if (const Status set = m_library.setInUse(m_plain->name, camera, id); !set) return set;
  Q_EMIT libraryChanged();
  Q_EMIT applied(QString::fromStdString(camera));
  return {};
}

Status CalibrationController::placeObject(const std::string& object, const Pose& X_WO) {
  const auto known = [&](const planning::WorldObject& each) { return each.name == object; };
  if (!m_plain || std::none_of(m_plain->objects.begin(), m_plain->objects.end(), known)) {
    return {ErrorCode::kNotFound, "The workcell has no object \"" + object + "\"."};
  }
  m_placed[object] = X_WO;
  Q_EMIT objectPlaced(QString::fromStdString(object));
  return {};
}

}  // namespace longarm::session
