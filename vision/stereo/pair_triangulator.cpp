#include "vision/stereo/pair_triangulator.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "core/require.h"
#include "vision/camera/lens.h"

namespace longarm::vision {
namespace {

using Eigen::Vector2d;

// The polynomial that undoes the radial part at Chebyshev's places between the middle and the farthest pixel.
void setInverseRadial(const CameraModel& camera, double max_radius2, double* s) {
  constexpr int n = internal::kInverseTerms;
  const auto& d = camera.distortion;
  const auto distorted2 = [&](double r2) {
    const double radial = 1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
    return r2 * radial * radial;
  };
  // How far the picture's corners are out, before the lens; the least ideal radius that reaches there.
  double reach2 = 0;
  for (const double u : {0.0, static_cast<double>(camera.width)}) {
    for (const double v : {0.0, static_cast<double>(camera.height)}) {
      const double y = (v - camera.cy) / camera.fy, x = (u - camera.cx - camera.skew * y) / camera.fx;
      reach2 = std::max(reach2, x * x + y * y);
    }
  }
  double low = 0, high = std::min(max_radius2, 4 * reach2);
  for (int i = 0; i < 40 && high - low > 1e-6 * high; ++i) (distorted2(0.5 * (low + high)) < reach2 ? low : high) = 0.5 * (low + high);
  Eigen::Matrix<double, n, n> powers;
  Eigen::Matrix<double, n, 1> values;
  for (int i = 0; i < n; ++i) {
    const double r2 = 0.5 * high * (1 - std::cos((i + 0.5) * std::acos(-1.0) / n));
    const double rr = distorted2(r2);
    values[i] = (std::sqrt(r2 / rr) - 1) / rr;
    for (int j = 0; j < n; ++j) powers(i, j) = std::pow(rr / reach2, j);
  }
  const Eigen::Matrix<double, n, 1> found = powers.partialPivLu().solve(values);
  for (int j = 0; j < n; ++j) s[j] = found[j] / std::pow(reach2, j);
}

void setCamera(const View& view, std::size_t k, internal::CameraPair* pair) {
  const CameraModel& camera = view.camera;
  const auto& d = camera.distortion;
  pair->cx[k] = camera.cx;
  pair->cy[k] = camera.cy;
  pair->skew[k] = camera.skew;
  pair->fx[k] = camera.fx;
  pair->fy[k] = camera.fy;
  pair->inverse_fx[k] = 1 / camera.fx;
  pair->inverse_fy[k] = 1 / camera.fy;
  pair->k1[k] = d[0];
  pair->k2[k] = d[1];
  pair->p1[k] = d[2];
  pair->p2[k] = d[3];
  pair->k3[k] = d[4];
  setInverseRadial(camera, internal::monotoneRadius2(camera), pair->inverse_radial[k]);
  pair->max_radius2[k] = internal::monotoneRadius2(camera);
  pair->noise_x[k] = view.sigma_px / camera.fx;
  pair->noise_y[k] = view.sigma_px / camera.fy;
  pair->noise_skew[k] = view.sigma_px * camera.skew / (camera.fx * camera.fy);
  pair->weight[k] = 1 / (view.sigma_px * view.sigma_px);
  for (int i = 0; i < 3; ++i) {
    pair->axis_x[k][i] = view.X_WC.linear()(i, 0);
    pair->axis_y[k][i] = view.X_WC.linear()(i, 1);
    pair->axis_z[k][i] = view.X_WC.linear()(i, 2);
  }
}

}  // namespace

PairTriangulator::PairTriangulator(const View& a, const View& b, double refuse_parallax)
    : m_camera_a(a.camera), m_camera_b(b.camera), m_p_WA(a.X_WC.translation()) {
  LONGARM_REQUIRE(a.parent == b.parent, "PairTriangulator: parents " + a.parent + " and " + b.parent);
  setCamera(a, 0, &m_pair);
  setCamera(b, 1, &m_pair);
  const Eigen::Vector3d baseline = b.X_WC.translation() - m_p_WA;
  for (int i = 0; i < 3; ++i) {
    m_pair.centre[i] = m_p_WA[i];
    m_pair.baseline[i] = baseline[i];
  }
  const Eigen::Matrix3d to_a = a.X_WC.linear().transpose(), R = to_a * b.X_WC.linear();
  const Eigen::Vector3d shift = to_a * baseline;
  for (int i = 0; i < 3; ++i) {
    m_pair.shift[i] = shift[i];
    for (int j = 0; j < 3; ++j) m_pair.rotation[i][j] = R(i, j);
  }
  const double sine = std::sin(refuse_parallax);
  m_pair.min_sine2 = sine * sine;
}

bool PairTriangulator::locate(const Vector2d& pixel_a, const Vector2d& pixel_b, PairPoint* point) const {
  const double u[2] = {pixel_a.x(), pixel_b.x()}, v[2] = {pixel_a.y(), pixel_b.y()};
  internal::PairSolution solution;
  auto answer = internal::solvePixels(m_pair, u, v, &solution);
  if (answer == internal::PairAnswer::kLensUnsettled) answer = solveThoroughly(pixel_a, pixel_b, &solution);
  if (answer != internal::PairAnswer::kLocated) return false;
  point->xyz = m_p_WA + Eigen::Vector3d(solution.p[0], solution.p[1], solution.p[2]);
  const auto& s = solution;
  point->covariance << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  point->miss_m = s.gap;
  point->parallax = std::atan2(s.sine, s.cosine);
  return true;
}

std::size_t PairTriangulator::locateAll(const std::vector<Vector2d>& pixels_a, const std::vector<Vector2d>& pixels_b,
                                        std::vector<Eigen::Vector3d>* points) const {
  LONGARM_REQUIRE(pixels_a.size() == pixels_b.size(), "PairTriangulator: lists of different lengths");
  points->resize(pixels_a.size());
  if (pixels_a.empty()) return 0;
  const std::size_t whole = pixels_a.size() / internal::kPairLanes * internal::kPairLanes;
  const double *a = pixels_a.front().data(), *b = pixels_b.front().data();
  auto located = static_cast<std::size_t>(internal::solvePixelsOfMany(m_pair, static_cast<int>(whole), a, b, points->front().data()));
  if (located == pixels_a.size()) return located;
  // The rest, and what the quick lens inversion cannot do.
  for (std::size_t i = 0; i < points->size(); ++i) {
    if (i < whole && !std::isnan((*points)[i].x())) continue;
    PairPoint one;
    const bool found = locate(pixels_a[i], pixels_b[i], &one);
    (*points)[i] = found ? one.xyz : Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    located += found ? 1 : 0;
  }
  return located;
}

internal::PairAnswer PairTriangulator::solveThoroughly(const Vector2d& pixel_a, const Vector2d& pixel_b,
                                                       internal::PairSolution* solution) const {
  Vector2d na, nb;
  internal::Distorted at_a, at_b;
  if (!internal::undistortPixel(m_camera_a, m_pair.max_radius2[0], pixel_a, &na, &at_a) ||
      !internal::undistortPixel(m_camera_b, m_pair.max_radius2[1], pixel_b, &nb, &at_b)) {
    return internal::PairAnswer::kRefused;
  }
  const double x[2] = {na.x(), nb.x()}, y[2] = {na.y(), nb.y()};
  const double xx[2] = {at_a.xx, at_b.xx}, xy[2] = {at_a.xy, at_b.xy}, yy[2] = {at_a.yy, at_b.yy};
  return internal::solveRays(m_pair, x, y, xx, xy, yy, solution);
}

}  // namespace longarm::vision
