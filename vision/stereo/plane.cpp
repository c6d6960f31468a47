#include "vision/stereo/plane.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "core/pose.h"
#include "core/text.h"

namespace longarm::vision {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kDegree = 0.017453292519943295;

std::string degrees(double angle) { return formatFixed(angle / kDegree, 1) + " degrees"; }

// Derivative of the normal by the three points: with edges e0, e2 from the shared vertex and N = |e0 x e2|.
Eigen::Matrix<double, 3, 9> normalByPoints(const Vector3d& e0, const Vector3d& e2, const Vector3d& normal, double N) {
  const Matrix3d across = (Matrix3d::Identity() - normal * normal.transpose()) / N;
  Eigen::Matrix<double, 3, 9> out;
  out << across * -skew(e2), across * (skew(e2) - skew(e0)), across * skew(e0);
  return out;
}

Error notPlane(double enclosed, double uncertainty) {
  std::string message = "the two lines of the plane enclose only " + degrees(std::min(enclosed, 180 * kDegree - enclosed));
  if (std::isfinite(uncertainty)) {
    message = "the plane's normal is uncertain by " + degrees(uncertainty) + " (at most 10 degrees are accepted); its lines enclose " +
              degrees(std::min(enclosed, 180 * kDegree - enclosed));
  }
  return {ErrorCode::kDegenerate,
          message + ": choose three points nearer to a right angle and farther apart, or use views farther apart"};
}

}  // namespace

Result<PlaneShape> planeThrough(const Matrix3d& points, const Eigen::Matrix<double, 9, 9>& covariance,
                                const Vector3d& towards, std::vector<std::string>* warnings, const PlaneOptions& options) {
  const Vector3d e0 = points.col(0) - points.col(1), e2 = points.col(2) - points.col(1);
  const Vector3d area = e0.cross(e2);
  const double enclosed = std::atan2(area.norm(), e0.dot(e2));
  if (!(area.norm() > 1e-6 * e0.norm() * e2.norm()) || !(area.norm() > 1e-12)) return notPlane(enclosed, std::nan(""));
  PlaneShape plane;
  plane.normal = area.normalized();
  const auto J = normalByPoints(e0, e2, plane.normal, area.norm());
  plane.normal_covariance = J * covariance * J.transpose();
  plane.center = 0.5 * (points.col(0) + points.col(2));
  plane.corners = {points.col(0), points.col(1), points.col(2), points.col(0) + e2};
  if (plane.normal.dot(towards - plane.center) < 0) plane.normal = -plane.normal;
  const double error = plane.angleError();
  if (!(error <= options.refuse_angle)) return notPlane(enclosed, error);
  if (error > options.warn_angle && warnings != nullptr) {
    warnings->push_back("the plane's normal is uncertain by " + degrees(error) + " (1 sigma): mark points farther apart, "
                        "or use views farther apart");
  }
  return plane;
}

}  // namespace longarm::vision
