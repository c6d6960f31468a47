#include "calibration/intrinsics/lens_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

namespace longarm::calibration {
namespace {

using LensRows = Eigen::Matrix<double, 2, kLensParameters>;
using TurnRows = Eigen::Matrix<double, 2, 3>;

struct Place {
  LensRows by_lens;
  TurnRows by_turn;
};

std::optional<Place> placeAt(const vision::CameraModel& camera, const Eigen::Vector2d& pixel) {
  const auto n = camera.normalisedOfPixel(pixel);
  LensProjection at;
  if (!n || !projectWithDerivatives(camera, n->homogeneous(), &at)) return std::nullopt;
  return Place{at.d_lens, at.d_point * -skew(n->homogeneous())};
}

Eigen::Vector2d gridPixel(const vision::CameraModel& camera, int columns, int rows, int index) {
  return {(camera.width - 1.0) * (index % columns) / (columns - 1), (camera.height - 1.0) * (index / columns) / (rows - 1)};
}

}  // namespace

Result<LensUncertainty> lensUncertainty(const vision::CameraModel& camera, const LensMatrix& covariance, int columns, int rows) {
  if (camera.width <= 0 || camera.height <= 0) return Error{ErrorCode::kInvalidInput, "the camera's picture size is not known"};
  if (columns < 2 || rows < 2) return Error{ErrorCode::kInvalidInput, "the grid needs at least 2 columns and 2 rows"};
  LensUncertainty out;
  out.columns = columns;
  out.rows = rows;
  std::vector<std::optional<Place>> places;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, kLensParameters> mixed = Eigen::Matrix<double, 3, kLensParameters>::Zero();
  for (int i = 0; i < columns * rows; ++i) {
    out.pixels.push_back(gridPixel(camera, columns, rows, i));
    places.push_back(placeAt(camera, out.pixels.back()));
    if (!places.back()) continue;
    turn += places.back()->by_turn.transpose() * places.back()->by_turn;
    mixed += places.back()->by_turn.transpose() * places.back()->by_lens;
  }
  const Eigen::Matrix<double, 3, kLensParameters> explained = turn.ldlt().solve(mixed);
  int counted = 0;
  for (const auto& place : places) {
    out.sigma_px.push_back(-1);
    if (!place) continue;
    const LensRows J = place->by_lens - place->by_turn * explained;
    const double sigma = std::sqrt(std::max(0.0, 0.5 * (J * covariance * J.transpose()).trace()));
    out.sigma_px.back() = sigma;
    out.mean_px += sigma;
    out.max_px = std::max(out.max_px, sigma);
    ++counted;
  }
  if (counted == 0) return Error{ErrorCode::kDegenerate, "no place of the picture has a ray: the lens cannot be inverted"};
  out.mean_px /= counted;
  return out;
}

}  // namespace longarm::calibration
