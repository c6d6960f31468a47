#pragma once

/// @file
/// Shapes shared by robots, workcells, scenarios, collision checking and drawing.

#include <array>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"

namespace longarm::planning {

struct Box { Eigen::Vector3d size{1, 1, 1}; };               ///< Full edge lengths [m], centred.
struct Cylinder { double radius = 0.5, length = 1; };        ///< Axis z, centred [m].
struct Sphere { double radius = 0.5; };

/// Triangles with scale applied.  Immutable and shared.
struct TriangleMesh {
  std::string source;                                        ///< Path it came from.
  std::vector<Eigen::Vector3d> vertices;                     ///< [m]
  std::vector<std::array<int, 3>> triangles;                 ///< Counter-clockwise from outside.
};

using Shape = std::variant<Box, Cylinder, Sphere, std::shared_ptr<const TriangleMesh>>;

/// What a body is to a motion of the arm.
enum class BodyRole {
  kSolid,                                ///< A thing: not run into, but the gripper may take it or touch it.
  kKeepOut,                              ///< A volume that the arm and what it holds never enter.
  kKeepIn,                               ///< A box that they never leave.
};

/// A body of the world: a workcell's fixed object, a sketched box, something held, a zone.
struct WorldObject {
  std::string name;
  Shape shape;
  Pose X_WO = Pose::Identity();          ///< In the robot's root frame; or in `attached_link` when that is set.
  std::string attached_link;             ///< Empty, or the link that carries it.
  Eigen::Vector4d rgba{0.5, 0.5, 0.55, 1};
  bool collides = true;                  ///< false: drawn only.
  BodyRole role = BodyRole::kSolid;

  /// Whether it is a thing that stands in the world: solid, in the way, and carried by nothing.
  bool standsInTheWay() const { return collides && role == BodyRole::kSolid && attached_link.empty(); }
};

}  // namespace longarm::planning
