#include "session/controllers/zoom_drive.h"

#include <algorithm>
#include <cmath>

#include "session/controllers/calibrated_camera.h"

namespace longarm::session {
namespace {

constexpr int kTickMs = 50;
constexpr double kZoomRate = 0.25, kFocusRate = 0.35;    // of the whole travel per second
constexpr double kLead = 0.05;                           // The wanted setting runs no further ahead of the lens.

}  // namespace

ZoomDrive::ZoomDrive(QObject* parent) : QObject(parent) {
  m_timer.setInterval(kTickMs);
  connect(&m_timer, &QTimer::timeout, this, &ZoomDrive::tick);
}

void ZoomDrive::setFeed(RobotFeed* feed) {
  release();
  m_feed = feed;
}

void ZoomDrive::setWorkcell(std::shared_ptr<const planning::Workcell> workcell) { m_workcell = std::move(workcell); }

const planning::CameraSpec* ZoomDrive::spec(const QString& camera) const {
  return m_workcell ? m_workcell->camera(camera.toStdString()) : nullptr;
}

bool ZoomDrive::zooms(const QString& camera) const {
  const auto* found = spec(camera);
  return found != nullptr && found->zooms;
}

QString ZoomDrive::whyNot(const QString& camera) const {
  if (m_feed == nullptr) return tr("No robot is connected.");
  if (!zooms(camera)) return tr("Camera %1 has no zoom.").arg(camera);
  if (!zoom(camera)) return tr("Camera %1 has not told its zoom yet.").arg(camera);
  return {};
}

std::optional<double> ZoomDrive::zoom(const QString& camera) const {
  return m_feed == nullptr ? std::nullopt : zoomAt(camera, m_feed->now_s());
}

std::optional<double> ZoomDrive::zoomAt(const QString& camera, double stamp_s) const {
  if (m_feed == nullptr || !zooms(camera)) return {};
  const auto zoom = m_feed->zoomAt(camera.toStdString(), stamp_s);
  return zoom ? *zoom : std::nullopt;
}

std::optional<double> ZoomDrive::focus(const QString& camera) const {
  return m_feed == nullptr ? std::nullopt : m_feed->focus(camera.toStdString());
}

std::optional<double> ZoomDrive::magnification(const QString& camera) const {
  const auto* found = spec(camera);
  const auto here = zoom(camera);
  if (found == nullptr || !here) return {};
  const auto calibration = calibrationOf(*found);
  return calibration ? (*calibration)->magnification(*here) : std::nullopt;
}

bool ZoomDrive::sent(const QString& camera, const Status& status) {
  if (status) {
    Q_EMIT commanded(camera);
    return true;
  }
  m_timer.stop();
  m_held = Held::kNothing;
  Q_EMIT failed(QString::fromStdString(status.error().message));
  return false;
}

// The lens may go there; what is seen there can only be looked at.
void ZoomDrive::warnOutside(const QString& camera, double zoom01) {
  const auto calibration = calibrationOf(*spec(camera));
  if (!calibration) return;
  const auto [low, high] = (*calibration)->range();
  if (zoom01 >= low && zoom01 <= high) return;
  Q_EMIT failed(tr("Camera %1 is calibrated for zoom %2 to %3: at %4 its picture can be looked at, not measured in.")
                    .arg(camera).arg(low, 0, 'f', 2).arg(high, 0, 'f', 2).arg(zoom01, 0, 'f', 2));
}

void ZoomDrive::setZoom(const QString& camera, double zoom01) {
  if (const QString why = whyNot(camera); !why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  if (sent(camera, m_feed->setZoom(camera.toStdString(), zoom01))) warnOutside(camera, zoom01);
}

void ZoomDrive::setFocus(const QString& camera, double focus01) {
  if (const QString why = whyNot(camera); !why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  sent(camera, m_feed->setFocus(camera.toStdString(), focus01));
}

void ZoomDrive::focusItself(const QString& camera) {
  if (const QString why = whyNot(camera); !why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  sent(camera, m_feed->focusItself(camera.toStdString()));
}

void ZoomDrive::holdZoom(const QString& camera, int direction) { hold(Held::kZoom, camera, direction); }
void ZoomDrive::holdFocus(const QString& camera, int direction) { hold(Held::kFocus, camera, direction); }

void ZoomDrive::hold(Held what, const QString& camera, int direction) {
  if (const QString why = whyNot(camera); !why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  m_held = what;
  m_camera = camera;
  m_direction = direction > 0 ? 1 : -1;
  m_wanted = (what == Held::kZoom ? zoom(camera) : focus(camera)).value_or(1);
  m_last_s = m_feed->now_s();
  m_timer.start();
}

void ZoomDrive::tick() {
  const bool zooming = m_held == Held::kZoom;
  const auto here = zooming ? zoom(m_camera) : focus(m_camera);
  if (!here) return release();
  const double now_s = m_feed->now_s();
  const double way = m_direction * (zooming ? kZoomRate : kFocusRate) * std::clamp(now_s - m_last_s, 0.0, 0.2);
  m_last_s = now_s;
  m_wanted = std::clamp(std::clamp(m_wanted + way, *here - kLead, *here + kLead), 0.0, 1.0);
  const std::string name = m_camera.toStdString();
  sent(m_camera, zooming ? m_feed->setZoom(name, m_wanted) : m_feed->setFocus(name, m_wanted));
}

void ZoomDrive::release() {
  m_timer.stop();
  if (std::exchange(m_held, Held::kNothing) == Held::kZoom && zoom(m_camera)) warnOutside(m_camera, m_wanted);
}

}  // namespace longarm::session
