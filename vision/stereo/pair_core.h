#pragma once

/// @file
/// The arithmetic behind pair_kernel for one pair.  Internal to the kernel.

#include <cmath>

#include "vision/stereo/pair_lens.h"

namespace longarm::vision::internal::pair_core {

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

using Ideal = pair_lens::Ideal<double>;

// Sum of J^T W J and J^T W r over the views.
struct Normal {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec g{0, 0, 0};
};

// Adds view k for a point q seen from its centre.  The pixel's noise is carried to ideal coordinates by the
// lens' derivative; the rows of J = d(x, y) / dq are (axis_x - x axis_z) / z and (axis_y - y axis_z) / z.
LONGARM_INLINE bool addView(const CameraPair& c, int k, const Vec& q, const Ideal& at, Normal* n) {
  const Vec ax = vec(c.axis_x[k]), ay = vec(c.axis_y[k]), az = vec(c.axis_z[k]);
  const double z = dot(az, q);
  const double iz = 1 / z;
  const double at_x = dot(ax, q) * iz, at_y = dot(ay, q) * iz;
  const Vec j1 = iz * (ax - at_x * az), j2 = iz * (ay - at_y * az);
  const double m11 = c.fx[k] * at.d_xx + c.skew[k] * at.d_xy, m12 = c.fx[k] * at.d_xy + c.skew[k] * at.d_yy;
  const double m21 = c.fy[k] * at.d_xy, m22 = c.fy[k] * at.d_yy;
  const double w11 = c.weight[k] * (m11 * m11 + m21 * m21), w12 = c.weight[k] * (m11 * m12 + m21 * m22);
  const double w22 = c.weight[k] * (m12 * m12 + m22 * m22);
  const Vec a = w11 * j1 + w12 * j2, b = w12 * j1 + w22 * j2;
  n->xx += j1.x * a.x + j2.x * b.x;
  n->xy += j1.x * a.y + j2.x * b.y;
  n->xz += j1.x * a.z + j2.x * b.z;
  n->yy += j1.y * a.y + j2.y * b.y;
  n->yz += j1.y * a.z + j2.y * b.z;
  n->zz += j1.z * a.z + j2.z * b.z;
  n->g = n->g + (at.x - at_x) * a + (at.y - at_y) * b;
  return z > 1e-9;
}

// The middle of the common perpendicular, then one Gauss-Newton step: what is left is second order in the
// noise, a thousandth of a sigma.  @returns false where it is refused.
LONGARM_INLINE bool solve(const CameraPair& c, const Ideal& a, const Ideal& b, PairSolution* out) {
  const Vec va = a.x * vec(c.axis_x[0]) + a.y * vec(c.axis_y[0]) + vec(c.axis_z[0]);
  const Vec vb = b.x * vec(c.axis_x[1]) + b.y * vec(c.axis_y[1]) + vec(c.axis_z[1]);
  const Vec t = vec(c.baseline);
  const double aa = dot(va, va), bb = dot(vb, vb), ab = dot(va, vb), ta = dot(va, t), tb = dot(vb, t);
  const Vec normal = cross(va, vb);
  const double sine2 = dot(normal, normal);
  const double inverse = 1 / sine2;
  const double ka = (bb * ta - ab * tb) * inverse, kb = (ab * ta - aa * tb) * inverse;
  const Vec p = 0.5 * (ka * va + t + kb * vb);
  Normal n;
  const bool before_a = addView(c, 0, p, a, &n), before_b = addView(c, 1, p - t, b, &n);
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
  out->p[0] = q.x;
  out->p[1] = q.y;
  out->p[2] = q.z;
  out->sine = std::sqrt(sine2);
  out->cosine = std::fabs(ab);
  out->gap = std::fabs(dot(t, normal)) / out->sine;
  const bool wide = (sine2 >= c.min_sine2 * aa * bb) & (sine2 > 0), ahead = (ka > 0) & (kb > 0);
  const bool seen = (dot(vec(c.axis_z[0]), q) > 1e-9) & (dot(vec(c.axis_z[1]), q - t) > 1e-9);
  return wide & ahead & before_a & before_b & seen;
}

}  // namespace longarm::vision::internal::pair_core
