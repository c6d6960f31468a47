#include "app/virtual_robot/gripper.h"

#include <algorithm>
#include <cmath>

namespace longarm::virtual_robot {
namespace {

constexpr double kAcceleration = 1.0;    // of the fingers [m/s^2]
constexpr double kLeastDepth = 0.006;    // less than this between the pads slips out [m]
constexpr double kOpensBy = 0.0005;      // a command this much wider lets go [m]
constexpr double kEntry = 0.001;         // tolerance of "between the fingers" [m]
constexpr double kSlipSpeed = 0.02;      // [m/s]

JointServo servoOf(const planning::Workcell& workcell) {
  const auto& model = *workcell.model;
  const auto index = model.jointIndex(workcell.gripper->joint);
  const auto& joint = model.joints()[static_cast<std::size_t>(*index)];
  return {workcell.gripper->open, joint.lower, joint.upper, joint.max_velocity, kAcceleration};
}

}  // namespace

Gripper::Gripper(const planning::Workcell& workcell, const FingerZone& zone)
    : m_zone(zone), m_servo(servoOf(workcell)) {}

void Gripper::step(double seconds, const Pose& X_WT, bool slipping, TrueWorld& world) {
  if (m_grip) {
    keep(seconds, X_WT, slipping, world);
    return;
  }
  const double before = m_servo.position();
  m_servo.step(seconds);
  if (m_servo.position() < before) close(before, X_WT, world);
}

void Gripper::close(double before, const Pose& X_WT, TrueWorld& world) {
  for (std::size_t i = 0; i < world.objects().size(); ++i) {
    if (world.objects()[i].graspable && meet(i, before, X_WT, world)) return;
  }
}

// Whether both fingers have met the object.
bool Gripper::meet(std::size_t index, double before, const Pose& X_WT, TrueWorld& world) {
  const auto& body = world.objects()[index].body;
  const auto pinch = m_zone.pinch(body.shape, X_WT.inverse() * body.X_WO);
  if (!pinch || pinch->depth < kLeastDepth) return false;
  const double was = m_zone.pad(before) + kEntry;
  if (pinch->high > was || pinch->low < -was) return false;   // a finger is on or in it, not beside it
  const double pad = m_zone.pad(m_servo.position());
  const bool gripped = pinch->width() >= 2 * pad;
  const double reach = gripped ? pinch->width() / 2 : pad;
  const double push = std::min(0.0, reach - pinch->high) + std::max(0.0, -reach - pinch->low);
  if (push != 0) {
    Pose X_WO = body.X_WO;
    X_WO.translation() += push * (X_WT.linear() * m_zone.X_TZ().linear().col(1));
    world.place(index, X_WO);
  }
  if (!gripped) return false;
  const double target = m_servo.target();
  m_grip = m_zone.jointAt(reach);
  m_servo.holdAt(*m_grip);
  m_servo.moveTo(target);
  world.hold(index, X_WT.inverse() * world.objects()[index].body.X_WO);
  return true;
}

void Gripper::keep(double seconds, const Pose& X_WT, bool slipping, TrueWorld& world) {
  bool lost = !world.carry(X_WT) || m_servo.target() > *m_grip + kOpensBy;
  if (slipping && !world.heldFreely()) lost = true;          // a handle is out of the fingers at once
  if (!lost && slipping) {
    Pose X_WO = world.objects()[*world.held()].body.X_WO;
    X_WO.translation().z() -= kSlipSpeed * seconds;
    world.hold(*world.held(), X_WT.inverse() * X_WO);
    world.carry(X_WT);
    const auto pinch = m_zone.pinch(world.objects()[*world.held()].body.shape, world.heldInTool());
    lost = !pinch || pinch->depth < kLeastDepth;
  }
  if (!lost) return;
  world.release();
  m_grip.reset();
}

}  // namespace longarm::virtual_robot
