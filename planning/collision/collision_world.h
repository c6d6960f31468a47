#pragma once

/// @file
/// Whether a robot configuration, or the whole straight joint motion between two, touches anything.

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "planning/robot/robot_model.h"
#include "planning/world/shape.h"
#include "planning/world/workcell.h"

namespace longarm::planning {

/// Pairs of link indices (first < second) that may touch.
using AllowedPairs = std::set<std::pair<int, int>>;

/// Two bodies that touch, or are nearest: names of links or world objects.
struct Contact {
  std::string first, second;
  double distance = 0;                   ///< [m]; 0 when they touch.
  BodyRole role = BodyRole::kSolid;      ///< Of the second; a zone always comes second.

  /// "link_a touches link_b", "link_a is 3.1 mm from link_b", "link_a is inside the keep-out zone b".
  std::string sentence() const;
};

struct CollisionOptions {
  double padding = 0.005;                ///< Robot against world: closer counts as collision [m].
  double self_padding = 0.001;           ///< Link against link [m].
  /// Entries of q that motions will change; empty: all.  Pairs that none of them moves are left out of
  /// inCollision() and segmentFree() and are seen only by touching().
  std::vector<int> moving;
};

/// The robot's collision shapes and the world's, with what may touch what.
///
/// Distances come from FCL 0.7 with libccd, unsigned only (signed distance hangs and aborts); a cheap bound from
/// capsules and boxes around every shape goes first.  "Distance <= 0, collide() says yes, an exception or not a
/// number" all count as collision.  Meshes are closed surfaces: a body wholly inside one is found by counting
/// crossings.  Thread-compatible: const methods share scratch memory, so one thread at a time.
class CollisionWorld {
 public:
  /// @param objects  Bodies; those with `collides == false` are skipped, those with an unknown `attached_link` are
  ///                 taken as fixed.  An attached body may touch the link that carries it and that link's neighbours.
  ///                 Zones concern only links that `options.moving` moves, and what hangs on them.
  CollisionWorld(std::shared_ptr<const RobotModel> model, const std::vector<WorldObject>& objects,
                 const AllowedPairs& allowed, const CollisionOptions& options = {});
  ~CollisionWorld();
  CollisionWorld(const CollisionWorld&) = delete;
  CollisionWorld& operator=(const CollisionWorld&) = delete;

  const RobotModel& model() const;
  /// Lets these links and objects touch the object of that name; nothing is let into a zone.
  void allow(const std::string& object, const std::vector<std::string>& others);
  /// Changes the paddings, e.g. when a motion must start closer than the usual.
  void setPadding(double padding, double self_padding);
  double padding() const;
  double selfPadding() const;

  /// Whether a moving pair is closer than its padding at q (full configuration).
  bool inCollision(const Eigen::VectorXd& q, Contact* contact = nullptr) const;
  /// Whether any pair, moving or not (zones: moving), touches at q; paddings do not count.
  bool touching(const Eigen::VectorXd& q, Contact* contact = nullptr) const;
  /// Whether the arm, or what it carries, is where a zone does not let it be; paddings do not count.
  bool inZone(const Eigen::VectorXd& q, Contact* contact = nullptr) const;
  /// Least distance of all moving pairs, at most `cap` [m]; 0 when touching.
  double clearance(const Eigen::VectorXd& q, Contact* nearest = nullptr, double cap = 1.0) const;
  /// Least distance over the robot-world pairs and over the link-link pairs separately, at most `cap`.
  std::pair<double, double> clearances(const Eigen::VectorXd& q, double cap = 1.0) const;

  /// Whether the straight motion from a to b is free, at every instant and not at samples.
  ///
  /// Schwarzer, Saha, Latombe, "Exact collision checking of robot paths", 2005: a pair whose distances at both ends sum
  /// to more than the longest way any of its points can move between them cannot have met; else halve.  Both
  /// ends and all halves keep the padding, everything between at least half of it; a pair that 0.1 mm of motion
  /// cannot decide counts as touching.
  bool segmentFree(const Eigen::VectorXd& a, const Eigen::VectorXd& b, Contact* contact = nullptr) const;

  /// How many states and FCL queries the calls so far have cost.
  struct Counters {
    long states = 0, queries = 0;
  };
  const Counters& counters() const;

  struct Impl;                           ///< Defined inside planning/collision only.

 private:
  std::unique_ptr<Impl> m_impl;
};

/// Pairs that may touch: the SRDF's where there is one, and always links that no joint moves against each other.
/// Without an SRDF also: a link and its nearest ancestor that has a shape; pairs that touch in at least 95 % of
/// `samples` random configurations (seeded) and so cannot be kept apart.  Pairs that never touched in the samples
/// stay checked: a few microseconds cost less than a pair that the samples happened to miss.
AllowedPairs allowedPairs(const std::shared_ptr<const RobotModel>& model, unsigned seed = 1, int samples = 300);

/// The same for a workcell's robot; the gripper's links may also touch one another, as fingers that are shut do.
AllowedPairs allowedPairs(const Workcell& workcell);

/// Indices in q of the group's joints.
std::vector<int> movingIndices(const RobotModel& model, const JointGroup& group);

}  // namespace longarm::planning
