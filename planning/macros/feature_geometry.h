#pragma once

/// @file
/// Features as macros see them: in the robot's root frame, as axes, rectangles and boxes.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "core/result.h"
#include "planning/robot/robot_model.h"
#include "planning/world/shape.h"
#include "vision/sketch/feature.h"

namespace longarm::planning {

/// The pose of a feature's parent in the root frame: the root itself, "world", or any link at q.
/// @returns kInvalidInput when there is no such link.
Result<Pose> poseOfParent(const std::string& parent, const RobotModel& model, const Eigen::VectorXd& q);

/// Vertices of a feature in the root frame.
struct RootedFeature {
  std::string name;
  std::vector<Eigen::Vector3d> points;           ///< [m]
  std::vector<Eigen::Matrix3d> covariances;      ///< [m^2]

  /// Largest 95 % half-axis over all vertices [m]; 0 when none states a covariance.
  double uncertainty() const;
};
/// @returns kInvalidInput: another kind, wrong vertex count, unknown parent, not finite.
Result<RootedFeature> rooted(const vision::Feature& feature, vision::FeatureKind wanted, const RobotModel& model,
                             const Eigen::VectorXd& q);

/// A line with a sense: from vertex 0 to vertex 1.
struct AxisLine {
  Eigen::Vector3d first = Eigen::Vector3d::Zero(), second = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();      ///< Unit.
  double length = 0;
  Eigen::Vector3d middle() const { return 0.5 * (first + second); }
  Eigen::Vector3d nearest(const Eigen::Vector3d& p) const { return first + direction.dot(p - first) * direction; }
};
/// @returns kDegenerate: shorter than 10 mm.
Result<AxisLine> axisLineFrom(const RootedFeature& feature);

/// A rectangle on a surface.  u runs along the first edge, v is the second made square to it, the normal points to
/// `eye`; (u, v, normal) may be left-handed.
struct PlanePatch {
  Eigen::Vector3d corner = Eigen::Vector3d::Zero();
  Eigen::Vector3d u = Eigen::Vector3d::UnitX(), v = Eigen::Vector3d::UnitY(), normal = Eigen::Vector3d::UnitZ();
  double width = 0, height = 0;                  ///< Along u, along v [m].

  Eigen::Vector3d at(double along_u, double along_v) const { return corner + along_u * u + along_v * v; }
  Eigen::Vector3d center() const { return at(0.5 * width, 0.5 * height); }
  /// A slab of that size whose upper side lies `below` under the surface.
  WorldObject slab(const std::string& name, double thickness = 0.02, double below = 0.001) const;
};
/// @returns kDegenerate: an edge under 10 mm, or edges less than 10 degrees apart.
Result<PlanePatch> planePatchFrom(const RootedFeature& feature, const Eigen::Vector3d& eye);

/// A box: right-angled frame nearest to the triad's edges (orthogonal Procrustes), lengths along it.
struct BoxPatch {
  Pose X_RO = Pose::Identity();                  ///< Its centre; axes along the edges, right-handed.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< [m]

  /// Outward unit normal of face 0 ... 5: +x, -x, +y, -y, +z, -z.
  Eigen::Vector3d normal(int face) const;
  Eigen::Vector3d faceCenter(int face) const;
  PlanePatch face(int index) const;
  WorldObject object(const std::string& name) const;
};
/// @returns kDegenerate: an edge under 10 mm, or edges so far from square (determinant of the unit edges under 0.3).
Result<BoxPatch> boxPatchFrom(const RootedFeature& feature);

/// Tool orientation: z as given, x as near to `x_hint` as it can be.
Eigen::Matrix3d toolRotation(const Eigen::Vector3d& z, const Eigen::Vector3d& x_hint);
Pose poseAt(const Eigen::Vector3d& p, const Eigen::Matrix3d& R);

}  // namespace longarm::planning
