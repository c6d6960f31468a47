#include "vision/stereo/line.h"

#include <cmath>

#include "core/text.h"
#include "vision/stereo/view_plane.h"

namespace longarm::vision {
namespace {

using Eigen::Vector3d;

constexpr double kMinPickDistance = 2;   // [px]

}  // namespace

namespace internal {

Result<ViewPlane> planeOf(const LineSighting& sighting) {
  if (sighting.view == nullptr) return Error{ErrorCode::kInvalidInput, "a line's picks belong to no view"};
  const View& view = *sighting.view;
  if (!((sighting.pixel_a - sighting.pixel_b).norm() >= kMinPickDistance)) {
    return Error{ErrorCode::kInvalidInput, "view \"" + view.name + "\": the two picks on the line are less than 2 px apart"};
  }
  const auto a = view.camera.rayOfPixel(sighting.pixel_a);
  const auto b = view.camera.rayOfPixel(sighting.pixel_b);
  for (const auto* ray : {&a, &b}) {
    if (!*ray) return Error{ErrorCode::kInvalidInput, "view \"" + view.name + "\": " + ray->error().message};
  }
  const Eigen::Matrix3d R = view.X_WC.linear();
  return ViewPlane{view.X_WC.translation(), R * a->cross(*b).normalized(), R * *a, R * *b};
}

Error alongBaseline(double quality) {
  return {ErrorCode::kDegenerate, "the line runs along the baseline between the cameras (plane angle sine " +
                                      formatFixed(quality, 3) + ", need " + formatFixed(kMinPlaneQuality, 2) +
                                      "): mark its two ends in both pictures, or move the camera across the line"};
}

}  // namespace internal

namespace {

Error endBehind(const std::string& view) {
  return {ErrorCode::kDegenerate, "the line meets a viewing ray behind view \"" + view + "\""};
}

}  // namespace

Result<PlaneLine> lineFromPlanes(const LineSighting& first, const LineSighting& second) {
  const auto plane0 = internal::planeOf(first);
  if (!plane0) return plane0.error();
  const auto plane1 = internal::planeOf(second);
  if (!plane1) return plane1.error();
  if (first.view->parent != second.view->parent) {
    return Error{ErrorCode::kInvalidInput, "views \"" + first.view->name + "\" and \"" + second.view->name +
                                               "\" have different parent frames"};
  }
  PlaneLine line;
  line.quality = plane0->normal.cross(plane1->normal).norm();
  if (!(line.quality >= internal::kMinPlaneQuality)) {
    return internal::alongBaseline(line.quality);
  }
  const double height = plane1->normal.dot(plane1->centre - plane0->centre);
  for (auto [ray, end] : {std::pair<const Vector3d*, Vector3d*>{&plane0->ray_a, &line.point_a},
                          {&plane0->ray_b, &line.point_b}}) {
    const double along = height / plane1->normal.dot(*ray);
    if (!(along > 0 && along < 1e9)) return endBehind(first.view->name);
    *end = plane0->centre + along * *ray;
    const View& view = *second.view;
    if (!((*end - view.X_WC.translation()).dot(view.X_WC.linear().col(2)) > 0)) return endBehind(view.name);
  }
  return line;
}

}  // namespace longarm::vision
