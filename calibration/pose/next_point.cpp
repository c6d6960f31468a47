#include "calibration/pose/next_point.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

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

Matrix6d informationOf(const vision::CameraModel& camera, const std::vector<PoseObservation>& observations, const Pose& T, int* seen) {
  Matrix6d sum = Matrix6d::Zero();
  *seen = 0;
  for (const auto& o : observations) {
    const auto more = informationOf(camera, o, T);
    if (!more) continue;
    sum += *more;
    ++*seen;
  }
  return sum;
}

// 1 sigma of turn and shift.
std::pair<double, double> spread(const Matrix6d& information, double sigma_px) {
  const Matrix6d C = sigma_px * sigma_px * information.inverse();
  return {std::sqrt(C.topLeftCorner<3, 3>().trace()), std::sqrt(C.bottomRightCorner<3, 3>().trace())};
}

}  // namespace

std::optional<NextPicture> nextPicture(const vision::CameraModel& camera, const std::vector<PoseObservation>& have,
                                       const std::vector<std::vector<PoseObservation>>& candidates, const Pose& T, int most, double sigma_px) {
  int seen = 0;
  const Matrix6d now = informationOf(camera, have, T, &seen);
  if (seen < 3 || Eigen::SelfAdjointEigenSolver<Matrix6d>(now, Eigen::EigenvaluesOnly).eigenvalues()[0] <= 0) return std::nullopt;
  std::optional<NextPicture> best;
  double gain = logDeterminant(now);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    int points = 0;
    const Matrix6d all = informationOf(camera, candidates[i], T, &points);
    if (points == 0) continue;
    const Matrix6d after = now + all * (std::min(points, most) / static_cast<double>(points));
    const double value = logDeterminant(after);
    if (value <= gain) continue;
    gain = value;
    NextPicture next{i, points, 0, 0, 0, 0};
    std::tie(next.turn_before, next.shift_before) = spread(now, sigma_px);
    std::tie(next.turn_after, next.shift_after) = spread(after, sigma_px);
    best = next;
  }
  return best;
}

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
