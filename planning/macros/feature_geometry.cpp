#include "planning/macros/feature_geometry.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "core/text.h"
#include "planning/macros/accuracy.h"

namespace longarm::planning {
namespace {

constexpr double kShortest = 0.01;       // [m]
constexpr double kLongest = 20;

Status checkEdge(double length, const std::string& what) {
  if (length >= kShortest && length <= kLongest) return {};
  return {ErrorCode::kDegenerate, what + " is " + formatFixed(length * 1000, 1) + " mm long; 10 mm to 20 m is needed: mark it again"};
}

}  // namespace

Result<Pose> poseOfParent(const std::string& parent, const RobotModel& model, const Eigen::VectorXd& q) {
  const std::string& root = model.links()[static_cast<std::size_t>(model.rootLink())].name;
  if (parent.empty() || parent == root || parent == "world") return Pose::Identity();
  const auto link = model.linkIndex(parent);
  if (link) return model.forward(q, *link);
  return Error{ErrorCode::kInvalidInput, "the feature is given in \"" + parent + "\", which is no link of " +
                                             model.name() + "; give it in \"" + root + "\""};
}

double RootedFeature::uncertainty() const { return uncertaintyOf(covariances); }

Result<RootedFeature> rooted(const vision::Feature& feature, vision::FeatureKind wanted, const RobotModel& model,
                             const Eigen::VectorXd& q) {
  const auto count = static_cast<std::size_t>(vision::vertexCount(wanted));
  if (feature.kind != wanted || feature.vertices.size() != count) {
    return Error{ErrorCode::kInvalidInput, std::string("it takes a ") + vision::toString(wanted) + " of " + std::to_string(count) +
                                               (count == 1 ? " vertex" : " vertices") + "; the feature is a " +
                                               vision::toString(feature.kind) + " of " + std::to_string(feature.vertices.size())};
  }
  const auto X = poseOfParent(feature.parent, model, q);
  if (!X) return X.error();
  RootedFeature out;
  out.name = feature.name.empty() ? vision::toString(wanted) : feature.name;
  for (const auto& vertex : feature.vertices) {
    if (!vertex.xyz.allFinite() || !vertex.covariance.allFinite()) {
      return Error{ErrorCode::kInvalidInput, "the feature holds a number that is not finite"};
    }
    out.points.push_back(*X * vertex.xyz);
    out.covariances.push_back(X->linear() * vertex.covariance * X->linear().transpose());
  }
  return out;
}

Result<AxisLine> axisLineFrom(const RootedFeature& feature) {
  AxisLine line;
  line.first = feature.points[0];
  line.second = feature.points[1];
  line.length = (line.second - line.first).norm();
  if (const Status good = checkEdge(line.length, "the line"); !good) return good.error();
  line.direction = (line.second - line.first) / line.length;
  return line;
}

WorldObject PlanePatch::slab(const std::string& name, double thickness, double below) const {
  WorldObject out;
  out.name = name;
  out.shape = Box{{width, height, thickness}};
  out.X_WO.linear() << u, normal.cross(u), normal;
  out.X_WO.translation() = center() - (below + 0.5 * thickness) * normal;
  return out;
}

Result<PlanePatch> planePatchFrom(const RootedFeature& feature, const Eigen::Vector3d& eye) {
  const Eigen::Vector3d e1 = feature.points[0] - feature.points[1], e2 = feature.points[2] - feature.points[1];
  for (const auto* edge : {&e1, &e2}) {
    if (const Status good = checkEdge(edge->norm(), "an edge of the plane"); !good) return good.error();
  }
  const double sine = e1.cross(e2).norm() / (e1.norm() * e2.norm());
  if (sine < 0.17) {
    return Error{ErrorCode::kDegenerate, "the two edges of the plane are " + formatFixed(std::asin(sine) * 180 / M_PI, 1) +
                                             " deg apart; 10 deg at least are needed: mark corners that span it"};
  }
  PlanePatch patch;
  patch.corner = feature.points[1];
  patch.u = e1.normalized();
  const Eigen::Vector3d square = e2 - e2.dot(patch.u) * patch.u;
  patch.v = square.normalized();
  patch.width = e1.norm();
  patch.height = square.norm();
  patch.normal = patch.u.cross(patch.v);
  if (patch.normal.dot(eye - patch.center()) < 0) patch.normal = -patch.normal;
  return patch;
}

Eigen::Vector3d BoxPatch::normal(int face) const { return (face % 2 ? -1 : 1) * X_RO.linear().col(face / 2); }
Eigen::Vector3d BoxPatch::faceCenter(int face) const { return X_RO.translation() + 0.5 * size[face / 2] * normal(face); }

PlanePatch BoxPatch::face(int index) const {
  const int a = (index / 2 + 1) % 3, b = (index / 2 + 2) % 3;
  PlanePatch patch;
  patch.u = X_RO.linear().col(a);
  patch.v = X_RO.linear().col(b);
  patch.normal = normal(index);
  patch.width = size[a];
  patch.height = size[b];
  patch.corner = faceCenter(index) - 0.5 * (patch.width * patch.u + patch.height * patch.v);
  return patch;
}

WorldObject BoxPatch::object(const std::string& name) const {
  WorldObject out;
  out.name = name;
  out.shape = Box{size};
  out.X_WO = X_RO;
  return out;
}

Result<BoxPatch> boxPatchFrom(const RootedFeature& feature) {
  Eigen::Matrix3d edges, unit;
  for (int i = 0; i < 3; ++i) {
    edges.col(i) = feature.points[static_cast<std::size_t>(i) + 1] - feature.points[0];
    if (const Status good = checkEdge(edges.col(i).norm(), "an edge of the triad"); !good) return good.error();
    unit.col(i) = edges.col(i).normalized();
  }
  if (unit.determinant() < 0) {          // picked left-handed: swap two, never reflect
    unit.col(1).swap(unit.col(2));
    edges.col(1).swap(edges.col(2));
  }
  if (unit.determinant() < 0.3) {
    return Error{ErrorCode::kDegenerate, "the triad's edges are far from square (determinant " +
                                             formatFixed(unit.determinant(), 2) + ", 0.3 is needed): mark a corner of a box and its three edges"};
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(unit, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  BoxPatch box;
  box.X_RO.linear() = svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
  for (int i = 0; i < 3; ++i) box.size[i] = box.X_RO.linear().col(i).dot(edges.col(i));
  box.X_RO.translation() = feature.points[0] + 0.5 * box.X_RO.linear() * box.size;
  return box;
}

Eigen::Matrix3d toolRotation(const Eigen::Vector3d& z, const Eigen::Vector3d& x_hint) {
  const Eigen::Vector3d unit = z.normalized();
  const Eigen::Vector3d across = x_hint - x_hint.dot(unit) * unit;
  if (across.norm() < 1e-3) return rotationWithZ(unit);
  Eigen::Matrix3d R;
  R << across.normalized(), unit.cross(across.normalized()), unit;
  return R;
}

Pose poseAt(const Eigen::Vector3d& p, const Eigen::Matrix3d& R) {
  Pose X;
  X.linear() = R;
  X.translation() = p;
  return X;
}

}  // namespace longarm::planning
