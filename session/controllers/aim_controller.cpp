#include "session/controllers/aim_controller.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/text.h"
#include "session/controllers/snapshot_maker.h"

namespace longarm::session {

namespace {

constexpr int kTickMs = 50;
/// Distance at which the clicked point is assumed to lie: the head's own lever arms matter little beyond it [m].
constexpr double kAimDistance = 3.0;
/// A key step adds to the last target rather than to the lagging joints for this long [s].
constexpr double kTargetLife = 1.0;

const planning::PanTiltSpec* findPanTilt(const planning::Workcell& workcell, const std::string& name) {
  for (const auto& spec : workcell.pan_tilts) {
    if (spec.name == name) return &spec;
  }
  return nullptr;
}

struct Axis {
  int q_index = -1;
  double lower = 0, upper = 0;
  std::string name;
};

Result<Axis> axisOf(const planning::RobotModel& model, const std::string& joint) {
  const auto index = model.jointIndex(joint);
  if (!index) return index.error();
  const planning::Joint& found = model.joints()[static_cast<std::size_t>(*index)];
  if (found.q_index < 0) return {ErrorCode::kInvalidInput, "Joint " + joint + " does not move: it cannot aim a camera."};
  return Axis{found.q_index, found.lower, found.upper, joint};
}

/// A camera on its pan-tilt: where it is and looks at any angles.
class AimedCamera {
 public:
  static Result<AimedCamera> make(const planning::Workcell& workcell, const planning::CameraSpec& camera,
                                  const JointState& now) {
    if (!workcell.model) return {ErrorCode::kNotFound, "The workcell has no robot."};
    const planning::PanTiltSpec* spec = findPanTilt(workcell, camera.pan_tilt);
    if (spec == nullptr) {
      return {ErrorCode::kNotFound, "No pan-tilt aims camera " + camera.name + ". Choose a camera of the head."};
    }
    auto pan = axisOf(*workcell.model, spec->pan_joint);
    if (!pan) return pan.error();
    auto tilt = axisOf(*workcell.model, spec->tilt_joint);
    if (!tilt) return tilt.error();
    const auto link = workcell.model->linkIndex(camera.link);
    if (!link) return link.error();
    AimedCamera aimed;
    aimed.m_model = workcell.model.get();
    aimed.m_pan = *pan;
    aimed.m_tilt = *tilt;
    aimed.m_link = *link;
    aimed.m_q = workcell.model->neutral();
    workcell.model->assign(now, aimed.m_q);
    return aimed;
  }

  PanTiltAngles now() const { return {m_q(m_pan.q_index), m_q(m_tilt.q_index)}; }
  Pose pose(const PanTiltAngles& angles) const {
    Eigen::VectorXd q = m_q;
    q(m_pan.q_index) = angles.pan;
    q(m_tilt.q_index) = angles.tilt;
    return m_model->forward(q, m_link);
  }
  PanTiltAngles clamped(const PanTiltAngles& wanted) const {
    return {std::clamp(wanted.pan, m_pan.lower, m_pan.upper), std::clamp(wanted.tilt, m_tilt.lower, m_tilt.upper)};
  }
  Status checkLimits(const PanTiltAngles& wanted) const {
    for (const auto& [axis, angle] : {std::pair(&m_pan, wanted.pan), std::pair(&m_tilt, wanted.tilt)}) {
      if (angle >= axis->lower && angle <= axis->upper) continue;
      constexpr double kDegrees = 57.29577951308232;
      return {ErrorCode::kOutOfLimits, axis->name + " would have to go to " + formatFixed(angle * kDegrees, 1) +
                                           " deg, its limits are " + formatFixed(axis->lower * kDegrees, 1) + " to " +
                                           formatFixed(axis->upper * kDegrees, 1) + " deg."};
    }
    return {};
  }

 private:
  const planning::RobotModel* m_model = nullptr;
  Axis m_pan, m_tilt;
  int m_link = -1;
  Eigen::VectorXd m_q;
};

/// Newton on the two picture coordinates of a fixed point of the world.
Result<PanTiltAngles> solveAim(const AimedCamera& camera, const Eigen::Vector3d& p_R, const Eigen::Vector2d& centre) {
  const auto error = [&](const PanTiltAngles& angles) -> Eigen::Vector2d {
    const Eigen::Vector3d p = camera.pose(angles).inverse() * p_R;
    // Angles rather than ratios: they grow evenly and never blow up.
    return {std::atan2(p.x(), p.z()) - std::atan(centre.x()),
            std::atan2(p.y(), std::hypot(p.x(), p.z())) - std::atan2(centre.y(), std::hypot(1.0, centre.x()))};
  };
  PanTiltAngles angles = camera.now();
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d e = error(angles);
    if (e.norm() < 1e-9) return angles;
    constexpr double h = 1e-6;
    Eigen::Matrix2d J;
    J.col(0) = (error({angles.pan + h, angles.tilt}) - e) / h;
    J.col(1) = (error({angles.pan, angles.tilt + h}) - e) / h;
    if (std::abs(J.determinant()) < 1e-6) break;
    Eigen::Vector2d step = -J.inverse() * e;
    if (step.norm() > 0.5) step *= 0.5 / step.norm();
    angles.pan += step.x();
    angles.tilt += step.y();
  }
  return {ErrorCode::kDegenerate, "The pan-tilt cannot turn that pixel to the middle: it looks along its own pan axis."};
}

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
  const auto angles = solveAim(*aimed, target, *centre);
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
  const Status moved = turnBy(m_right * m_max_rate * dt, m_up * m_max_rate * dt);
  if (!moved) {
    m_timer.stop();
    Q_EMIT failed(QString::fromStdString(moved.error().message));
  }
}

void AimController::step(double right, double up) {
  if (const QString reason = whyNot(); !reason.isEmpty()) {
    Q_EMIT failed(reason);
    return;
  }
  const Status moved = turnBy(right, up);
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
  if (m_feed == nullptr || !m_workcell) {
    Q_EMIT failed(whyNot());
    return;
  }
  const auto state = m_feed->jointState();
  const std::string name = camera.toStdString();
  const planning::CameraSpec* spec = m_workcell->camera(name);
  if (!state || spec == nullptr) {
    Q_EMIT failed(!state ? tr("The robot's joints are not known yet.")
                         : tr("The workcell has no camera \"%1\".").arg(camera));
    return;
  }
  const auto view = cameraView(*m_workcell, name, *state);
  if (!view) {
    Q_EMIT failed(QString::fromStdString(view.error().message));
    return;
  }
  PanTiltAngles reachable;
  const auto angles = anglesToCentre(*m_workcell, view->camera, name, pixel, *state, &reachable);
  if (!angles && angles.error().code != ErrorCode::kOutOfLimits) {
    Q_EMIT failed(QString::fromStdString(angles.error().message));
    return;
  }
  m_pan_tilt = spec->pan_tilt;
  const Status sent = send(angles ? *angles : reachable);
  if (!angles) Q_EMIT failed(QString::fromStdString(angles.error().message + " It goes as far as it can."));
  if (!sent) Q_EMIT failed(QString::fromStdString(sent.error().message));
}

Status AimController::send(const PanTiltAngles& wanted) {
  const Status sent = m_feed->movePanTilt(m_pan_tilt, wanted.pan, wanted.tilt);
  if (!sent) return sent;
  m_target = wanted;
  m_has_target = true;
  m_sent_s = m_feed->now_s();
  Q_EMIT aimed();
  return {};
}

}  // namespace longarm::session
