#include "session/document/dimension.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.h"
#include "session/document/feature_rows.h"
#include "vision/stereo/triangulate.h"

namespace longarm::session {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using vision::TriangulatedPoint;

namespace {

struct Placed {
  TriangulatedPoint point;
  std::string parent;
};

Result<Placed> placeOf(const Document& document, const VertexRef& ref) {
  const SketchItem* item = document.item(ref.item);
  if (item == nullptr || ref.vertex < 0 || ref.vertex >= item->vertices()) {
    return Error{ErrorCode::kInvalidInput, "That handle is gone. Choose another one."};
  }
  if (item->pipe) {
    return Error{ErrorCode::kInvalidInput, "The ends of '" + item->name + "' are outlines, not points. Measure to a point, line, plane or triad."};
  }
  std::vector<vision::Sighting> sightings;
  for (const auto& [id, list] : item->picks) {
    const SketchPick* pick = item->pick(id, ref.vertex);
    const SnapshotPtr picture = document.snapshot(id);
    if (pick != nullptr && pick->placed() && picture) sightings.push_back({&picture->view, pick->pixel, pick->sigma_px});
  }
  if (sightings.size() < 2) {
    return Error{ErrorCode::kInvalidInput, "'" + item->name + "' is marked there in one picture only. Mark it in two."};
  }
  auto point = vision::triangulate(sightings);
  if (!point) return point.error();
  return Placed{std::move(*point), sightings.front().view->parent};
}

template <std::size_t N>
Result<std::array<Placed, N>> placesOf(const Document& document, const std::array<VertexRef, N>& refs) {
  std::array<Placed, N> places;
  for (std::size_t i = 0; i < N; ++i) {
    auto place = placeOf(document, refs[i]);
    if (!place) return place.error();
    if (i > 0 && place->parent != places[0].parent) {
      return Error{ErrorCode::kInvalidInput, "One is measured in frame " + places[0].parent + ", the other in " + place->parent + "."};
    }
    places[i] = std::move(*place);
  }
  return places;
}

// The same vertex twice moves as one; others share what their calibrations share.
Matrix3d sharedBetween(const Placed& a, const Placed& b, bool same) {
  return same ? a.point.covariance : vision::crossCovariance(a.point, b.point);
}

template <std::size_t N>
double sigmaOf(const std::array<Placed, N>& places, const std::array<VertexRef, N>& refs, const std::array<Vector3d, N>& slopes) {
  double variance = 0;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t k = 0; k < N; ++k) {
      variance += slopes[i].dot(sharedBetween(places[i], places[k], refs[i] == refs[k]) * slopes[k]);
    }
  }
  return std::sqrt(std::max(0.0, variance));
}

constexpr double kNowhere_m = 1e-6;

}  // namespace

std::string Dimension::text() const {
  if (!is_angle) return millimetreText(value, plusMinus95(sigma));
  const double degrees = 180 / M_PI;
  return formatFixed(value * degrees, 1) + " \u00b1 " + formatFixed(plusMinus95(sigma) * degrees, 1) + "\u00b0";
}

Result<Vector3d> positionOf(const Document& document, const VertexRef& vertex) {
  const auto place = placeOf(document, vertex);
  if (!place) return place.error();
  return place->point.xyz;
}

Result<Dimension> distanceBetween(const Document& document, const VertexRef& a, const VertexRef& b) {
  const std::array<VertexRef, 2> refs{a, b};
  const auto places = placesOf(document, refs);
  if (!places) return places.error();
  const Vector3d way = (*places)[1].point.xyz - (*places)[0].point.xyz;
  Dimension out;
  out.value = way.norm();
  const Vector3d n = out.value > kNowhere_m ? Vector3d(way / out.value) : Vector3d(Vector3d::UnitX());
  out.sigma = sigmaOf<2>(*places, refs, {-n, n});
  return out;
}

Result<Dimension> angleAt(const Document& document, const VertexRef& a, const VertexRef& corner, const VertexRef& b) {
  const std::array<VertexRef, 3> refs{a, corner, b};
  const auto places = placesOf(document, refs);
  if (!places) return places.error();
  const Vector3d u = (*places)[0].point.xyz - (*places)[1].point.xyz, v = (*places)[2].point.xyz - (*places)[1].point.xyz;
  if (u.norm() < kNowhere_m || v.norm() < kNowhere_m) {
    return Error{ErrorCode::kDegenerate, "An angle needs two ways that lead somewhere: two of the three vertices coincide."};
  }
  Dimension out;
  out.is_angle = true;
  out.value = std::atan2(u.cross(v).norm(), u.dot(v));
  // Turning u within the plane of both: d angle = -(perpendicular of u in that plane) . du / |u|.
  const Vector3d axis = u.cross(v).norm() > 1e-12 ? Vector3d(u.cross(v).normalized()) : Vector3d(u.unitOrthogonal());
  const Vector3d by_a = -axis.cross(u.normalized()) / u.norm(), by_b = axis.cross(v.normalized()) / v.norm();
  out.sigma = sigmaOf<3>(*places, refs, {by_a, -by_a - by_b, by_b});
  return out;
}

}  // namespace longarm::session
