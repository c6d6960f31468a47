#pragma once

/// @file
/// FingerZone: what lies between the fingers of a parallel gripper.

#include <optional>

#include <Eigen/Core>

#include "core/pose.h"
#include "core/result.h"
#include "planning/world/shape.h"
#include "planning/world/workcell.h"

namespace longarm::virtual_robot {

/// How an object lies between the fingers, along the closing axis from the middle [m].
struct Pinch {
  double low = 0, high = 0;              ///< Extent of the part that the pads can touch.
  double depth = 0;                      ///< Of that part along the fingers.

  double width() const { return high - low; }
};

/// The closing region: the box swept by the pads of a symmetric two-finger gripper, read off the collision shapes of
/// the finger that the gripper joint drives.  Immutable; thread-safe.
class FingerZone {
 public:
  /// @pre the workcell has a gripper  @returns kInvalidInput when its joint drives no finger with a collision shape.
  static Result<FingerZone> of(const planning::Workcell& workcell);

  /// Pose of the zone in the tool frame T: y along the closing axis, z along the fingers.
  const Pose& X_TZ() const { return m_X_TZ; }
  /// Distance of each pad from the middle at a position of the gripper joint.
  double pad(double joint) const { return m_pad_at_zero + joint; }
  /// Joint position at which the pads are that far from the middle.
  double jointAt(double pad_distance) const { return pad_distance - m_pad_at_zero; }

  /// The part of the object's surface that is inside the region, whatever the opening.  Accurate to about 20 um for
  /// cylinders and boxes that are square to the fingers.
  /// @param X_TO  object in the tool frame
  /// @returns nothing when no part of it is.
  std::optional<Pinch> pinch(const planning::Shape& shape, const Pose& X_TO) const;

 private:
  FingerZone() = default;
  Pose m_X_TZ = Pose::Identity();
  double m_pad_at_zero = 0;
  double m_half_width = 0;                         // of the fingers, along x
  double m_from = 0, m_to = 0;                     // of the fingers, along z
};

}  // namespace longarm::virtual_robot
