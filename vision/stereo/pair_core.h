#pragma once

/// @file
/// The arithmetic behind pair_kernel, inlined into the loops over one pair and over many.  Internal to the kernel.
///
/// Without a branch, so that a compiler can work at several pairs at once: what is refused is computed all the same.

#include <cmath>

#include "vision/stereo/pair_kernel.h"

namespace longarm::vision::internal::pair_core {

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

// Ideal coordinates of a pixel, and the lens' derivative there.
struct Ideal {
  double x, y, d_xx, d_xy, d_yy;
};

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

// Ideal coordinates before the lens, and a first guess of those behind it by the radial series.
struct Guess {
  double tx, ty;
};
LONGARM_INLINE Guess guess(const CameraPair& c, int k, double u, double v, Ideal* at) {
  Guess g{};
  g.ty = (v - c.cy[k]) * c.inverse_fy[k];
  g.tx = (u - c.cx[k] - c.skew[k] * g.ty) * c.inverse_fx[k];
  const double r2 = g.tx * g.tx + g.ty * g.ty;
  const double scale = 1 + r2 * (c.s1[k] + r2 * (c.s2[k] + r2 * c.s3[k]));
  at->x = g.tx * scale;
  at->y = g.ty * scale;
  return g;
}

// One round of Newton; @returns the squared error before it.
LONGARM_INLINE double refine(const CameraPair& c, int k, const Guess& g, Ideal* at) {
  const double xx = at->x * at->x, yy = at->y * at->y, xy2 = 2 * at->x * at->y, r2 = xx + yy;
  const double radial = 1 + r2 * (c.k1[k] + r2 * (c.k2[k] + r2 * c.k3[k]));
  const double slope = 2 * (c.k1[k] + r2 * (2 * c.k2[k] + 3 * r2 * c.k3[k]));
  const double ex = g.tx - (at->x * radial + c.p1[k] * xy2 + c.p2[k] * (r2 + 2 * xx));
  const double ey = g.ty - (at->y * radial + c.p1[k] * (r2 + 2 * yy) + c.p2[k] * xy2);
  at->d_xx = radial + xx * slope + 2 * c.p1[k] * at->y + 6 * c.p2[k] * at->x;
  at->d_xy = 0.5 * xy2 * slope + 2 * c.p1[k] * at->x + 2 * c.p2[k] * at->y;
  at->d_yy = radial + yy * slope + 6 * c.p1[k] * at->y + 2 * c.p2[k] * at->x;
  const double determinant = 1 / (at->d_xx * at->d_yy - at->d_xy * at->d_xy);
  at->x += (at->d_yy * ex - at->d_xy * ey) * determinant;
  at->y += (at->d_xx * ey - at->d_xy * ex) * determinant;
  return ex * ex + ey * ey;
}

// An error of 6e-7 before the last step is one of about 1e-13 after it, and the derivative is good to 1e-6.
LONGARM_INLINE bool settled(const CameraPair& c, int k, double error2, const Ideal& at) {
  return (error2 < 4e-13) & (at.x * at.x + at.y * at.y <= c.max_radius2[k]);
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
