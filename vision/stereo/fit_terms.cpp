#include "vision/stereo/fit_terms.h"

#include <cmath>

#include <Eigen/Dense>

#include "core/text.h"
#include "vision/camera/lens.h"

namespace longarm::vision::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::RowVector3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Error behindCamera(const View& view, const std::string& why) {
  return {ErrorCode::kDegenerate, labelOf(view) + ": " + why};
}

// Fills the rows `row` ... of a pick that shows a point.
Status pointRows(const FitTerm& term, const Matrix3Xd& points, const MatrixXd& d_points, int row, FitRows* out) {
  const View& view = *term.pick.view;
  const Vector3d from_centre = points.col(term.point) - view.X_WC.translation();
  const Vector3d p_C = view.X_WC.linear().transpose() * from_centre;
  const auto projection = view.camera.projectWithJacobian(p_C);
  if (!projection) return behindCamera(view, projection.error().message);
  const Eigen::Matrix<double, 2, 3> J = projection->d_point * view.X_WC.linear().transpose();
  out->residual.segment<2>(row) = term.pick.pixel - projection->pixel;
  out->d_state.middleRows<2>(row) = J * d_points.middleRows<3>(3 * term.point);
  out->d_pose.middleRows<2>(row) = pixelByPose(J, from_centre);
  out->d_intrinsics.middleRows<2>(row) = pixelByIntrinsics(view.camera, p_C.head<2>() / p_C.z());
  return {};
}

// Fills the row of a pick that lies on a line: its distance from the line's image, to first order in pixels.
Status lineRow(const FitTerm& term, const Matrix3Xd& points, const MatrixXd& d_points, int row, FitRows* out) {
  const View& view = *term.pick.view;
  const Matrix3d R_CW = view.X_WC.linear().transpose();
  const Vector3d from0 = points.col(term.point) - view.X_WC.translation();
  const Vector3d from1 = points.col(term.other) - view.X_WC.translation();
  const Vector3d p0 = R_CW * from0, p1 = R_CW * from1;
  if (!(p0.z() > 1e-9 && p1.z() > 1e-9)) return behindCamera(view, "an end of the line is behind the camera");
  Vector2d n;
  Distorted at;
  if (!undistortPixel(view.camera, monotoneRadius2(view.camera), term.pick.pixel, &n, &at)) {
    return behindCamera(view, "a pick has no viewing ray");
  }
  const Vector3d ray(n.x(), n.y(), 1), plane = p0.cross(p1);
  // d value / d pixel = M^-T (plane.x, plane.y)
  const Vector2d slope = pixelByNormalised(view.camera, at).transpose().inverse() * plane.head<2>();
  const double scale = slope.norm();
  if (!(scale > 0)) return behindCamera(view, "the line points at the camera");
  const RowVector3d by0 = (p1.cross(ray) / scale).transpose() * R_CW, by1 = (ray.cross(p0) / scale).transpose() * R_CW;
  out->residual[row] = -plane.dot(ray) / scale;
  out->d_state.row(row) = by0 * d_points.middleRows<3>(3 * term.point) + by1 * d_points.middleRows<3>(3 * term.other);
  out->d_pose.row(row) << by0 * skew(from0) + by1 * skew(from1), -by0 - by1;
  out->d_intrinsics.row(row) = -(slope / scale).transpose() * pixelByIntrinsics(view.camera, n);
  return {};
}

}  // namespace

double sigmaOf(const Sighting& pick) { return pick.sigma_px > 0 ? pick.sigma_px : pick.view->sigma_px; }

std::string labelOf(const View& view) { return view.name.empty() ? std::string("a view") : "view \"" + view.name + "\""; }

Status checkTerms(const std::vector<FitTerm>& terms) {
  for (const auto& term : terms) {
    if (term.pick.view == nullptr) return {ErrorCode::kInvalidInput, "a pick belongs to no view"};
    const View& view = *term.pick.view;
    const View& first = *terms.front().pick.view;
    if (view.parent != first.parent) {
      return {ErrorCode::kInvalidInput, labelOf(first) + " is placed in \"" + first.parent + "\" and " + labelOf(view) +
                                            " in \"" + view.parent + "\"; views must share one parent frame"};
    }
    if (!term.pick.pixel.allFinite()) return {ErrorCode::kInvalidInput, "the pick in " + labelOf(view) + " is not finite"};
    const double sigma = sigmaOf(term.pick);
    if (!(sigma > 0 && sigma < 1e6)) {
      return {ErrorCode::kInvalidInput, labelOf(view) + ": sigma_px is " + formatNumber(sigma) + "; expected above 0"};
    }
    const auto ray = view.camera.normalisedOfPixel(term.pick.pixel);
    if (!ray) return {ErrorCode::kInvalidInput, labelOf(view) + ": " + ray.error().message};
  }
  return {};
}

Result<FitRows> rowsOfTerms(const std::vector<FitTerm>& terms, const Matrix3Xd& points, const MatrixXd& d_points) {
  int count = 0;
  for (const auto& term : terms) count += term.rowCount();
  FitRows rows;
  rows.resize(count, static_cast<int>(d_points.cols()));
  int row = 0;
  for (const auto& term : terms) {
    const auto status = term.other < 0 ? pointRows(term, points, d_points, row, &rows)
                                       : lineRow(term, points, d_points, row, &rows);
    if (!status) return status.error();
    for (int i = 0; i < term.rowCount(); ++i, ++row) {
      rows.sigma[row] = sigmaOf(term.pick);
      rows.views[static_cast<std::size_t>(row)] = term.pick.view;
    }
  }
  return rows;
}

}  // namespace longarm::vision::internal
