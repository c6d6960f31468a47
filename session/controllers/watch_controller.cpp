#include "session/controllers/watch_controller.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "session/controllers/framing.h"
#include "session/controllers/snapshot_maker.h"

namespace longarm::session {
namespace {

constexpr double kPeriod_s = 0.1;
constexpr double kTurnRate = 0.8;        // [rad/s]
constexpr double kZoomIn = 0.15, kZoomOut = 0.4;         // of the whole travel per second: out in time, in at leisure
constexpr double kAhead_s = 0.6;         // of the tool's motion that is looked at
constexpr double kLeftAlone_s = 5;       // after the operator's own hand
constexpr double kFill = 0.6;            // What is watched shall take up so much of the picture,
constexpr double kTooWide = 0.75;        // ... no more than this,
constexpr double kTooSmall = 0.25;       // ... and no less, where there is a zoom.
constexpr double kThere = 0.005;         // [rad], and of the zoom's travel
constexpr double kLeast = 1e-4;          // A smaller change is none.
constexpr double kFresh_s = 0.5;         // A command older than this is forgotten: the joints say where the head is.
constexpr double kCreeps = 0.01;         // A slower tool is where it is [m/s].
constexpr double kHand_m = 0.12;         // of the tool that is watched, from its point

double towards(double from, double to, double most) { return from + std::clamp(to - from, -most, most); }

}  // namespace

WatchController::WatchController(QObject* parent) : QObject(parent) {}

void WatchController::setWorkcell(std::shared_ptr<const planning::Workcell> workcell) {
  m_workcell = std::move(workcell);
  m_heads.clear();
}

void WatchController::setOn(bool on) {
  if (m_on == on) return;
  m_on = on;
  for (auto& [name, head] : m_heads) head.following = false;
  Q_EMIT changed();
}

void WatchController::giveWay(const QString& pan_tilt) {
  if (m_feed == nullptr || pan_tilt.isEmpty()) return;
  Head& head = m_heads[pan_tilt.toStdString()];
  head.left_alone_until_s = m_feed->now_s() + kLeftAlone_s;
  head.following = false;
}

void WatchController::refresh(bool moving, bool stopped) {
  if (m_feed == nullptr || !m_workcell || !m_workcell->model) return;
  if (!m_on || !moving || stopped) {
    for (auto& [name, head] : m_heads) head.following = false;
    return;
  }
  const double now_s = m_feed->now_s();
  if (now_s - m_last_s < kPeriod_s - 1e-6) return;
  m_last_s = now_s;
  std::set<std::string> done;              // the first camera of each head speaks for it
  for (const auto& camera : m_workcell->cameras) {
    if (camera.pan_tilt.empty() || !done.insert(camera.pan_tilt).second) continue;
    Head& head = m_heads[camera.pan_tilt];
    if (now_s >= head.left_alone_until_s) watch(camera, head, now_s);
  }
}

std::vector<Eigen::Vector3d> WatchController::toolPoints(const JointState& joints) const {
  const auto& model = *m_workcell->model;
  const auto tip = model.linkIndex(m_workcell->arm.tip_link);
  if (!tip) return {};
  Eigen::VectorXd q = model.neutral();
  model.assign(joints, q);
  const Pose X_WT = model.forward(q, *tip);
  std::vector<Eigen::Vector3d> out = {X_WT.translation(), X_WT * Eigen::Vector3d(0, 0, -kHand_m)};
  const auto before = m_feed->jointStateAt(joints.stamp_s - kPeriod_s);
  if (!before) return out;
  model.assign(*before, q);
  const Eigen::Vector3d speed = (X_WT.translation() - model.forward(q, *tip).translation()) / kPeriod_s;
  if (speed.norm() > kCreeps) out.push_back(X_WT.translation() + kAhead_s * speed);
  return out;
}

void WatchController::watch(const planning::CameraSpec& camera, Head& head, double now_s) {
  const auto joints = m_feed->jointState();
  const auto zoom = m_feed->zoomAt(camera.name, now_s);
  if (!joints || !zoom) return;
  const auto view = cameraView(*m_workcell, camera.name, *joints, *zoom);
  const std::vector<Eigen::Vector3d> tool = toolPoints(*joints);
  if (!view || tool.empty()) return;
  std::vector<Eigen::Vector3d> both = tool;
  both.insert(both.end(), m_target.begin(), m_target.end());
  const auto framed = [&](const std::vector<Eigen::Vector3d>& points, bool may_zoom) {
    return frame(*m_workcell, camera, points, *joints, *zoom, {kFill, may_zoom});
  };
  auto goal = framed(both, true);
  if (!goal || !goal->shortfall.empty()) goal = framed(tool, true);
  // The lens is slower than the head: what does not fit yet is not looked at yet.
  auto now = framed(both, false);
  if (!now || !now->shortfall.empty()) now = framed(tool, false);
  if (!goal || !now) return;
  const double part = spread(*view, both);
  const bool far = goal->zoom && part < kTooSmall && *goal->zoom > **zoom + kThere;
  if (part > kTooWide || far) head.following = true;
  if (head.following) turn(camera, head, now->angles, goal->zoom, now_s);
}

void WatchController::turn(const planning::CameraSpec& camera, Head& head, const PanTiltAngles& wanted,
                           std::optional<double> zoom, double now_s) {
  if (now_s - head.commanded_s > kFresh_s) {
    const auto joints = m_feed->jointState();
    const auto aimed = AimedCamera::make(*m_workcell, camera, *joints);
    const auto here = m_feed->zoomAt(camera.name, now_s);
    if (!aimed || !here) return;
    head.angles = aimed->now();
    head.zoom = here->value_or(0);
    head.commanded_s = now_s - kPeriod_s;
  }
  const double dt = std::min(now_s - head.commanded_s, 2 * kPeriod_s);
  const PanTiltAngles before = head.angles;
  const PanTiltAngles next{towards(head.angles.pan, wanted.pan, kTurnRate * dt),
                           towards(head.angles.tilt, wanted.tilt, kTurnRate * dt)};
  const bool turns = std::abs(next.pan - before.pan) > kLeast || std::abs(next.tilt - before.tilt) > kLeast;
  if (turns && !m_feed->movePanTilt(camera.pan_tilt, next.pan, next.tilt)) return;
  head.angles = next;
  head.commanded_s = now_s;
  if (zoom && std::abs(*zoom - head.zoom) > kLeast) {
    const double setting = towards(head.zoom, *zoom, (*zoom > head.zoom ? kZoomIn : kZoomOut) * dt);
    if (m_feed->setZoom(camera.name, setting)) head.zoom = setting;
  }
  const bool there = std::abs(next.pan - wanted.pan) < kThere && std::abs(next.tilt - wanted.tilt) < kThere &&
                     (!zoom || std::abs(head.zoom - *zoom) < kThere);
  if (there) head.following = false;
}

}  // namespace longarm::session
