#include "vision/stereo/pair_triangulator.h"

#include <cmath>

#include <Eigen/LU>

#include "core/require.h"
#include "vision/camera/lens.h"

namespace longarm::vision {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// (K2 D)^T (K2 D) / sigma^2: the pick's information about normalised coordinates.
Matrix2d informationOf(const CameraModel& camera, const internal::Distorted& at, double weight) {
  const Matrix2d M = internal::pixelByNormalised(camera, at);
  return weight * M.transpose() * M;
}

// Adds one view's J^T W J and J^T W r for a point p in its camera frame, both expressed in that frame.
// J = [1/z 0 -x/z; 0 1/z -y/z] makes J^T W J three numbers, scaled.
inline void accumulate(const Vector3d& p, const Vector2d& n, const Matrix2d& W, Matrix3d* H, Vector3d* g) {
  const double iz = 1 / p.z();
  const double x = p.x() * iz, y = p.y() * iz;
  const double rx = n.x() - x, ry = n.y() - y;
  const double wxx = W(0, 0) * iz * iz, wxy = W(0, 1) * iz * iz, wyy = W(1, 1) * iz * iz;
  const double a = wxx * x + wxy * y, b = wxy * x + wyy * y;
  *H << wxx, wxy, -a, wxy, wyy, -b, -a, -b, a * x + b * y;
  const double ex = (W(0, 0) * rx + W(0, 1) * ry) * iz, ey = (W(0, 1) * rx + W(1, 1) * ry) * iz;
  *g << ex, ey, -(x * ex + y * ey);
}

}  // namespace

PairTriangulator::PairTriangulator(const View& a, const View& b, double refuse_parallax)
    : m_camera_a(a.camera), m_camera_b(b.camera), m_R_WA(a.X_WC.linear()), m_p_WA(a.X_WC.translation()) {
  LONGARM_REQUIRE(a.parent == b.parent, "PairTriangulator: parents " + a.parent + " and " + b.parent);
  m_R_AB = m_R_WA.transpose() * b.X_WC.linear();
  m_p_AB = m_R_WA.transpose() * (b.X_WC.translation() - m_p_WA);
  m_max_radius2_a = internal::monotoneRadius2(m_camera_a);
  m_max_radius2_b = internal::monotoneRadius2(m_camera_b);
  m_weight_a = 1 / (a.sigma_px * a.sigma_px);
  m_weight_b = 1 / (b.sigma_px * b.sigma_px);
  const double sine = std::sin(refuse_parallax);
  m_min_sine2 = sine * sine;
}

bool PairTriangulator::locate(const Vector2d& pixel_a, const Vector2d& pixel_b, PairPoint* point) const {
  Vector2d na, nb;
  internal::Distorted at_a, at_b;
  if (!internal::undistortPixel(m_camera_a, m_max_radius2_a, pixel_a, &na, &at_a) ||
      !internal::undistortPixel(m_camera_b, m_max_radius2_b, pixel_b, &nb, &at_b)) {
    return false;
  }
  // Middle of the common perpendicular, in A.
  const Vector3d va(na.x(), na.y(), 1);
  const Vector3d vb = m_R_AB * Vector3d(nb.x(), nb.y(), 1);
  const double aa = va.squaredNorm(), bb = vb.squaredNorm(), ab = va.dot(vb);
  const double determinant = aa * bb - ab * ab;   // |va x vb|^2
  if (!(determinant >= m_min_sine2 * aa * bb)) return false;
  const double ta = va.dot(m_p_AB), tb = vb.dot(m_p_AB);
  const double ka = (bb * ta - ab * tb) / determinant, kb = (ab * ta - aa * tb) / determinant;
  if (!(ka > 0 && kb > 0)) return false;
  Vector3d p = 0.5 * (ka * va + m_p_AB + kb * vb);
  const double gap = std::abs(m_p_AB.dot(va.cross(vb))) / std::sqrt(determinant);

  const Matrix2d Wa = informationOf(m_camera_a, at_a, m_weight_a);
  const Matrix2d Wb = informationOf(m_camera_b, at_b, m_weight_b);
  Matrix3d Ha, Hb, inverse;
  Vector3d ga, gb;
  for (int i = 0; i < 2; ++i) {
    const Vector3d p_B = m_R_AB.transpose() * (p - m_p_AB);
    if (!(p.z() > 1e-9 && p_B.z() > 1e-9)) return false;
    accumulate(p, na, Wa, &Ha, &ga);
    accumulate(p_B, nb, Wb, &Hb, &gb);
    const Matrix3d H = Ha + m_R_AB * Hb * m_R_AB.transpose();
    inverse = H.inverse();
    p += inverse * (ga + m_R_AB * gb);
  }
  point->xyz = m_p_WA + m_R_WA * p;
  point->covariance = m_R_WA * inverse * m_R_WA.transpose();
  point->miss_m = gap;
  point->parallax = std::atan2(std::sqrt(determinant), std::abs(ab));
  return true;
}

}  // namespace longarm::vision
