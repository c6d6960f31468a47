#include "vision/stereo/measure.h"

#include <algorithm>

#include <Eigen/Dense>

#include "core/text.h"
#include "vision/stereo/box.h"
#include "vision/stereo/plane.h"

namespace longarm::vision {

using Vertices = std::vector<std::vector<Sighting>>;

namespace internal {

Status checkOnPicture(const Sighting& pick) {
  if (pick.view == nullptr || pick.view->camera.containsPixel(pick.pixel)) return {};
  const CameraModel& camera = pick.view->camera;
  return {ErrorCode::kInvalidInput,
          "the pick (" + formatFixed(pick.pixel.x(), 1) + ", " + formatFixed(pick.pixel.y(), 1) + ") is off the picture of view \"" +
              pick.view->name + "\" (" + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
              " px): mark the point inside it, or use a view that shows it"};
}

FeatureVertex vertexOf(const TriangulatedPoint& point, const std::vector<Sighting>& sightings) {
  FeatureVertex vertex;
  vertex.xyz = point.xyz;
  vertex.covariance = point.covariance;
  vertex.miss_m = point.miss_m;
  vertex.reprojection_rms_px = point.reprojection_rms_px;
  for (const auto& sighting : sightings) vertex.views.push_back(sighting.view->name);
  return vertex;
}

}  // namespace internal

namespace {

// Triangulates every vertex on its own; what a kind knows of its shape comes after.
Result<std::vector<TriangulatedPoint>> triangulateAll(const Vertices& vertices, const TriangulationOptions& options) {
  std::vector<TriangulatedPoint> points;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::string prefix = vertices.size() > 1 ? "vertex " + std::to_string(i) + ": " : std::string();
    for (const auto& sighting : vertices[i]) {
      if (auto status = internal::checkOnPicture(sighting); !status) return Error{status.error().code, prefix + status.error().message};
    }
    auto point = triangulate(vertices[i], options);
    if (!point) return Error{point.error().code, prefix + point.error().message};
    for (auto& warning : point->warnings) warning = prefix + warning;
    points.push_back(std::move(*point));
  }
  return points;
}

Status checkParents(const Vertices& vertices) {
  for (const auto& vertex : vertices) {
    if (vertex.front().view->parent != vertices.front().front().view->parent) {
      return {ErrorCode::kInvalidInput, "vertices are placed in \"" + vertices.front().front().view->parent +
                                            "\" and in \"" + vertex.front().view->parent +
                                            "\"; views must share one parent frame"};
    }
  }
  return {};
}

Result<Feature> assemble(const std::string& name, FeatureKind kind, const Vertices& vertices,
                         const std::vector<TriangulatedPoint>& points) {
  if (auto status = checkParents(vertices); !status) return status.error();
  Feature feature;
  feature.name = name;
  feature.kind = kind;
  feature.parent = vertices.front().front().view->parent;
  for (std::size_t i = 0; i < points.size(); ++i) {
    feature.vertices.push_back(internal::vertexOf(points[i], vertices[i]));
    feature.warnings.insert(feature.warnings.end(), points[i].warnings.begin(), points[i].warnings.end());
  }
  if (points.size() > 1) feature.cross_covariance = crossCovariance(points[0], points[1]);
  return feature;
}

Status finishLine(Feature* feature) {
  if (feature->length() > 1e-9) return {};
  return {ErrorCode::kDegenerate, "the two ends of the line coincide: mark two different points"};
}

// Covariance of all vertices together: calibration moves them as one.
Eigen::Matrix<double, 9, 9> jointCovariance(const std::vector<TriangulatedPoint>& points) {
  Eigen::Matrix<double, 9, 9> out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto& a = points[static_cast<std::size_t>(i)];
      out.block<3, 3>(3 * i, 3 * j) = i == j ? a.covariance : crossCovariance(a, points[static_cast<std::size_t>(j)]);
    }
  }
  return out;
}

Status finishPlane(const Vertices& vertices, const std::vector<TriangulatedPoint>& points, Feature* feature) {
  Eigen::Vector3d cameras = Eigen::Vector3d::Zero();
  double count = 0;
  for (const auto& vertex : vertices) {
    for (const auto& sighting : vertex) {
      cameras += sighting.view->X_WC.translation();
      ++count;
    }
  }
  Eigen::Matrix3d corners;
  for (int i = 0; i < 3; ++i) corners.col(i) = points[static_cast<std::size_t>(i)].xyz;
  const auto plane = planeThrough(corners, jointCovariance(points), cameras / count, &feature->warnings);
  if (!plane) return plane.error();
  feature->plane = *plane;
  return {};
}

Status finish(const Vertices& vertices, const std::vector<TriangulatedPoint>& points, Feature* feature) {
  switch (feature->kind) {
    case FeatureKind::kPoint: return {};
    case FeatureKind::kLine: return finishLine(feature);
    case FeatureKind::kPlane: return finishPlane(vertices, points, feature);
    case FeatureKind::kTriad: return fitBox(vertices, points, feature);
  }
  return {};
}

}  // namespace

Result<Feature> measureFeature(const std::string& name, FeatureKind kind, const Vertices& vertices,
                               const TriangulationOptions& options) {
  const auto wanted = static_cast<std::size_t>(vertexCount(kind));
  if (vertices.size() != wanted) {
    return Error{ErrorCode::kInvalidInput, "a " + std::string(toString(kind)) + " has " + std::to_string(wanted) +
                                               " vertices; " + std::to_string(vertices.size()) + " are given"};
  }
  const auto points = triangulateAll(vertices, options);
  if (!points) return points.error();
  auto feature = assemble(name, kind, vertices, *points);
  if (!feature) return feature;
  if (auto status = finish(vertices, *points, &*feature); !status) return status.error();
  return feature;
}

}  // namespace longarm::vision
