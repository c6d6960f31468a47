#include "session/calibration/calibration_controller.h"

#include <algorithm>
#include <cmath>

#include <QStandardPaths>

#include "core/clock.h"
#include "core/text.h"
#include "session/calibration/solve_again.h"
#include "session/controllers/calibrated_camera.h"

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

Error oneLens(const std::string& camera) {
  return {ErrorCode::kInvalidInput, "Camera " + camera + " zooms: one lens does not describe it. Add this calibration to its table on the page Zoom."};
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

Result<int> panJointOf(const planning::Workcell& workcell, const std::string& pan_tilt) {
  for (const auto& unit : workcell.pan_tilts) {
    if (unit.name == pan_tilt) return workcell.model->jointIndex(unit.pan_joint);
  }
  return Error{ErrorCode::kNotFound, "The workcell has no pan-tilt \"" + pan_tilt + "\"."};
}

std::optional<double> mountUncertainty(const vision::CameraFile& file) {
  if (!file.covariance || file.covariance->rows() != 16 || file.covariance->bottomRightCorner<6, 6>().isZero(0)) return std::nullopt;
  return std::sqrt(std::max(0.0, file.covariance->bottomRightCorner<6, 6>().trace()));
}

std::optional<double> meanUncertainty(const vision::CameraFile& file) {
  if (!file.covariance || file.covariance->topLeftCorner<10, 10>().isZero(0)) return std::nullopt;
  const auto map = calibration::lensUncertainty(file.camera, file.covariance->topLeftCorner<10, 10>(), 17, 13);
  return map ? std::optional<double>(map->mean_px) : std::nullopt;
}

CalibrationController::CalibrationController(Document& document, JobRunner& jobs, const QString& library_folder, QObject* parent)
    : QObject(parent), m_document(document), m_jobs(jobs), m_library(folderOf(library_folder)), m_intrinsics(jobs) {}

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
    const auto placed = placementInUse(Subject::kObject, object.name);
    if (!placed) continue;
    object.X_WO = placed->pose.pose;
    any = true;
  }
  for (const auto& unit : changed->pan_tilts) {
    const auto placed = placementInUse(Subject::kPanTilt, unit.name);
    const auto joint = panJointOf(*changed, unit.name);
    if (!placed || !joint) continue;
    changed->model = changed->model->withJointPose(*joint, placed->pose.pose);
    any = true;
  }
  return any ? changed : m_plain;
}

Result<vision::CameraFile> CalibrationController::fileInUse(const std::string& camera, std::optional<double> zoom) const {
  const auto& workcell = m_document.workcell();
  const auto* spec = workcell ? workcell->camera(camera) : nullptr;
  if (spec == nullptr) return Error{ErrorCode::kNotFound, "The workcell has no camera \"" + camera + "\"."};
  const auto calibration = calibrationOf(*spec);
  if (!calibration) return calibration.error();
  auto file = (*calibration)->at(zoom);
  if (file && file->pose && (*calibration)->hasTable()) file->pose->parent = spec->link;
  return file;
}

Pose CalibrationController::mountInUse(const std::string& camera, std::optional<double> zoom) const {
  auto file = fileInUse(camera, zoom);
  if (!file && zoom) file = fileInUse(camera, 0);
  if (!file || !file->pose || file->pose->parent != m_document.workcell()->camera(camera)->link) return Pose::Identity();
  return file->pose->pose;
}

bool CalibrationController::hasTable(const std::string& camera) const {
  const auto* spec = m_document.workcell() ? m_document.workcell()->camera(camera) : nullptr;
  if (spec == nullptr) return false;
  const auto calibration = calibrationOf(*spec);
  return calibration && (*calibration)->hasTable();
}

std::optional<CalibrationRecord> CalibrationController::recordInUse(const std::string& camera) const {
  if (!m_plain) return std::nullopt;
  return m_library.find(m_library.inUse(m_plain->name, camera));
}

