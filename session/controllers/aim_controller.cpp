#include "session/controllers/aim_controller.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "session/controllers/calibrated_camera.h"
#include "session/controllers/framing.h"
#include "session/controllers/snapshot_maker.h"

namespace longarm::session {

namespace {

constexpr int kTickMs = 50;
/// Distance at which the clicked point is assumed to lie: the head's own lever arms matter little beyond it [m].
constexpr double kAimDistance = 3.0;
/// A key step adds to the last target rather than to the lagging joints for this long [s].
constexpr double kTargetLife = 1.0;

}  // namespace

Result<PanTiltAngles> anglesToCentre(const planning::Workcell& workcell, const vision::CameraModel& camera_model,
                                     const std::string& camera, const Eigen::Vector2d& pixel,
                                     const JointState& now, PanTiltAngles* clamped) {
  const planning::CameraSpec* spec = workcell.camera(camera);
  if (spec == nullptr) return {ErrorCode::kNotFound, "The workcell has no camera \"" + camera + "\"."};
  const auto aimed = AimedCamera::make(workcell, *spec, now);
  if (!aimed) return aimed.error();
  const auto ray = camera_model.rayOfPixel(pixel);
  if (!ray) return ray.error();
  const Eigen::Vector2d middle{(camera_model.width - 1) / 2.0, (camera_model.height - 1) / 2.0};
  const auto centre = camera_model.normalisedOfPixel(middle);
  if (!centre) return centre.error();
  const Eigen::Vector3d target = aimed->pose(aimed->now()) * Eigen::Vector3d(kAimDistance * *ray);
  const auto angles = aimed->lookingAt(target, *centre);
  if (!angles) return angles.error();
  if (clamped != nullptr) *clamped = aimed->clamped(*angles);
  if (const Status fits = aimed->checkLimits(*angles); !fits) return fits.error();
  return *angles;
}

AimController::AimController(QObject* parent) : QObject(parent) {
  m_timer.setInterval(kTickMs);
  connect(&m_timer, &QTimer::timeout, this, &AimController::tick);
}

void AimController::setWorkcell(std::shared_ptr<const planning::Workcell> workcell) {
  m_workcell = std::move(workcell);
  m_pan_tilt = m_workcell && !m_workcell->pan_tilts.empty() ? m_workcell->pan_tilts.front().name : std::string();
  setStick(0, 0);
}

void AimController::setPanTilt(const QString& name) {
  m_pan_tilt = name.toStdString();
  m_has_target = false;
}

QString AimController::whyNot() const {
  if (m_feed == nullptr) return tr("No robot is connected.");
  if (!m_workcell || m_workcell->pan_tilts.empty()) return tr("The workcell has no pan-tilt.");
  if (cameraOfPanTilt() == nullptr) return tr("No camera is mounted on pan-tilt \"%1\".").arg(panTilt());
  if (!m_feed->jointState()) return tr("The robot's joints are not known yet.");
  return {};
}

const planning::CameraSpec* AimController::cameraOfPanTilt() const {
  if (!m_workcell) return nullptr;
  for (const auto& camera : m_workcell->cameras) {
    if (!m_pan_tilt.empty() && camera.pan_tilt == m_pan_tilt) return &camera;
  }
  return nullptr;
}

void AimController::setStick(double right, double up) {
  m_right = std::clamp(right, -1.0, 1.0);
  m_up = std::clamp(up, -1.0, 1.0);
  if (m_right == 0 && m_up == 0) {
    m_timer.stop();
    return;
  }
  if (const QString reason = whyNot(); !reason.isEmpty()) {
    m_right = m_up = 0;
    m_timer.stop();
    Q_EMIT failed(reason);
    return;
  }
  if (m_timer.isActive()) return;
  m_last_tick_s = m_feed->now_s();
  m_timer.start();
}

void AimController::tick() {
  if (!whyNot().isEmpty()) {
    setStick(0, 0);
    return;
  }
  const double now_s = m_feed->now_s();
  const double dt = std::clamp(now_s - m_last_tick_s, 0.0, 0.2);
  m_last_tick_s = now_s;
  const double rate = m_max_rate * fineness();
  const Status moved = turnBy(m_right * rate * dt, m_up * rate * dt);
  if (!moved) {
    m_timer.stop();
    Q_EMIT failed(QString::fromStdString(moved.error().message));
  }
}

// Zoomed in, the picture would fly past: turns are as much smaller as things are larger.
double AimController::fineness() const {
  const planning::CameraSpec* camera = cameraOfPanTilt();
  const auto zoom = m_feed->zoomAt(camera->name, m_feed->now_s());
  const auto calibration = calibrationOf(*camera);
  if (!zoom || !*zoom || !calibration) return 1;
  const auto larger = (*calibration)->magnification(**zoom);
  return larger ? 1 / std::max(1.0, *larger) : 1;
}

void AimController::step(double right, double up) {
  if (const QString reason = whyNot(); !reason.isEmpty()) {
    Q_EMIT failed(reason);
    return;
  }
  const double fine = fineness();
  const Status moved = turnBy(fine * right, fine * up);
  if (!moved) Q_EMIT failed(QString::fromStdString(moved.error().message));
}

Status AimController::turnBy(double right, double up) {
  const auto state = m_feed->jointState();
  const auto aimed = AimedCamera::make(*m_workcell, *cameraOfPanTilt(), *state);
  if (!aimed) return aimed.error();
  const bool fresh = m_has_target && m_feed->now_s() - m_sent_s < kTargetLife;
  PanTiltAngles wanted = fresh ? m_target : aimed->now();
  // Which way each joint turns the view is read off the robot, not assumed: x of the camera is right, y down.
  constexpr double h = 1e-4;
  const Pose here = aimed->pose(wanted);
  const Eigen::Vector3d right_axis = here.linear().col(0), down_axis = here.linear().col(1);
  const Eigen::Vector3d by_pan = aimed->pose({wanted.pan + h, wanted.tilt}).linear().col(2) - here.linear().col(2);
  const Eigen::Vector3d by_tilt = aimed->pose({wanted.pan, wanted.tilt + h}).linear().col(2) - here.linear().col(2);
  wanted.pan += by_pan.dot(right_axis) >= 0 ? right : -right;
  wanted.tilt += by_tilt.dot(down_axis) <= 0 ? up : -up;
  return send(aimed->clamped(wanted));
}

void AimController::aimAt(const QString& camera, const Eigen::Vector2d& pixel) {
  const std::string name = camera.toStdString();
  const auto view = viewNow(name);
  if (!view) {
    Q_EMIT failed(QString::fromStdString(view.error().message));
    return;
  }
  const planning::CameraSpec* spec = m_workcell->camera(name);
  PanTiltAngles reachable;
  const auto angles = anglesToCentre(*m_workcell, view->camera, name, pixel, *m_feed->jointState(), &reachable);
  if (!angles && angles.error().code != ErrorCode::kOutOfLimits) {
    Q_EMIT failed(QString::fromStdString(angles.error().message));
    return;
  }
  m_pan_tilt = spec->pan_tilt;
  const Status sent = send(angles ? *angles : reachable);
  if (!angles) Q_EMIT failed(QString::fromStdString(angles.error().message + " It goes as far as it can."));
  if (!sent) Q_EMIT failed(QString::fromStdString(sent.error().message));
}

void AimController::frameRegion(const QString& camera, const Eigen::Vector2d& corner, const Eigen::Vector2d& opposite) {
  const auto view = viewNow(camera.toStdString());
  const auto region = view ? regionAt(*view, corner, opposite, kAimDistance) : Result<std::vector<Eigen::Vector3d>>(view.error());
  if (!region) {
    Q_EMIT failed(QString::fromStdString(region.error().message));
    return;
  }
  framePoints(camera, *region);
}

Result<vision::View> AimController::viewNow(const std::string& camera) const {
  if (m_feed == nullptr || !m_workcell) return Error{ErrorCode::kDisconnected, whyNot().toStdString()};
  const auto state = m_feed->jointState();
  if (!state) return Error{ErrorCode::kStale, "The robot's joints are not known yet."};
  const auto zoom = m_feed->zoomAt(camera, m_feed->now_s());
  return zoom ? cameraView(*m_workcell, camera, *state, *zoom) : Result<vision::View>(zoom.error());
}

void AimController::framePoints(const QString& camera, const std::vector<Eigen::Vector3d>& points_W) {
  const std::string name = camera.toStdString();
  const auto view = viewNow(name);
  const planning::CameraSpec* spec = m_workcell ? m_workcell->camera(name) : nullptr;
  const auto framed = view ? frame(*m_workcell, *spec, points_W, *m_feed->jointState(), view->zoom, {})
                           : Result<Framing>(view.error());
  if (!framed) {
    Q_EMIT failed(QString::fromStdString(framed.error().message));
    return;
  }
  m_pan_tilt = spec->pan_tilt;
  Status sent = send(framed->angles);
  if (sent && framed->zoom) sent = m_feed->setZoom(name, *framed->zoom);
  if (!sent) Q_EMIT failed(QString::fromStdString(sent.error().message));
  if (!framed->shortfall.empty()) Q_EMIT failed(QString::fromStdString(framed->shortfall));
}

Status AimController::send(const PanTiltAngles& wanted) {
  const Status sent = m_feed->movePanTilt(m_pan_tilt, wanted.pan, wanted.tilt);
  if (!sent) return sent;
  m_target = wanted;
  m_has_target = true;
  m_sent_s = m_feed->now_s();
  Q_EMIT aimed(QString::fromStdString(m_pan_tilt));
  return {};
}

}  // namespace longarm::session
