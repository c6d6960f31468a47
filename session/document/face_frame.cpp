#include "session/document/face_frame.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace longarm::session {

using Eigen::Vector3d;

namespace {

constexpr double kSteep = 0.7;           // A line or normal steeper than this counts as upright.

Vector3d middleOf(const vision::Feature& feature) {
  Vector3d sum = Vector3d::Zero();
  for (const auto& vertex : feature.vertices) sum += vertex.xyz;
  return sum / static_cast<double>(feature.vertices.size());
}

// Level, from there to the robot's own axis.
Vector3d toRobot(const Vector3d& from) {
  const Vector3d level(-from.x(), -from.y(), 0);
  return level.norm() > 1e-6 ? Vector3d(level.normalized()) : Vector3d(-Vector3d::UnitX());
}

Pose poseOf(const Vector3d& origin, const Vector3d& y, const Vector3d& z) {
  Pose out = Pose::Identity();
  out.linear() << y.cross(z), y, z;
  out.translation() = origin;
  return out;
}

Vector3d squareTo(const Vector3d& v, const Vector3d& unit) { return (v - v.dot(unit) * unit).normalized(); }

// What counts as up on a face: up, or on a level one away from the robot.
Vector3d upOn(const Vector3d& normal, const Vector3d& at) {
  return std::abs(normal.z()) > kSteep ? Vector3d(-toRobot(at)) : Vector3d::UnitZ();
}

FaceFrame ofPoint(const vision::Feature& feature) {
  const Vector3d p = middleOf(feature);
  return {poseOf(p, Vector3d::UnitZ(), toRobot(p)), {}};
}

FaceFrame ofLine(const vision::Feature& feature) {
  const Vector3d p = middleOf(feature);
  Vector3d along = feature.direction();
  FaceFrame out;
  if (std::abs(along.z()) > kSteep) {
    if (along.z() < 0) along = -along;
    out.X_WT = poseOf(p, along, squareTo(toRobot(p), along));
    out.extent[1] = feature.length();
    return out;
  }
  // To the robot's eyes' right.
  if (along.dot(Vector3d::UnitZ().cross(toRobot(p))) < 0) along = -along;
  const bool away = std::abs(along.dot(toRobot(p))) > kSteep;
  const Vector3d z = squareTo(away ? Vector3d::UnitZ() : toRobot(p), along);
  out.X_WT = poseOf(p, z.cross(along), z);
  out.extent[0] = feature.length();
  return out;
}

Result<FaceFrame> ofPlane(const vision::Feature& feature) {
  if (!feature.plane) return Error{ErrorCode::kInvalidInput, "'" + feature.name + "' has no measured face."};
  const auto& plane = *feature.plane;
  const Vector3d z = plane.normal, up = upOn(z, plane.center);
  const Vector3d first = squareTo(plane.corners[0] - plane.corners[1], z), second = z.cross(first);
  Vector3d y = std::abs(first.dot(up)) > std::abs(second.dot(up)) ? first : second;
  if (y.dot(up) < 0) y = -y;
  FaceFrame out;
  out.X_WT = poseOf(plane.center, y, z);
  Vector3d low = Vector3d::Constant(1e9), high = -low;
  for (const auto& corner : plane.corners) {
    const Vector3d p = out.X_WT.inverse() * corner;
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  out.X_WT.translation() = out.X_WT * Vector3d((low.x() + high.x()) / 2, (low.y() + high.y()) / 2, 0);
  out.extent[0] = high.x() - low.x();
  out.extent[1] = high.y() - low.y();
  return out;
}

Result<FaceFrame> ofBox(const vision::Feature& feature) {
  if (!feature.box || !feature.box->is_box) {
    return Error{ErrorCode::kInvalidInput, "'" + feature.name + "' has no right angles: mark the corner of a box, or its face as a plane."};
  }
  const Pose& X_WB = feature.box->X_WB;
  const Vector3d look = toRobot(X_WB.translation());
  int front = 0, rise = -1;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(X_WB.linear().col(i).dot(look)) > std::abs(X_WB.linear().col(front).dot(look))) front = i;
  }
  for (int i = 0; i < 3; ++i) {
    if (i == front) continue;
    if (rise < 0 || std::abs(X_WB.linear().col(i).z()) > std::abs(X_WB.linear().col(rise).z())) rise = i;
  }
  const Vector3d axis = X_WB.linear().col(front), upward = X_WB.linear().col(rise);
  const Vector3d z = axis.dot(look) < 0 ? Vector3d(-axis) : axis, y = upward.z() < 0 ? Vector3d(-upward) : upward;
  const Vector3d& size = feature.box->size;
  return FaceFrame{poseOf(X_WB.translation() + z * size(front) / 2, y, z), {size(3 - front - rise), size(rise), size(front)}};
}

}  // namespace

Result<FaceFrame> faceFrameOf(const vision::Feature& feature) {
  switch (feature.kind) {
    case vision::FeatureKind::kPoint: return ofPoint(feature);
    case vision::FeatureKind::kLine: return ofLine(feature);
    case vision::FeatureKind::kPlane: return ofPlane(feature);
    case vision::FeatureKind::kTriad: return ofBox(feature);
  }
  return Error{ErrorCode::kInternal, "a feature of no kind"};
}

}  // namespace longarm::session
