#include "session/calibration/zoom_controller.h"

#include <algorithm>
#include <cmath>

#include "calibration/zoom/zoom_fit.h"
#include "core/text.h"

namespace longarm::session {

using calibration::TrafficLight;
using calibration::ZoomLens;
using vision::ZoomCamera;
using vision::ZoomNode;

namespace {

constexpr double kSameSetting = 1e-6;
constexpr double kPlay = 0.05;             // So far below a setting the lens goes first, to come to it from there.
constexpr double kLargestRefit_px = 1;

bool bySetting(const ZoomLens& a, const ZoomLens& b) { return a.node.zoom < b.node.zoom; }

}  // namespace

ZoomController::ZoomController(CalibrationController& calibration, JobRunner& jobs, QObject* parent)
    : QObject(parent), m_calibration(calibration), m_jobs(jobs) {}

void ZoomController::take(ZoomCamera table, std::vector<std::string> warnings) {
  m_lenses.clear();
  for (const auto& node : table.nodes) {
    ZoomLens lens;
    lens.node = node;
    m_lenses.push_back(lens);
  }
  m_table = std::move(table);
  m_file_warnings = std::move(warnings);
  judge();
}

void ZoomController::openFile(const QString& path) {
  m_jobs.run<vision::ZoomFile>(
      this, [file = path.toStdString()] { return vision::readZoomFile(file); },
      [this](Result<vision::ZoomFile> file) {
        if (file) take(file->cameras.front(), file->warnings);
        else Q_EMIT failed(QString::fromStdString(file.error().message));
      });
}

void ZoomController::openFolder(const QString& folder) {
  m_jobs.run<calibration::ZoomFit>(
      this, [path = folder.toStdString()] { return calibration::fitZoom(path); },
      [this](Result<calibration::ZoomFit> fit) {
        if (fit) take(fit->camera, fit->warnings);
        else Q_EMIT failed(QString::fromStdString(fit.error().message));
      });
}

void ZoomController::clear() { take({}, {}); }

double ZoomController::lastSetting(const std::string& camera) const {
  const auto& workcell = m_calibration.plainWorkcell();
  const auto* spec = workcell ? workcell->camera(camera) : nullptr;
  return spec != nullptr && spec->digital_zoom.factor > 1 ? spec->digital_zoom.from : 1;
}

QString ZoomController::whyNotAddLens(const std::string& camera, double zoom) const {
  if (!(zoom >= 0 && zoom <= 1)) return tr("%1 is no setting from 0 to 1.").arg(zoom);
  if (const double last = lastSetting(camera); zoom > last + kSameSetting) {
    return tr("beyond %1 the picture is only enlarged, which needs no calibration.").arg(last);
  }
  if (const QString why = m_calibration.intrinsics().whyNotSave(); !why.isEmpty()) return why;
  const auto taken = m_calibration.intrinsics().outcome()->zoom;
  if (taken && !BoardCollection::sameZoom(taken, zoom)) {
    return tr("the board was last seen at zoom %1, not %2: turn the lens there and show it the board.").arg(QString::number(*taken, 'f', 3), QString::number(zoom, 'f', 3));
  }
  return {};
}

void ZoomController::addLens(const std::string& camera, double zoom) {
  if (const QString why = whyNotAddLens(camera, zoom); !why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  const auto& result = m_calibration.intrinsics().outcome()->result;
  double refit_px = 0;
  const auto lens = calibration::withoutK3(result.camera, &refit_px);
  if (refit_px > kLargestRefit_px) {
    Q_EMIT failed(tr("Without k3, which a zoom file cannot hold, the lens is up to %1 px off: estimate it with k1 k2 p1 p2 at most.").arg(refit_px, 0, 'f', 2));
    return;
  }
  ZoomLens added;
  added.covariance = result.covariance;
  ZoomNode& node = added.node;
  node.zoom = zoom;
  node.interior = {lens.fx, lens.fy, lens.skew, lens.cx, lens.cy, lens.distortion[0], lens.distortion[1], lens.distortion[2], lens.distortion[3]};
  const Pose C_ext = m_calibration.mountInUse(camera, zoom).inverse();
  const Eigen::Vector3d turn = logSO3(C_ext.linear());
  node.exterior = {C_ext.translation().x(), C_ext.translation().y(), C_ext.translation().z(), turn.x(), turn.y(), turn.z()};
  m_lenses.erase(std::remove_if(m_lenses.begin(), m_lenses.end(), [zoom](const ZoomLens& l) { return std::abs(l.node.zoom - zoom) < kSameSetting; }), m_lenses.end());
  m_lenses.push_back(added);
  if (m_table.name.empty()) m_table.name = camera;
  judge();
}

void ZoomController::removeNode(std::size_t node) {
  if (node >= m_lenses.size()) return;
  m_lenses.erase(m_lenses.begin() + static_cast<std::ptrdiff_t>(node));
  judge();
}

void ZoomController::judge() {
  std::sort(m_lenses.begin(), m_lenses.end(), bySetting);
  const auto joined = calibration::joinZoom(m_lenses);
  m_table.nodes.clear();
  for (const auto& lens : joined.lenses) m_table.nodes.push_back(lens.node);
  m_warnings = m_file_warnings;
  m_warnings.insert(m_warnings.end(), joined.warnings.begin(), joined.warnings.end());
  m_misses = calibration::leaveOneOut(m_table);
  m_advised = calibration::advisedSettings(m_table, m_misses);
  if (m_table.nodes.size() == 2 && m_advised.empty()) m_advised = {(m_table.nodes[0].zoom + m_table.nodes[1].zoom) / 2};
  Q_EMIT changed();
}

TrafficLight ZoomController::light() const {
  TrafficLight worst = m_misses.empty() ? TrafficLight::kRed : TrafficLight::kGreen;
  for (const auto& miss : m_misses) {
    if (!miss.nominal) worst = std::max(worst, miss.light);
  }
  return worst;
}

QString ZoomController::whyNotSave() const {
  const auto count = m_table.nodes.size();
  return count >= 2 ? QString() : tr("the table has %1 settings; two or more are needed.").arg(count);
}

void ZoomController::save(const QString& path) {
  if (const QString why = whyNotSave(); !why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  const Status written = vision::writeZoomFile(path.toStdString(), file(path.toStdString()));
  if (written) Q_EMIT saved(path);
  else Q_EMIT failed(QString::fromStdString(written.error().message));
}

void ZoomController::use(const std::string& camera) {
  const QString why = whyNotSave();
  const Status used = why.isEmpty() ? m_calibration.applyTable(camera, file(camera + ".xml")) : Status(ErrorCode::kRefused, why.toStdString());
  if (!used) Q_EMIT failed(QString::fromStdString(used.error().message));
}

vision::ZoomFile ZoomController::file(const std::string& name) const {
  vision::ZoomFile file;
  file.headers = {{"SR_filename", name},
                  {"SR_comment", "SR_cam_int: fx fy fxy u0 v0 k1 k2 p1 p2. SR_cam_ext: dx dy dz in metres and a rotation vector in radians, mapping the mount's frame into the camera's."}};
  file.cameras = {m_table};
  return file;
}

std::vector<double> ZoomController::approach(double zoom) {
  const double target = std::clamp(zoom, 0.0, 1.0);
  if (target < kSameSetting) return {target};      // against its stop
  return {std::max(0.0, target - kPlay), target};
}

}  // namespace longarm::session
