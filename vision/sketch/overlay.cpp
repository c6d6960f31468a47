#include "vision/sketch/overlay.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "core/text.h"
#include "vision/sketch/solids.h"
#include "vision/stereo/project_polyline.h"

namespace longarm::vision {
namespace {

using Kind = OverlayShape::Kind;

constexpr double k95Percent2d = 2.4477468306808161;   // sqrt of the 95 % quantile of chi-square, 2 degrees of freedom

void addPieces(const View& view, const std::vector<Eigen::Vector3d>& points_W, OverlayRole role, Overlay* overlay) {
  for (auto& piece : projectPolyline(view, points_W)) overlay->shapes.push_back({Kind::kPolyline, role, std::move(piece), {}});
}

// Vertices in the order in which a sketch draws them.
std::vector<std::vector<std::size_t>> edgesOf(FeatureKind kind) {
  switch (kind) {
    case FeatureKind::kPoint: return {};
    case FeatureKind::kLine: return {{0, 1}};
    case FeatureKind::kPlane: return {{0, 1, 2}};
    case FeatureKind::kTriad: return {{0, 1}, {0, 2}, {0, 3}};
  }
  return {};
}

// There along one edge of the band, back along the other.  @pre end - first > 1
std::vector<Eigen::Vector2d> bandOutline(const EpipolarCurve& curve, const std::vector<double>& sigma_px, std::size_t first,
                                         std::size_t end) {
  std::vector<Eigen::Vector2d> there, back;
  for (std::size_t i = first; i < end; ++i) {
    const Eigen::Vector2d chord = curve.points[std::min(i + 1, end - 1)].pixel - curve.points[std::max(i, first + 1) - 1].pixel;
    const double length = chord.norm();
    if (!(length > 0) || !std::isfinite(sigma_px[i])) continue;
    const Eigen::Vector2d across = 2 * sigma_px[i] / length * Eigen::Vector2d(-chord.y(), chord.x());
    there.push_back(curve.points[i].pixel + across);
    back.push_back(curve.points[i].pixel - across);
  }
  there.insert(there.end(), back.rbegin(), back.rend());
  return there;
}

}  // namespace

void addEpipolarCurve(const EpipolarCurve& curve, Overlay* overlay) {
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    if (i == 0 || curve.points[i].begins_piece) {
      overlay->shapes.push_back({Kind::kPolyline, OverlayRole::kEpipolar, {}, {}});
    }
    overlay->shapes.back().points.push_back(curve.points[i].pixel);
  }
  for (const auto& tick : curve.ticks) {
    overlay->shapes.push_back({Kind::kMarker, OverlayRole::kDepthTick, {tick.pixel}, {}});
    overlay->shapes.push_back({Kind::kText, OverlayRole::kDepthTick, {tick.pixel}, formatNumber(tick.depth) + " m"});
  }
}

void addEpipolarBand(const EpipolarCurve& curve, const std::vector<double>& sigma_px, Overlay* overlay) {
  const std::size_t n = std::min(curve.points.size(), sigma_px.size());
  for (std::size_t first = 0; first < n;) {
    std::size_t end = first + 1;
    while (end < n && !curve.points[end].begins_piece) ++end;
    if (end - first > 1) overlay->shapes.push_back({Kind::kArea, OverlayRole::kBand, bandOutline(curve, sigma_px, first, end), {}});
    first = end;
  }
}

std::vector<Eigen::Vector2d> errorEllipse(const View& view, const Eigen::Vector3d& xyz, const Eigen::Matrix3d& covariance,
                                          int samples) {
  const Eigen::Matrix3d R = view.X_WC.linear();
  const auto projection = view.camera.projectWithJacobian(R.transpose() * (xyz - view.X_WC.translation()));
  if (!projection || samples < 3 || !covariance.allFinite()) return {};
  const Eigen::Matrix<double, 2, 3> J = projection->d_point * R.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(J * covariance * J.transpose());
  const Eigen::Vector2d radii = k95Percent2d * eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
  std::vector<Eigen::Vector2d> outline;
  for (int i = 0; i <= samples; ++i) {
    const double angle = 2 * M_PI * (i % samples) / samples;
    outline.push_back(projection->pixel +
                      eigen.eigenvectors() * Eigen::Vector2d(radii.x() * std::cos(angle), radii.y() * std::sin(angle)));
  }
  return outline;
}

void addSolid(const Feature& feature, const View& view, OverlayRole role, Overlay* overlay) {
  if (feature.parent != view.parent) return;
  SolidLook look;
  look.role = role;
  if (feature.box && feature.box->is_box) addBox(feature.box->X_WB, feature.box->size, view, look, overlay);
  if (feature.pipe && feature.vertices.size() == 2) {
    addCylinder(pipePose(feature), feature.pipe->radius, feature.length(), view, look, overlay);
  }
}

void addFeature(const Feature& feature, const View& view, OverlayRole role, Overlay* overlay) {
  if (feature.parent != view.parent) return;
  addSolid(feature, view, OverlayRole::kSolid, overlay);
  for (const auto& edge : edgesOf(feature.kind)) {
    std::vector<Eigen::Vector3d> points;
    for (const std::size_t i : edge) {
      if (i < feature.vertices.size()) points.push_back(feature.vertices[i].xyz);
    }
    addPieces(view, points, role, overlay);
  }
  for (const auto& vertex : feature.vertices) {
    const auto pixel = view.project(vertex.xyz);
    if (!pixel) continue;
    overlay->shapes.push_back({Kind::kMarker, role, {*pixel}, {}});
    auto outline = errorEllipse(view, vertex.xyz, vertex.covariance);
    if (!outline.empty()) overlay->shapes.push_back({Kind::kPolyline, OverlayRole::kEllipse, std::move(outline), {}});
  }
}

void addPath(const std::vector<Eigen::Vector3d>& points_W, const View& view, OverlayRole role, Overlay* overlay) {
  addPieces(view, points_W, role, overlay);
}

}  // namespace longarm::vision
