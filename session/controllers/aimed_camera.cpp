#include "session/controllers/aimed_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "core/text.h"

namespace longarm::session {
namespace {

const planning::PanTiltSpec* findPanTilt(const planning::Workcell& workcell, const std::string& name) {
  for (const auto& spec : workcell.pan_tilts) {
    if (spec.name == name) return &spec;
  }
  return nullptr;
}

}  // namespace

Result<AimedCamera::Axis> AimedCamera::axisOf(const planning::RobotModel& model, const std::string& joint) {
  const auto index = model.jointIndex(joint);
  if (!index) return index.error();
  const planning::Joint& found = model.joints()[static_cast<std::size_t>(*index)];
  if (found.q_index < 0) return {ErrorCode::kInvalidInput, "Joint " + joint + " does not move: it cannot aim a camera."};
  return Axis{found.q_index, found.lower, found.upper, joint};
}

Result<AimedCamera> AimedCamera::make(const planning::Workcell& workcell, const planning::CameraSpec& camera,
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

Pose AimedCamera::pose(const PanTiltAngles& angles) const {
  Eigen::VectorXd q = m_q;
  q(m_pan.q_index) = angles.pan;
  q(m_tilt.q_index) = angles.tilt;
  return m_model->forward(q, m_link);
}

PanTiltAngles AimedCamera::clamped(const PanTiltAngles& wanted) const {
  return {std::clamp(wanted.pan, m_pan.lower, m_pan.upper), std::clamp(wanted.tilt, m_tilt.lower, m_tilt.upper)};
}

Status AimedCamera::checkLimits(const PanTiltAngles& wanted) const {
  for (const auto& [axis, angle] : {std::pair(&m_pan, wanted.pan), std::pair(&m_tilt, wanted.tilt)}) {
    if (angle >= axis->lower && angle <= axis->upper) continue;
    constexpr double kDegrees = 57.29577951308232;
    return {ErrorCode::kOutOfLimits, axis->name + " would have to go to " + formatFixed(angle * kDegrees, 1) +
                                         " deg, its limits are " + formatFixed(axis->lower * kDegrees, 1) + " to " +
                                         formatFixed(axis->upper * kDegrees, 1) + " deg."};
  }
  return {};
}

Eigen::Vector2d AimedCamera::off(const PanTiltAngles& angles, const Eigen::Vector3d& p_W, const Eigen::Vector2d& centre) const {
  const Eigen::Vector3d p = pose(angles).inverse() * p_W;
  // Angles rather than ratios: they grow evenly and never blow up.
  return {std::atan2(p.x(), p.z()) - std::atan(centre.x()),
          std::atan2(p.y(), std::hypot(p.x(), p.z())) - std::atan2(centre.y(), std::hypot(1.0, centre.x()))};
}

std::optional<PanTiltAngles> AimedCamera::solve(PanTiltAngles angles, const Eigen::Vector3d& p_W, const Eigen::Vector2d& centre) const {
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d e = off(angles, p_W, centre);
    if (e.norm() < 1e-9) return angles;
    constexpr double h = 1e-6;
    Eigen::Matrix2d J;
    J.col(0) = (off({angles.pan + h, angles.tilt}, p_W, centre) - e) / h;
    J.col(1) = (off({angles.pan, angles.tilt + h}, p_W, centre) - e) / h;
    if (std::abs(J.determinant()) < 1e-6) break;
    Eigen::Vector2d step = -J.inverse() * e;
    if (step.norm() > 0.5) step *= 0.5 / step.norm();
    angles.pan += step.x();
    angles.tilt += step.y();
  }
  return std::nullopt;
}

// From where it looks now; where that leads nowhere or past a limit, from the best of a grid over the limits.
Result<PanTiltAngles> AimedCamera::lookingAt(const Eigen::Vector3d& p_W, const Eigen::Vector2d& centre) const {
  const auto near = solve(now(), p_W, centre);
  if (near && checkLimits(*near)) return *near;
  constexpr int kGrid = 8;
  const auto at = [](const Axis& axis, int i) {
    const double low = std::max(axis.lower, -M_PI), high = std::min(axis.upper, M_PI);
    return low + (high - low) * (i + kGrid) / (2 * kGrid);
  };
  PanTiltAngles best = now();
  double least = std::numeric_limits<double>::infinity();
  for (int i = -kGrid; i <= kGrid; ++i) {
    for (int k = -kGrid; k <= kGrid; ++k) {
      const PanTiltAngles angles{at(m_pan, i), at(m_tilt, k)};
      const double here = off(angles, p_W, centre).norm();
      if (here < least) best = angles, least = here;
    }
  }
  const auto found = solve(best, p_W, centre);
  if (found && (checkLimits(*found) || !near)) return *found;
  if (near) return *near;
  return {ErrorCode::kDegenerate, "The pan-tilt cannot turn that place to the middle: it lies along its own pan axis."};
}

}  // namespace longarm::session
