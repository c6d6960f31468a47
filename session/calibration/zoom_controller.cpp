#include "session/calibration/zoom_controller.h"

#include <algorithm>
#include <cmath>

#include "calibration/zoom/zoom_fit.h"
#include "core/text.h"

namespace longarm::session {

using calibration::TrafficLight;
using vision::ZoomCamera;
using vision::ZoomNode;

namespace {

constexpr double kSameSetting = 1e-6;
constexpr double kPlay = 0.05;             // So far below a setting the lens goes first, to come to it from there.
constexpr double kLargestRefit_px = 1;

bool bySetting(const ZoomNode& a, const ZoomNode& b) { return a.zoom < b.zoom; }

}  // namespace

ZoomController::ZoomController(CalibrationController& calibration, JobRunner& jobs, QObject* parent)
    : QObject(parent), m_calibration(calibration), m_jobs(jobs) {}

void ZoomController::take(ZoomCamera table, std::vector<std::string> warnings) {
  m_table = std::move(table);
  std::sort(m_table.nodes.begin(), m_table.nodes.end(), bySetting);
  m_warnings = std::move(warnings);
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

QString ZoomController::whyNotAddLens(double zoom) const {
  if (!(zoom >= 0 && zoom <= 1)) return tr("%1 is no setting from 0 to 1.").arg(zoom);
  return m_calibration.intrinsics().whyNotSave();
}

void ZoomController::addLens(const std::string& camera, double zoom) {
  if (const QString why = whyNotAddLens(zoom); !why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  double refit_px = 0;
  const auto lens = calibration::withoutK3(m_calibration.intrinsics().outcome()->result.camera, &refit_px);
  if (refit_px > kLargestRefit_px) {
    Q_EMIT failed(tr("Without k3, which a zoom file cannot hold, the lens is up to %1 px off: estimate it with k1 k2 p1 p2 at most.").arg(refit_px, 0, 'f', 2));
    return;
  }
  ZoomNode node;
  node.zoom = zoom;
  node.interior = {lens.fx, lens.fy, lens.skew, lens.cx, lens.cy, lens.distortion[0], lens.distortion[1], lens.distortion[2], lens.distortion[3]};
  const auto file = m_calibration.fileInUse(camera);
  if (file && file->pose) {
    const Pose C_ext = file->pose->pose.inverse();
    const Eigen::Vector3d turn = logSO3(C_ext.linear());
    node.exterior = {C_ext.translation().x(), C_ext.translation().y(), C_ext.translation().z(), turn.x(), turn.y(), turn.z()};
  }
  auto& nodes = m_table.nodes;
  nodes.erase(std::remove_if(nodes.begin(), nodes.end(), [zoom](const ZoomNode& n) { return std::abs(n.zoom - zoom) < kSameSetting; }), nodes.end());
  nodes.push_back(node);
  std::sort(nodes.begin(), nodes.end(), bySetting);
  if (m_table.name.empty()) m_table.name = camera;
  judge();
}

void ZoomController::removeNode(std::size_t node) {
  if (node >= m_table.nodes.size()) return;
  m_table.nodes.erase(m_table.nodes.begin() + static_cast<std::ptrdiff_t>(node));
  judge();
}

void ZoomController::judge() {
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