Result<vision::CameraFile> CalibrationController::changed(const CameraChange& change) const {
  if (change.lens && hasTable(change.camera)) return oneLens(change.camera);
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

std::optional<CalibrationRecord> CalibrationController::recordInUse(Subject subject, const std::string& name) const {
  if (!m_plain) return std::nullopt;
  return m_library.find(m_library.inUse(m_plain->name, name, subject));
}

std::optional<Placement> CalibrationController::placementInUse(Subject subject, const std::string& name) const {
  const auto record = recordInUse(subject, name);
  if (!record) return std::nullopt;
  auto placement = readPlacement(record->file);
  return placement ? std::optional<Placement>(std::move(*placement)) : std::nullopt;
}

Result<Placement> CalibrationController::placementOf(Subject subject, const std::string& name, const std::string& id) const {
  if (const auto record = m_library.find(id)) return readPlacement(record->file);
  if (!knows(subject, name)) return Error{ErrorCode::kNotFound, std::string("The workcell has no ") + toString(subject) + " \"" + name + "\"."};
  Placement own;
  for (const auto& object : m_plain->objects) {
    if (subject == Subject::kObject && object.name == name) own.pose = {object.attached_link, object.X_WO};
  }
  if (subject == Subject::kPanTilt) {
    const auto index = panJointOf(*m_plain, name);
    if (!index) return index.error();
    const auto& joint = m_plain->model->joints()[static_cast<std::size_t>(*index)];
    own.pose = {m_plain->model->links()[static_cast<std::size_t>(joint.parent_link)].name, joint.X_PJ};
  }
  return own;
}

bool CalibrationController::knows(Subject subject, const std::string& name) const {
  if (!m_plain) return false;
  if (subject == Subject::kCamera) return m_plain->camera(name) != nullptr;
  const auto named = [&](const auto& each) { return each.name == name; };
  if (subject == Subject::kObject) return std::any_of(m_plain->objects.begin(), m_plain->objects.end(), named);
  return std::any_of(m_plain->pan_tilts.begin(), m_plain->pan_tilts.end(), named);
}

QString CalibrationController::whyWorse(const PlaceChange& change) const {
  const auto now = placementInUse(change.subject, change.name);
  if (!now || change.placement.uncertaintyAtOneMetre() <= kWorse * now->uncertaintyAtOneMetre()) return {};
  return tr("Less certain than the placement in use: %1 mm against %2 mm one metre from its origin.")
      .arg(QString::number(1000 * change.placement.uncertaintyAtOneMetre(), 'f', 2), QString::number(1000 * now->uncertaintyAtOneMetre(), 'f', 2));
}

QString CalibrationController::whyWorse(const CameraChange& change) const {
  const auto now = fileInUse(change.camera), then = changed(change);
  if (!now || !then) return {};
  if (!change.lens) {
    const auto a = mountUncertainty(*now), b = mountUncertainty(*then);
    if (!a || !b || *b <= kWorse * *a) return {};
    return tr("Less certain than the mount in use: %1 mm against %2 mm one metre before the camera.")
        .arg(QString::number(1000 * *b, 'f', 2), QString::number(1000 * *a, 'f', 2));
  }
  const auto a = meanUncertainty(*now), b = meanUncertainty(*then);
  if (!a || !b || *b <= kWorse * *a) return {};
  return tr("Less certain than the calibration in use: %1 px against %2 px on average over the picture.")
      .arg(QString::number(*b, 'f', 3), QString::number(*a, 'f', 3));
}

// A camera with a table keeps its lens at every setting; all settings move with the mount.
Result<CalibrationRecord> CalibrationController::keepMount(const CameraChange& change, CalibrationRecord record) {
  if (change.lens || !change.X_LC) {
    return oneLens(change.camera);
  }
  const auto now = fileInUse(change.camera, change.zoom);
  if (!now) return now.error();
  auto table = vision::readZoomFile(m_document.workcell()->camera(change.camera)->calibration);
  if (!table) return table.error();
  vision::moveMount(*change.X_LC * now->pose->pose.inverse(), &table->cameras.front());
  return m_library.add(record, *table, change.raw, change.raw_ending);
}

Result<CalibrationRecord> CalibrationController::keep(const CameraChange& change) {
  CalibrationRecord record;
  record.workcell = m_plain ? m_plain->name : std::string();
  record.name = change.camera;
  record.kind = change.kind;
  record.note = change.note;
  record.wall_time_s = wallTime_s();
  record.observations = change.observations;
  record.rms_px = change.rms_px;
  if (hasTable(change.camera)) return keepMount(change, std::move(record));
  const auto file = changed(change);
  if (!file) return file.error();
  record.uncertainty_px = meanUncertainty(*file).value_or(-1);
  return m_library.add(record, *file, change.raw, change.raw_ending);
}

Status CalibrationController::apply(const CameraChange& change) {
  const auto kept = keep(change);
  return kept ? use(change.camera, kept->id) : Status(kept.error());
}

Status CalibrationController::applyTable(const std::string& camera, const vision::ZoomFile& table) {
  const auto* spec = m_plain ? m_plain->camera(camera) : nullptr;
  if (spec == nullptr || !spec->zooms) return {ErrorCode::kInvalidInput, "Camera " + camera + " has no zoom: a table is of no use to it."};
  CalibrationRecord record;
  record.workcell = m_plain->name;
  record.name = camera;
  record.kind = "zoom";
  record.note = std::to_string(table.cameras.front().nodes.size()) + " settings";
  record.wall_time_s = wallTime_s();
  record.observations = static_cast<int>(table.cameras.front().nodes.size());
  const auto kept = m_library.add(record, table);
  return kept ? use(camera, kept->id) : Status(kept.error());
}

Status CalibrationController::use(const std::string& camera, const std::string& id) {
  if (!m_plain || m_plain->camera(camera) == nullptr) return {ErrorCode::kNotFound, "The workcell has no camera \"" + camera + "\"."};
  if (const Status set = m_library.setInUse(m_plain->name, camera, id); !set) return set;
  Q_EMIT libraryChanged();
  Q_EMIT applied(QString::fromStdString(camera));
  return {};
}

Result<CalibrationRecord> CalibrationController::keep(const PlaceChange& change) {
  if (!knows(change.subject, change.name)) {
    return Error{ErrorCode::kNotFound, std::string("The workcell has no ") + toString(change.subject) + " \"" + change.name + "\"."};
  }
  CalibrationRecord record;
  record.workcell = m_plain->name;
  record.subject = change.subject;
  record.name = change.name;
  record.kind = "pose";
  record.note = change.note;
  record.wall_time_s = wallTime_s();
  record.observations = change.observations;
  record.rms_px = change.rms_px;
  return m_library.add(record, change.placement, change.raw, change.raw_ending);
}

Status CalibrationController::apply(const PlaceChange& change) {
  const auto kept = keep(change);
  return kept ? usePlacement(change.subject, change.name, kept->id) : Status(kept.error());
}

void CalibrationController::solveAgain(const std::string& id) {
  const auto record = m_library.find(id);
  if (!record) {
    Q_EMIT failed(tr("There is no such calibration in the library."));
    return;
  }
  m_jobs.run<SolvedAgain>(
      this, [record = *record] { return session::solveAgain(record); },
      [this](Result<SolvedAgain> solved) {
        auto kept = !solved ? Result<CalibrationRecord>(solved.error()) : solved->camera ? keep(*solved->camera) : keep(*solved->place);
        if (!kept) {
          Q_EMIT failed(QString::fromStdString(kept.error().message));
          return;
        }
        Q_EMIT libraryChanged();
        Q_EMIT solvedAgain(QString::fromStdString(kept->id));
      });
}

Status CalibrationController::usePlacement(Subject subject, const std::string& name, const std::string& id) {
  if (!knows(subject, name)) return {ErrorCode::kNotFound, std::string("The workcell has no ") + toString(subject) + " \"" + name + "\"."};
  if (const Status set = m_library.setInUse(m_plain->name, name, id, subject); !set) return set;
  Q_EMIT libraryChanged();
  Q_EMIT placed(QString::fromStdString(name));
  return {};
}

}  // namespace longarm::session
