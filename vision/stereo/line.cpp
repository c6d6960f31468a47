#include "vision/stereo/line.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

#include "core/text.h"
#include "vision/stereo/chi_square.h"
#include "vision/stereo/fit_terms.h"
#include "vision/stereo/measure.h"
#include "vision/stereo/view_plane.h"

namespace longarm::vision {
namespace {

using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using internal::FitTerm;
using internal::ViewPlane;

// A view in which the whole line was marked, matched or not.
struct LineImage {
  const View* view;
  ViewPlane plane;
};

const Sighting* seenBy(const std::vector<Sighting>& sightings, const View* view) {
  const auto found = std::find_if(sightings.begin(), sightings.end(), [&](const auto& s) { return s.view == view; });
  return found == sightings.end() ? nullptr : &*found;
}

Result<std::vector<LineImage>> imagesOf(const LinePicks& picks) {
  std::vector<LineSighting> sightings;
  for (const auto& pick : picks.end0) {
    if (const auto* other = seenBy(picks.end1, pick.view)) sightings.push_back({pick.view, pick.pixel, other->pixel});
  }
  sightings.insert(sightings.end(), picks.along.begin(), picks.along.end());
  std::vector<LineImage> images;
  for (const auto& sighting : sightings) {
    const auto plane = internal::planeOf(sighting);
    if (!plane) return plane.error();
    images.push_back({sighting.view, *plane});
  }
  return images;
}

// Where one pick's ray meets the plane of another view that it crosses most steeply.
Result<Vector3d> onPlane(const Sighting& pick, const std::vector<LineImage>& images) {
  const auto ray = pick.view->camera.rayOfPixel(pick.pixel);
  if (!ray) return Error{ErrorCode::kInvalidInput, internal::labelOf(*pick.view) + ": " + ray.error().message};
  const Vector3d direction = pick.view->X_WC.linear() * *ray, centre = pick.view->X_WC.translation();
  const ViewPlane* own = nullptr;
  for (const auto& image : images) own = image.view == pick.view ? &image.plane : own;
  double quality = 0, distance = 0;
  for (const auto& image : images) {
    if (image.view == pick.view) continue;
    const double sine = own != nullptr ? own->normal.cross(image.plane.normal).norm() : std::abs(image.plane.normal.dot(direction));
    if (sine <= quality) continue;
    quality = sine;
    distance = image.plane.normal.dot(image.plane.centre - centre) / image.plane.normal.dot(direction);
  }
  if (!(quality >= internal::kMinPlaneQuality)) return internal::alongBaseline(quality);
  if (!(distance > 0 && distance < 1e9)) {
    return Error{ErrorCode::kDegenerate, "the line meets a viewing ray behind " + internal::labelOf(*pick.view) +
                                             ": the pictures do not show the same line, or a view's pose is wrong"};
  }
  return Vector3d(centre + distance * direction);
}

// One end: its picks, its start, and the free measurement where there is one.
struct End {
  std::vector<Sighting> picks;
  std::optional<TriangulatedPoint> point;
  Vector3d start = Vector3d::Zero();
};

Result<End> endOf(const LinePicks& picks, int which, const std::vector<LineImage>& images, const TriangulationOptions& options) {
  End end;
  end.picks = which == 0 ? picks.end0 : picks.end1;
  if (end.picks.empty()) {
    const LineSighting& anchor = picks.along.front();
    end.picks.push_back({anchor.view, which == 0 ? anchor.pixel_a : anchor.pixel_b, 0});
  }
  const std::string prefix = "end " + std::to_string(which) + ": ";
  if (end.picks.size() >= 2) {
    auto point = triangulate(end.picks, options);
    if (!point) return Error{point.error().code, prefix + point.error().message};
    end.start = point->xyz;
    end.point = std::move(*point);
    return end;
  }
  const auto start = onPlane(end.picks.front(), images);
  if (!start) return Error{start.error().code, prefix + start.error().message};
  end.start = *start;
  return end;
}

std::vector<FitTerm> termsOf(const LinePicks& picks, const End& end0, const End& end1) {
  std::vector<FitTerm> terms;
  for (const auto& pick : end0.picks) terms.push_back({pick, 0, -1});
  for (const auto& pick : end1.picks) terms.push_back({pick, 1, -1});
  for (std::size_t i = 0; i < picks.along.size(); ++i) {
    const auto& sighting = picks.along[i];
    // The first view's picks already hold the ends that were matched nowhere.
    if (!(i == 0 && picks.end0.empty())) terms.push_back({{sighting.view, sighting.pixel_a, 0}, 0, 1});
    if (!(i == 0 && picks.end1.empty())) terms.push_back({{sighting.view, sighting.pixel_b, 0}, 0, 1});
  }
  return terms;
}

FeatureVertex vertexOf(const End& end, const LinePicks& picks, const Vector3d& xyz, const MatrixXd& covariance, double rms_px) {
  FeatureVertex vertex;
  vertex.xyz = xyz;
  vertex.covariance = covariance;
  vertex.miss_m = end.point ? end.point->miss_m : 0;
  vertex.reprojection_rms_px = rms_px;
  for (const auto& pick : end.picks) vertex.views.push_back(pick.view->name);
  for (const auto& sighting : picks.along) {
    const auto& known = vertex.views;
    if (std::find(known.begin(), known.end(), sighting.view->name) == known.end()) vertex.views.push_back(sighting.view->name);
  }
  return vertex;
}

Status checkPicks(const LinePicks& picks) {
  if (picks.along.empty() && (picks.end0.empty() || picks.end1.empty())) {
    return {ErrorCode::kInvalidInput, "the line has no picks at one end: mark both ends, or the line in two views"};
  }
  for (const auto* end : {&picks.end0, &picks.end1}) {
    for (const auto& pick : *end) {
      if (auto status = internal::checkOnPicture(pick); !status) return status;
    }
  }
  for (const auto& sighting : picks.along) {
    for (const auto& pixel : {sighting.pixel_a, sighting.pixel_b}) {
      if (auto status = internal::checkOnPicture({sighting.view, pixel, 0}); !status) return status;
    }
  }
  return {};
}

Result<Feature> fitLine(const std::string& name, const LinePicks& picks, const End& end0, const End& end1) {
  const auto terms = termsOf(picks, end0, end1);
  if (auto status = internal::checkTerms(terms); !status) return status.error();
  internal::FitProblem problem;
  problem.plus = [](const VectorXd& state, const VectorXd& step) -> VectorXd { return state + step; };
  problem.rows = [&](const VectorXd& state) {
    return internal::rowsOfTerms(terms, Eigen::Map<const Matrix3Xd>(state.data(), 3, 2), MatrixXd::Identity(6, 6));
  };
  VectorXd start(6);
  start << end0.start, end1.start;
  const auto fitted = internal::fit(problem, start);
  if (!fitted) return fitted.error();
  const MatrixXd covariance = fitted->covariance();
  Feature feature;
  feature.name = name;
  feature.kind = FeatureKind::kLine;
  feature.parent = terms.front().pick.view->parent;
  feature.vertices = {vertexOf(end0, picks, fitted->state.head<3>(), covariance.topLeftCorner<3, 3>(), fitted->rmsPx()),
                      vertexOf(end1, picks, fitted->state.tail<3>(), covariance.bottomRightCorner<3, 3>(), fitted->rmsPx())};
  feature.cross_covariance = covariance.topRightCorner<3, 3>();
  if (fitted->degrees_of_freedom > 0 && fitted->chi2 > chi2Limit(fitted->degrees_of_freedom, kChi2Gross)) {
    feature.warnings.push_back("the picks disagree: " + formatFixed(fitted->rmsPx(), 2) +
                               " px rms; check that all pictures show the same line, then the calibration");
  }
  if (!(feature.length() > 1e-9)) {
    return Error{ErrorCode::kDegenerate, "the two ends of the line coincide: mark two different points"};
  }
  return feature;
}

}  // namespace

Result<Feature> estimateLine(const std::string& name, const std::vector<Sighting>& end0, const std::vector<Sighting>& end1,
                             const TriangulationOptions& options) {
  return measureFeature(name, FeatureKind::kLine, {end0, end1}, options);
}

Result<Feature> estimateLine(const std::string& name, const LinePicks& picks, const TriangulationOptions& options) {
  if (auto status = checkPicks(picks); !status) return status.error();
  if (picks.along.empty()) return estimateLine(name, picks.end0, picks.end1, options);
  const auto images = imagesOf(picks);
  if (!images) return images.error();
  const auto end0 = endOf(picks, 0, *images, options);
  if (!end0) return end0.error();
  const auto end1 = endOf(picks, 1, *images, options);
  if (!end1) return end1.error();
  return fitLine(name, picks, *end0, *end1);
}

}  // namespace longarm::vision
