#include "calibration/intrinsics/choose_lens.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace longarm::calibration::internal {
namespace {

constexpr double kFloorPx = 1e-3;
constexpr double kLeastSkew = 0.002;
constexpr double kCertainSkew = 400;

}  // namespace

std::vector<LensGroup> openGroups(const LensChoice& choice) {
  std::vector<LensGroup> groups;
  if (!choice.distortion) groups = {{{kK1}, 9.0}, {{kK2}, 9.0}, {{kP1, kP2}, 11.83}};
  if (!choice.skew && (!choice.distortion || choice.open_skew)) groups.push_back({{kSkew}, 9.0});
  return groups;
}

bool isKept(const LensGroup& group, double significance, const vision::CameraModel& camera) {
  if (significance <= group.threshold) return false;
  if (group.parameters.front() != kSkew) return true;
  return std::abs(camera.skew) > kLeastSkew * camera.fx || significance > kCertainSkew;
}

double significance(ArrowModel* model, const vision::CameraModel& camera, const LensMask& mask, int offset,
                    const std::vector<int>& group, int degrees_of_freedom) {
  ArrowNormal normal(model->globals(), model->blocks());
  const double cost = model->linearise(&normal);
  const auto covariance = inverseOf(normal);
  if (!covariance || degrees_of_freedom < 1) return 0;
  const auto free = mask.indices();
  const auto n = static_cast<Eigen::Index>(group.size());
  const LensVector lens = lensVector(camera);
  std::vector<Eigen::Index> at;
  for (const int p : group) at.push_back(offset + (std::find(free.begin(), free.end(), p) - free.begin()));
  Eigen::MatrixXd C(n, n);
  Eigen::VectorXd v(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    v[i] = lens[group[static_cast<std::size_t>(i)]];
    for (Eigen::Index j = 0; j < n; ++j) {
      C(i, j) = covariance->global(at[static_cast<std::size_t>(i)], at[static_cast<std::size_t>(j)]);
    }
  }
  const double variance = std::max(cost / degrees_of_freedom, kFloorPx * kFloorPx);
  return v.dot(C.ldlt().solve(v)) / variance;
}

}  // namespace longarm::calibration::internal
