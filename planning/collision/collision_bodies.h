#pragma once

/// @file
/// The bodies and pairs behind CollisionWorld.  Private to planning/collision.

#include <memory>
#include <string>
#include <vector>

#include "planning/collision/bounds.h"
#include "planning/collision/collision_world.h"
#include "planning/collision/fcl_shapes.h"
#include "planning/collision/reach.h"

namespace longarm::planning::internal {

/// One shape of a link or an object.
struct Body {
  std::string name;                      ///< Of the link or object.
  int link = -1;                         ///< -1: fixed in the root frame.
  bool object = false;
  BodyRole role = BodyRole::kSolid;
  Pose X_LS = Pose::Identity();
  FclGeometry geometry;
  ShapeBounds bounds;
  std::shared_ptr<const TriangleMesh> mesh;      ///< Null for primitives.
};

struct Pair {
  int a = 0, b = 0;                      ///< Indices of bodies; b may be fixed.
  bool self = false;                     ///< Neither is a fixed object.
  bool allowed = false;
  bool moving = false;
  bool zone = false;                     ///< One of them is no thing.
  MotionBound bound;
};

/// Where everything is at one configuration.
struct PlacedState {
  std::vector<Pose> links;
  std::vector<Pose> poses;               ///< X_RS per body.
  std::vector<PlacedBounds> bounds;
};

}  // namespace longarm::planning::internal

namespace longarm::planning {

struct CollisionWorld::Impl {
  std::shared_ptr<const RobotModel> model;
  CollisionOptions options;
  std::vector<internal::Body> bodies;
  std::vector<internal::Pair> pairs;
  mutable Counters counters;
  mutable internal::PlacedState scratch;

  double padding(const internal::Pair& pair) const { return pair.self ? options.self_padding : options.padding; }
  bool active(const internal::Pair& pair) const { return pair.moving && !pair.allowed; }

  void addLinkBodies();
  void addObjects(const std::vector<WorldObject>& objects);
  void addObject(const WorldObject& object);
  void addPairs(const AllowedPairs& allowed);
  bool carriedBy(const internal::Body& object, int link) const;

  void placeAll(const Eigen::VectorXd& q, internal::PlacedState& state) const;
  double bound(const internal::Pair& pair, const internal::PlacedState& state) const;
  /// Distance by FCL; at most `cap`.
  double distance(const internal::Pair& pair, const internal::PlacedState& state, double cap) const;
  bool anyTouches(const Eigen::VectorXd& q, bool zones_only, Contact* contact) const;
  double leastDistance(const internal::PlacedState& state, bool self, bool world, double cap, Contact* nearest) const;
  void report(const internal::Pair& pair, double d, Contact* contact) const;
  bool segmentFree(const Eigen::VectorXd& a, const Eigen::VectorXd& b, Contact* contact) const;
};

}  // namespace longarm::planning
