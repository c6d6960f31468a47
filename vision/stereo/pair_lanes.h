#pragma once

/// @file
/// The arithmetic from many pairs of clicks to 3-D points, N pairs at a time.  Internal to pair_kernel: the files
/// that include it say for which processor it is compiled.

#include <cstring>
#include <limits>

#include "vision/stereo/pair_lens.h"

namespace longarm::vision::internal::pair_lanes {

// The clicks are moved by the least weighted amount that makes their rays meet to first order (Sampson's correction,
// from the pixels through both lenses), then the middle of what is left between the rays is taken: within second
// order of the noise the maximum-likelihood point, as the Gauss-Newton step of one pair is.
template <typename T>
struct Shift {
  T by_u, by_v;   // how the coplanarity of the rays changes with the pixel, in pixels of unit noise
};
template <typename T>
LONGARM_INLINE Shift<T> shiftOf(const CameraPair& c, int k, const pair_lens::Ideal<T>& at, const T& inverse, const T& e_x, const T& e_y) {
  const T a = (at.d_yy * e_x - at.d_xy * e_y) * inverse, b = (at.d_xx * e_y - at.d_xy * e_x) * inverse;
  return {a * c.noise_x[k], b * c.noise_y[k] - a * c.noise_skew[k]};
}
template <typename T>
LONGARM_INLINE void move(const CameraPair& c, int k, const Shift<T>& shift, const T& by, const T& inverse, pair_lens::Ideal<T>* at) {
  const T scale = by * inverse;
  const T dv = shift.by_v * c.noise_y[k], du = shift.by_u * c.noise_x[k] - shift.by_v * c.noise_skew[k];
  at->x += (at->d_yy * du - at->d_xy * dv) * scale;
  at->y += (at->d_xx * dv - at->d_xy * du) * scale;
}

template <typename Lanes>
constexpr int kLanesOf = sizeof(Lanes) / sizeof(double);

// Pixels come as u v u v ..., and are taken apart on the way in.
template <typename Lanes>
struct Pixels {
  Lanes u, v;
};
template <typename Lanes>
LONGARM_INLINE Pixels<Lanes> load(const double* from) {
  Lanes first, second;
  std::memcpy(&first, from, sizeof first);
  std::memcpy(&second, from + kLanesOf<Lanes>, sizeof second);
  typedef decltype(first < second) Order;
  Order even, odd;
  for (int i = 0; i < kLanesOf<Lanes>; ++i) {
    even[i] = 2 * i;
    odd[i] = 2 * i + 1;
  }
  return {__builtin_shuffle(first, second, even), __builtin_shuffle(first, second, odd)};
}

// Points leave as x y z x y z ...
template <typename Lanes>
LONGARM_INLINE void store(const Lanes place[3], double* to) {
  constexpr int kLanes = kLanesOf<Lanes>;
  double apart[3][kLanes];
  std::memcpy(apart, place, sizeof apart);
  for (int j = 0; j < kLanes; ++j) {
    to[3 * j] = apart[0][j];
    to[3 * j + 1] = apart[1][j];
    to[3 * j + 2] = apart[2][j];
  }
}

// n is a multiple of the lanes.  All in the first camera's frame until the end.  How many were located.
template <typename Lanes>
LONGARM_INLINE int solveMany(const CameraPair& c, int n, const double* pixels_a, const double* pixels_b, double* points) {
  constexpr int kLanes = kLanesOf<Lanes>;
  const auto& R = c.rotation;
  const double* t = c.shift;
  decltype(Lanes{} < Lanes{}) count{};
  for (int i = 0; i < n; i += kLanes) {
    const auto in_a = load<Lanes>(pixels_a + 2 * i), in_b = load<Lanes>(pixels_b + 2 * i);
    pair_lens::Ideal<Lanes> a, b;
    const auto guess_a = pair_lens::guess(c, 0, in_a.u, in_a.v, &a), guess_b = pair_lens::guess(c, 1, in_b.u, in_b.v, &b);
    const auto off_a = pair_lens::differ(c, 0, guess_a, &a), off_b = pair_lens::differ(c, 1, guess_b, &b);
    const Lanes determinant_a = pair_lens::determinant(a), determinant_b = pair_lens::determinant(b);
    const Lanes both = 1 / (determinant_a * determinant_b);
    const Lanes inverse_a = determinant_b * both, inverse_b = determinant_a * both;
    pair_lens::step(off_a, inverse_a, &a);
    pair_lens::step(off_b, inverse_b, &b);
    auto good = pair_lens::settled(c, 0, Lanes(off_a.x * off_a.x + off_a.y * off_a.y), a, pair_lens::kNearlySettled2) &
                pair_lens::settled(c, 1, Lanes(off_b.x * off_b.x + off_b.y * off_b.y), b, pair_lens::kNearlySettled2);
    // coplanarity e = va . (t x vb) and its change with both rays
    Lanes bx = R[0][0] * b.x + R[0][1] * b.y + R[0][2], by = R[1][0] * b.x + R[1][1] * b.y + R[1][2], bz = R[2][0] * b.x + R[2][1] * b.y + R[2][2];
    const Lanes nx = t[1] * bz - t[2] * by, ny = t[2] * bx - t[0] * bz, nz = t[0] * by - t[1] * bx;
    const Lanes mx = a.y * t[2] - t[1], my = t[0] - a.x * t[2], mz = a.x * t[1] - a.y * t[0];
    const Shift<Lanes> shift_a = shiftOf(c, 0, a, inverse_a, nx, ny);
    const Shift<Lanes> shift_b = shiftOf<Lanes>(c, 1, b, inverse_b, mx * R[0][0] + my * R[1][0] + mz * R[2][0], mx * R[0][1] + my * R[1][1] + mz * R[2][1]);
    const Lanes e = a.x * nx + a.y * ny + nz;
    const Lanes push = -e / (shift_a.by_u * shift_a.by_u + shift_a.by_v * shift_a.by_v + shift_b.by_u * shift_b.by_u + shift_b.by_v * shift_b.by_v);
    move(c, 0, shift_a, push, inverse_a, &a);
    move(c, 1, shift_b, push, inverse_b, &b);
    bx = R[0][0] * b.x + R[0][1] * b.y + R[0][2];
    by = R[1][0] * b.x + R[1][1] * b.y + R[1][2];
    bz = R[2][0] * b.x + R[2][1] * b.y + R[2][2];
    const Lanes aa = a.x * a.x + a.y * a.y + 1, bb = bx * bx + by * by + bz * bz, ab = a.x * bx + a.y * by + bz;
    const Lanes ta = a.x * t[0] + a.y * t[1] + t[2], tb = bx * t[0] + by * t[1] + bz * t[2];
    const Lanes sine2 = aa * bb - ab * ab;
    const Lanes half = 0.5 / sine2;
    const Lanes ka = (bb * ta - ab * tb) * half, kb = (ab * ta - aa * tb) * half;
    const Lanes x = ka * a.x + kb * bx + 0.5 * t[0], y = ka * a.y + kb * by + 0.5 * t[1], z = ka + kb * bz + 0.5 * t[2];
    good &= (sine2 >= c.min_sine2 * aa * bb) & (sine2 > 0) & (ka > 0) & (kb > 0) & (z > 1e-9);
    good &= R[0][2] * (x - t[0]) + R[1][2] * (y - t[1]) + R[2][2] * (z - t[2]) > 1e-9;
    Lanes place[3];
    for (int k = 0; k < 3; ++k) {
      place[k] = c.axis_x[0][k] * x + c.axis_y[0][k] * y + c.axis_z[0][k] * z + c.centre[k];
      place[k] = good ? place[k] : Lanes{} + std::numeric_limits<double>::quiet_NaN();
    }
    count += good;
    store(place, points + 3 * i);
  }
  long located = 0;
  for (int j = 0; j < kLanes; ++j) located -= count[j];   // a mask's "true" is -1
  return static_cast<int>(located);
}

}  // namespace longarm::vision::internal::pair_lanes
