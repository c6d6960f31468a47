#include "vision/stereo/pair_kernel.h"

#include <cmath>

#include "vision/stereo/processor_clones.h"

namespace longarm::vision::internal {
namespace {

#define LONGARM_INLINE inline __attribute__((always_inline))

struct Vec {
  double x, y, z;
};
LONGARM_INLINE Vec vec(const double v[3]) { return {v[0], v[1], v[2]}; }
LONGARM_INLINE Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
LONGARM_INLINE Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
LONGARM_INLINE Vec operator*(double s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
LONGARM_INLINE double dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
LONGARM_INLINE Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Sum of J^T W J and J^T W r over the views.
struct Normal {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec g{0, 0, 0};
};

// Adds view k for a point q seen from its centre.  The pixel's noise is carried to ideal coordinates by the
// lens' derivative; the rows of J = d(x, y) / dq are (axis_x - x axis_z) / z and (axis_y - y axis_z) / z.
LONGARM_INLINE bool addView(const CameraPair& c, int k, const Vec& q, double x, double y, double d_xx, double d_xy,
                            double d_yy, Normal* n) {
  const Vec ax = vec(c.axis_x[k]), ay = vec(c.axis_y[k]), az = vec(c.axis_z[k]);
  const double z = dot(az, q);
  const double iz = 1 / z;
  const double at_x = dot(ax, q) * iz, at_y = dot(ay, q) * iz;
  const Vec j1 = iz * (ax - at_x * az), j2 = iz * (ay - at_y * az);
  const double m11 = c.fx[k] * d_xx + c.skew[k] * d_xy, m12 = c.fx[k] * d_xy + c.skew[k] * d_yy;
  const double m21 = c.fy[k] * d_xy, m22 = c.fy[k] * d_yy;
  const double w11 = c.weight[k] * (m11 * m11 + m21 * m21), w12 = c.weight[k] * (m11 * m12 + m21 * m22);
  const double w22 = c.weight[k] * (m12 * m12 + m22 * m22);
  const Vec a = w11 * j1 + w12 * j2, b = w12 * j1 + w22 * j2;
  n->xx += j1.x * a.x + j2.x * b.x;
  n->xy += j1.x * a.y + j2.x * b.y;
  n->xz += j1.x * a.z + j2.x * b.z;
  n->yy += j1.y * a.y + j2.y * b.y;
  n->yz += j1.y * a.z + j2.y * b.z;
  n->zz += j1.z * a.z + j2.z * b.z;
  n->g = n->g + (x - at_x) * a + (y - at_y) * b;
  return z > 1e-9;
}

// The middle of the common perpendicular, then one Gauss-Newton step: what is left is second order in the
// noise, a thousandth of a sigma.
LONGARM_INLINE PairAnswer solve(const CameraPair& c, const double x[2], const double y[2], const double d_xx[2],
                                const double d_xy[2], const double d_yy[2], PairSolution* out) {
  const Vec va = x[0] * vec(c.axis_x[0]) + y[0] * vec(c.axis_y[0]) + vec(c.axis_z[0]);
  const Vec vb = x[1] * vec(c.axis_x[1]) + y[1] * vec(c.axis_y[1]) + vec(c.axis_z[1]);
  const Vec t = vec(c.baseline);
  const double aa = dot(va, va), bb = dot(vb, vb), ab = dot(va, vb), ta = dot(va, t), tb = dot(vb, t);
  const Vec normal = cross(va, vb);
  const double sine2 = dot(normal, normal);
  if (!(sine2 >= c.min_sine2 * aa * bb) || !(sine2 > 0)) return PairAnswer::kRefused;
  const double inverse = 1 / sine2;
  const double ka = (bb * ta - ab * tb) * inverse, kb = (ab * ta - aa * tb) * inverse;
  if (!(ka > 0 && kb > 0)) return PairAnswer::kRefused;
  const Vec p = 0.5 * (ka * va + t + kb * vb);
  Normal n;
  const bool before_a = addView(c, 0, p, x[0], y[0], d_xx[0], d_xy[0], d_yy[0], &n);
  const bool before_b = addView(c, 1, p - t, x[1], y[1], d_xx[1], d_xy[1], d_yy[1], &n);
  if (!(before_a && before_b)) return PairAnswer::kRefused;
  const double cxx = n.yy * n.zz - n.yz * n.yz, cxy = n.xz * n.yz - n.xy * n.zz, cxz = n.xy * n.yz - n.xz * n.yy;
  const double cyy = n.xx * n.zz - n.xz * n.xz, cyz = n.xy * n.xz - n.xx * n.yz, czz = n.xx * n.yy - n.xy * n.xy;
  const double scale = 1 / (n.xx * cxx + n.xy * cxy + n.xz * cxz);
  out->xx = scale * cxx;
  out->xy = scale * cxy;
  out->xz = scale * cxz;
  out->yy = scale * cyy;
  out->yz = scale * cyz;
  out->zz = scale * czz;
  const Vec q = p + Vec{out->xx * n.g.x + out->xy * n.g.y + out->xz * n.g.z,
                        out->xy * n.g.x + out->yy * n.g.y + out->yz * n.g.z,
                        out->xz * n.g.x + out->yz * n.g.y + out->zz * n.g.z};
  if (!(dot(vec(c.axis_z[0]), q) > 1e-9 && dot(vec(c.axis_z[1]), q - t) > 1e-9)) return PairAnswer::kRefused;
  out->p[0] = q.x;
  out->p[1] = q.y;
  out->p[2] = q.z;
  out->sine = std::sqrt(sine2);
  out->cosine = std::fabs(ab);
  out->gap = std::fabs(dot(t, normal)) / out->sine;
  return PairAnswer::kLocated;
}

}  // namespace

LONGARM_PROCESSOR_CLONES
PairAnswer solveRays(const CameraPair& c, const double x[2], const double y[2], const double d_xx[2],
                     const double d_xy[2], const double d_yy[2], PairSolution* out) {
  return solve(c, x, y, d_xx, d_xy, d_yy, out);
}

// Both lenses are inverted in step: the radial series, then two rounds of Newton without a branch.
LONGARM_PROCESSOR_CLONES
PairAnswer solvePixels(const CameraPair& c, const double u[2], const double v[2], PairSolution* out) {
  double tx[2], ty[2], x[2], y[2], d_xx[2], d_xy[2], d_yy[2], error2[2];
  for (int k = 0; k < 2; ++k) {
    ty[k] = (v[k] - c.cy[k]) * c.inverse_fy[k];
    tx[k] = (u[k] - c.cx[k] - c.skew[k] * ty[k]) * c.inverse_fx[k];
    const double r2 = tx[k] * tx[k] + ty[k] * ty[k];
    const double g = 1 + r2 * (c.s1[k] + r2 * (c.s2[k] + r2 * c.s3[k]));
    x[k] = tx[k] * g;
    y[k] = ty[k] * g;
  }
  for (int round = 0; round < 2; ++round) {
    for (int k = 0; k < 2; ++k) {
      const double xx = x[k] * x[k], yy = y[k] * y[k], xy2 = 2 * x[k] * y[k], r2 = xx + yy;
      const double g = 1 + r2 * (c.k1[k] + r2 * (c.k2[k] + r2 * c.k3[k]));
      const double slope = 2 * (c.k1[k] + r2 * (2 * c.k2[k] + 3 * r2 * c.k3[k]));
      const double ex = tx[k] - (x[k] * g + c.p1[k] * xy2 + c.p2[k] * (r2 + 2 * xx));
      const double ey = ty[k] - (y[k] * g + c.p1[k] * (r2 + 2 * yy) + c.p2[k] * xy2);
      d_xx[k] = g + xx * slope + 2 * c.p1[k] * y[k] + 6 * c.p2[k] * x[k];
      d_xy[k] = 0.5 * xy2 * slope + 2 * c.p1[k] * x[k] + 2 * c.p2[k] * y[k];
      d_yy[k] = g + yy * slope + 6 * c.p1[k] * y[k] + 2 * c.p2[k] * x[k];
      const double determinant = 1 / (d_xx[k] * d_yy[k] - d_xy[k] * d_xy[k]);
      error2[k] = ex * ex + ey * ey;
      x[k] += (d_yy[k] * ex - d_xy[k] * ey) * determinant;
      y[k] += (d_xx[k] * ey - d_xy[k] * ex) * determinant;
    }
  }
  // An error of 6e-7 before the last step is one of about 1e-13 after it, and the derivative is good to 1e-6.
  for (int k = 0; k < 2; ++k) {
    if (!(error2[k] < 4e-13 && x[k] * x[k] + y[k] * y[k] <= c.max_radius2[k])) return PairAnswer::kLensUnsettled;
  }
  return solve(c, x, y, d_xx, d_xy, d_yy, out);
}

}  // namespace longarm::vision::internal
