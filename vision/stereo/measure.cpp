#include "vision/stereo/measure.h"

#include <algorithm>

namespace longarm::vision {
namespace {

using Vertices = std::vector<std::vector<Sighting>>;

FeatureVertex vertexOf(const TriangulatedPoint& point, const std::vector<Sighting>& sightings) {
  FeatureVertex vertex;
  vertex.xyz = point.xyz;
  vertex.covariance = point.covariance;
  vertex.miss_m = point.miss_m;
  vertex.reprojection_rms_px = point.reprojection_rms_px;
  for (const auto& sighting : sightings) vertex.views.push_back(sighting.view->name);
  return vertex;
}

// Triangulates every vertex on its own; what a kind knows of its shape comes after.
Result<std::vector<TriangulatedPoint>> triangulateAll(const Vertices& vertices, const TriangulationOptions& options) {
  std::vector<TriangulatedPoint> points;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    auto point = triangulate(vertices[i], options);
    const std::string prefix = vertices.size() > 1 ? "vertex " + std::to_string(i) + ": " : std::string();
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
    feature.vertices.push_back(vertexOf(points[i], vertices[i]));
    feature.warnings.insert(feature.warnings.end(), points[i].warnings.begin(), points[i].warnings.end());
  }
  return feature;
}

Result<Feature> finishLine(Feature feature, const std::vector<TriangulatedPoint>& points) {
  if (!(feature.length() > 1e-9)) {
    return Error{ErrorCode::kDegenerate, "the two ends of the line coincide: mark two different points"};
  }
  feature.cross_covariance = crossCovariance(points[0], points[1]);
  return feature;
}

}  // namespace

Result<Feature> measureFeature(const std::string& name, FeatureKind kind, const Vertices& vertices,
                               const TriangulationOptions& options) {
  const auto wanted = static_cast<std::size_t>(vertexCount(kind));
  if (vertices.size() != wanted) {
    return Error{ErrorCode::kInvalidInput, "a " + std::string(toString(kind)) + " has " + std::to_string(wanted) +
                                               " vertices; " + std::to_string(vertices.size()) + " are given"};
  }
  if (kind == FeatureKind::kPlane || kind == FeatureKind::kTriad) {
    return Error{ErrorCode::kRefused, std::string(toString(kind)) + " sketches are not measured yet"};
  }
  const auto points = triangulateAll(vertices, options);
  if (!points) return points.error();
  auto feature = assemble(name, kind, vertices, *points);
  if (!feature || kind == FeatureKind::kPoint) return feature;
  return finishLine(std::move(*feature), *points);
}

}  // namespace longarm::vision
