#pragma once

/// @file
/// Cheap bounds around shapes: a capsule and a box each, and how far apart two bodies are at least.

#include <array>

#include <Eigen/Core>

#include "core/pose.h"
#include "planning/world/shape.h"

namespace longarm::planning {

/// Capsule and box that both contain a shape, in the shape's frame.
struct ShapeBounds {
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = Eigen::Vector3d::Zero();   ///< Ends of the capsule's axis.
  double radius = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();                           ///< Of the box, axes as the shape's.
  Eigen::Vector3d half = Eigen::Vector3d::Zero();
};

ShapeBounds boundsOf(const Shape& shape);

/// The same in the root frame.
struct PlacedBounds {
  Eigen::Vector3d a, b;
  double radius = 0;
  Eigen::Vector3d center, half;
  Eigen::Matrix3d R;                     ///< Box axes as columns.
};

PlacedBounds place(const ShapeBounds& bounds, const Pose& X);

/// Squared distance of two line segments (Ericson, "Real-Time Collision Detection", 2005, 5.1.9).
double squaredDistance(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& b0,
                       const Eigen::Vector3d& b1);

/// A number that the distance of the two bodies is not below; may be negative.
double distanceBound(const PlacedBounds& first, const PlacedBounds& second);

/// Whether p lies inside a closed mesh, by counting crossings of a slanted ray.
bool insideMesh(const TriangleMesh& mesh, const Eigen::Vector3d& p);

}  // namespace longarm::planning
