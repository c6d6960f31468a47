#include "vision/stereo/pair_triangulator.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/require.h"
#include "vision/camera/lens.h"

namespace longarm::vision {
namespace {

using Eigen::Vector2d;

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
  // Reversion of r + k1 r^3 + k2 r^5 + k3 r^7.
  pair->s1[k] = -d[0];
  pair->s2[k] = 3 * d[0] * d[0] - d[1];
  pair->s3[k] = -12 * d[0] * d[0] * d[0] + 8 * d[0] * d[1] - d[4];
  pair->max_radius2[k] = internal::monotoneRadius2(camera);
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
  for (int i = 0; i < 3; ++i) m_pair.baseline[i] = baseline[i];
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
  constexpr std::size_t kBlock = 256;        // its arrays stay in the nearest cache
  double in[4][kBlock], out[4][kBlock];
  points->resize(pixels_a.size());
  std::size_t located = 0;
  for (std::size_t first = 0; first < pixels_a.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, pixels_a.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      in[0][i] = pixels_a[first + i].x();
      in[1][i] = pixels_a[first + i].y();
      in[2][i] = pixels_b[first + i].x();
      in[3][i] = pixels_b[first + i].y();
    }
    internal::solvePixelsOfMany(m_pair, static_cast<int>(count), {in[0], in[1], in[2], in[3]}, {out[0], out[1], out[2], out[3]});
    for (std::size_t i = 0; i < count; ++i) {
      Eigen::Vector3d& point = (*points)[first + i];
      point = m_p_WA + Eigen::Vector3d(out[0][i], out[1][i], out[2][i]);
      PairPoint thorough;
      // What the quick lens inversion cannot do may still have an answer.
      if (out[3][i] == 0 && locate(pixels_a[first + i], pixels_b[first + i], &thorough)) point = thorough.xyz;
      else if (out[3][i] == 0) point.setConstant(std::numeric_limits<double>::quiet_NaN());
      located += std::isnan(point.x()) ? 0 : 1;
    }
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
