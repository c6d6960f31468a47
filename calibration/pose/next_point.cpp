#include "calibration/pose/next_point.h"

#include <cmath>

#include <Eigen/Dense>

#include "calibration/solve/lens_parameters.h"

namespace longarm::calibration {
namespace {

constexpr double kPrior = 1e-3;            // keeps the determinant finite before three points are there [1/px^2]

std::optional<Matrix6d> informationOf(const vision::CameraModel& camera, const PoseObservation& o, const Pose& T) {
  const Eigen::Vector3d turned = T.linear() * o.y;
  LensProjection at;
  if (!projectWithDerivatives(camera, o.A * Eigen::Vector3d(turned + T.translation()), &at)) return std::nullopt;
  if (!camera.containsPixel(at.pixel)) return std::nullopt;
  Eigen::Matrix<double, 2, 6> J;
  J.leftCols<3>() = -at.d_point * o.A.linear() * skew(turned);
  J.rightCols<3>() = at.d_point * o.A.linear();
  return Matrix6d(J.transpose() * J);
}

double logDeterminant(const Matrix6d& information) {
  const auto d = Eigen::LDLT<Matrix6d>(information).vectorD().eval();
  double sum = 0;
  for (Eigen::Index i = 0; i < 6; ++i) sum += std::log(std::max(d[i], 1e-300));
  return sum;
}

}  // namespace

std::optional<std::size_t> nextPoint(const vision::CameraModel& camera, const std::vector<PoseObservation>& have,
                                     const std::vector<PoseObservation>& candidates, const Pose& T) {
  Matrix6d information = kPrior * Matrix6d::Identity();
  for (const auto& o : have) {
    if (const auto more = informationOf(camera, o, T)) information += *more;
  }
  std::optional<std::size_t> best;
  double most = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto more = informationOf(camera, candidates[i], T);
    if (!more) continue;
    const double value = logDeterminant(information + *more);
    if (best && value <= most) continue;
    best = i;
    most = value;
  }
  return best;
}

}  // namespace longarm::calibration
