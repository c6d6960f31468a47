#pragma once

/// @file
/// Both lenses of a pair inverted without a branch: a polynomial, then Newton.  Internal to pair_kernel.
///
/// T is double, or a vector of doubles that holds as many pixels; what a comparison says comes back as T's mask.

#include "core/processor.h"
#include "vision/stereo/pair_kernel.h"

namespace longarm::vision::internal::pair_lens {

// Ideal coordinates of a pixel, and the lens' derivative there.
template <typename T>
struct Ideal {
  T x, y, d_xx, d_xy, d_yy;
};

// Ideal coordinates before the lens, and a first guess of those behind it: the radial part inverted by a polynomial.
template <typename T>
struct Guess {
  T tx, ty;
};
template <typename T>
LONGARM_INLINE Guess<T> guess(const CameraPair& c, int k, const T& u, const T& v, Ideal<T>* at) {
  Guess<T> g{};
  g.ty = (v - c.cy[k]) * c.inverse_fy[k];
  g.tx = (u - c.cx[k] - c.skew[k] * g.ty) * c.inverse_fx[k];
  const T rr = g.tx * g.tx + g.ty * g.ty;
  const double* s = c.inverse_radial[k];
  const T scale = 1 + rr * (s[0] + rr * (s[1] + rr * (s[2] + rr * (s[3] + rr * (s[4] + rr * s[5])))));
  at->x = g.tx * scale;
  at->y = g.ty * scale;
  return g;
}

// How far off the lens at an ideal point is from where it should be.
template <typename T>
struct Off {
  T x, y;
};

// The lens' derivative at the point too.
template <typename T>
LONGARM_INLINE Off<T> differ(const CameraPair& c, int k, const Guess<T>& g, Ideal<T>* at) {
  const T xx = at->x * at->x, yy = at->y * at->y, xy2 = 2 * at->x * at->y, r2 = xx + yy;
  const T radial = 1 + r2 * (c.k1[k] + r2 * (c.k2[k] + r2 * c.k3[k]));
  const T slope = 2 * (c.k1[k] + r2 * (2 * c.k2[k] + 3 * r2 * c.k3[k]));
  at->d_xx = radial + xx * slope + 2 * c.p1[k] * at->y + 6 * c.p2[k] * at->x;
  at->d_xy = 0.5 * xy2 * slope + 2 * c.p1[k] * at->x + 2 * c.p2[k] * at->y;
  at->d_yy = radial + yy * slope + 6 * c.p1[k] * at->y + 2 * c.p2[k] * at->x;
  return {g.tx - (at->x * radial + c.p1[k] * xy2 + c.p2[k] * (r2 + 2 * xx)),
          g.ty - (at->y * radial + c.p1[k] * (r2 + 2 * yy) + c.p2[k] * xy2)};
}

template <typename T>
LONGARM_INLINE T determinant(const Ideal<T>& at) {
  return at.d_xx * at.d_yy - at.d_xy * at.d_xy;
}

template <typename T>
LONGARM_INLINE void step(const Off<T>& off, const T& inverse, Ideal<T>* at) {
  at->x += (at->d_yy * off.x - at->d_xy * off.y) * inverse;
  at->y += (at->d_xx * off.y - at->d_xy * off.x) * inverse;
}

// One round of Newton; the squared error before it.
template <typename T>
LONGARM_INLINE T refine(const CameraPair& c, int k, const Guess<T>& g, Ideal<T>* at) {
  const Off<T> off = differ(c, k, g, at);
  step(off, T(1 / determinant(*at)), at);
  return off.x * off.x + off.y * off.y;
}

// An error before the last step of 6e-7 is one of about 1e-13 after it, of 1e-3 about 5e-7: less than a thousandth of
// a pixel.
constexpr double kSettled2 = 4e-13, kNearlySettled2 = 1e-6;
template <typename T>
LONGARM_INLINE auto settled(const CameraPair& c, int k, const T& error2, const Ideal<T>& at, double limit2 = kSettled2) {
  return (error2 < limit2) & (at.x * at.x + at.y * at.y <= c.max_radius2[k]);
}

}  // namespace longarm::vision::internal::pair_lens
