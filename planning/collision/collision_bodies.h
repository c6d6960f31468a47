#pragma once

/// @file
/// The bodies and pairs behind CollisionWorld.  Private to planning/collision.

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planning/collision/bounds.h"
#include "planning/collision/collision_world.h"
#include "planning/collision/convex.h"
#include "planning/collision/fcl_shapes.h"
#include "planning/collision/near_kernel.h"
#include "planning/collision/reach.h"

namespace longarm::planning::internal {

/// One shape of a link or an object.
struct Body {
  std::string name;                      ///< Of the link or object.
  int link = -1;                         ///< -1: fixed in the root frame.
  bool object = false;
  BodyRole role = BodyRole::kSolid;
  Pose X_LS = Pose::Identity();
  bool turned = false;                   ///< X_LS does not only shift.
  FclGeometry geometry;
  std::optional<Convex> convex;          ///< Of all but meshes.
  ShapeBounds bounds;
  double ball = 0;                       ///< Radius about the middle of the bounds' box that holds it [m].
  std::shared_ptr<const TriangleMesh> mesh;      ///< Null for primitives.
};

struct Pair {
  int a = 0, b = 0;                      ///< Indices of bodies; b may be fixed.
  bool self = false;                     ///< Neither is a fixed object.
  bool allowed = false;
  bool moving = false;
  bool zone = false;                     ///< One of them is no thing.
  bool dear = false;                     ///< One of them is a mesh.
  mutable Eigen::Vector3d axis{1, 0, 0}; ///< They were last held apart along.
  MotionBound bound;
};

/// A ball and a box along the root's axes, both around a body.
struct Cover {
  Eigen::Vector3d center, half;
  double radius = 0;
};

/// How one link stands to its parent: R = A + sin(v) B + cos(v) C and p = p_0 + v d, v the joint's value.
struct LinkStep {
  int link = 0, parent = 0;
  int q_index = -1;                      ///< -1: v does not matter.
  double multiplier = 1, offset = 0;     ///< v = multiplier q + offset
  bool turns = false;
  Eigen::Matrix3d A, B, C;
  Eigen::Vector3d p_0, d;
};

/// The pairs that are looked at: a row for each body that moves, in it the pair with every other body.
struct LookedAt {
  std::vector<int> movers;
  std::vector<int> rows;                 ///< movers x padded bodies: index of the pair, -1: none, or in the other's row.
  std::vector<unsigned char> asked;      ///< Whether there is one.
  std::vector<int> pairs;                ///< All of them.
  std::vector<char> dear, self;          ///< As in the pair.
  Eigen::MatrixXd reach;                 ///< pairs x entries of q: the way that any point can go per unit [m].
};

/// Where everything is at one configuration.
struct PlacedState {
  Eigen::VectorXd q;                     ///< Of which; empty: not placed yet.
  std::vector<Pose> links;
  std::vector<Pose> poses;               ///< X_RS per body.
  std::vector<Cover> covers;
  Boxes boxes;                           ///< The covers' boxes.
  std::vector<PlacedBounds> bounds;      ///< Only where there are meshes, whose distances are dear.
};

}  // namespace longarm::planning::internal

namespace longarm::planning {

struct CollisionWorld::Impl {
  std::shared_ptr<const RobotModel> model;
  CollisionOptions options;
  std::vector<internal::Body> bodies;
  std::vector<internal::Pair> pairs;
  bool any_mesh = false;
  std::vector<internal::LinkStep> steps;           ///< Parents first.
  std::vector<char> link_moves;                    ///< Whether the moving joints move it.
  std::vector<int> still;                          ///< Entries of q that are not moving.
  mutable internal::LookedAt looked_at;
  mutable bool looked_at_valid = false;
  mutable std::vector<unsigned char> near;
  mutable Counters counters;
  mutable internal::PlacedState scratch, at_start, at_end;

  double padding(const internal::Pair& pair) const { return pair.self ? options.self_padding : options.padding; }
  bool active(const internal::Pair& pair) const { return pair.moving && !pair.allowed; }

  void addSteps();
  void addLinkBodies();
  void addObjects(const std::vector<WorldObject>& objects);
  void addObject(const WorldObject& object);
  void keep(internal::Body body);
  void addPairs(const AllowedPairs& allowed);
  bool carriedBy(const internal::Body& object, int link) const;

  const internal::LookedAt& lookedAt() const;
  void placeAll(const Eigen::VectorXd& q, internal::PlacedState& state) const;
  void placeBodies(bool moving, internal::PlacedState& state) const;
  /// By balls and boxes alone.
  static double coverBound(int a, int b, const internal::PlacedState& state) {
    const internal::Cover &one = state.covers[static_cast<std::size_t>(a)], &other = state.covers[static_cast<std::size_t>(b)];
    const Eigen::Vector3d apart = one.center - other.center;
    const double boxes = (apart.cwiseAbs() - one.half - other.half).maxCoeff();
    return std::max(boxes, apart.norm() - one.radius - other.radius);
  }
  /// A number that the distance is not below; may be negative.
  double bound(const internal::Pair& pair, const internal::PlacedState& state) const;
  /// At most `cap`; of primitives by convex.h, of meshes by FCL.
  double distance(const internal::Pair& pair, const internal::PlacedState& state, double cap) const;
  /// Not more than the distance; exact where that is at most the padding.
  double clearance(const internal::Pair& pair, const internal::PlacedState& state, double cap) const;
  bool anyTouches(const Eigen::VectorXd& q, bool zones_only, Contact* contact) const;
  bool within(const internal::Pair& pair, const internal::PlacedState& state, double limit) const;
  double leastDistance(const internal::PlacedState& state, bool self, bool world, double cap, Contact* nearest) const;
  void report(const internal::Pair& pair, double d, Contact* contact) const;
  bool pieceFree(const Eigen::VectorXd& a, const Eigen::VectorXd& b, Contact* contact) const;
};

}  // namespace longarm::planning
