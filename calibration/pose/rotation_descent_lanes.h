#pragma once

/// @file
/// The arithmetic of rotation_descent, as many descents at a time as Lanes holds doubles.  Internal to it: the files
/// that include this say for which processor it is compiled.

#include <cstring>

#include "calibration/pose/rotation_descent.h"
#include "core/processor.h"

namespace longarm::calibration::internal {

// M r, and r^T M r + 2 g^T r.
template <typename Lanes>
LONGARM_INLINE Lanes evaluate(const RotationCost& c, const Lanes r[9], Lanes Mr[9]) {
  Lanes cost{};
  for (int i = 0; i < 9; ++i) {
    Mr[i] = Lanes{};
    for (int j = 0; j < 9; ++j) Mr[i] += c.M[i][j] * r[j];
    cost += r[i] * (Mr[i] + 2 * c.g[i]);
  }
  return cost;
}

// d r / d w for R <- exp(w) R: block a of column k is e_k x column a of R.  Entry (row, k); its third is zero.
template <typename Lanes>
LONGARM_INLINE void turns(const Lanes r[9], Lanes D[3][9]) {
  for (int a = 0; a < 3; ++a) {
    const Lanes x = r[3 * a], y = r[3 * a + 1], z = r[3 * a + 2], none{};
    D[0][3 * a] = none, D[0][3 * a + 1] = -z, D[0][3 * a + 2] = y;
    D[1][3 * a] = z, D[1][3 * a + 1] = none, D[1][3 * a + 2] = -x;
    D[2][3 * a] = -y, D[2][3 * a + 1] = x, D[2][3 * a + 2] = none;
  }
}

// The descent's way from here: -(D^T M D + damping)^-1 D^T (M r + g).
template <typename Lanes>
LONGARM_INLINE void wayDown(const RotationCost& c, const Lanes r[9], const Lanes Mr[9], const Lanes& damping, Lanes w[3]) {
  Lanes D[3][9], H[3][3] = {}, gradient[3] = {};
  turns(r, D);
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 9; ++i) {
      if (i % 3 != k) gradient[k] += D[k][i] * (Mr[i] + c.g[i]);
    }
  }
  for (int k = 0; k < 3; ++k) {
    Lanes MD[9];
    for (int i = 0; i < 9; ++i) {
      MD[i] = Lanes{};
      for (int j = 0; j < 9; ++j) {
        if (j % 3 != k) MD[i] += c.M[i][j] * D[k][j];
      }
    }
    for (int l = 0; l <= k; ++l) {
      for (int i = 0; i < 9; ++i) {
        if (i % 3 != l) H[k][l] += D[l][i] * MD[i];
      }
    }
  }
  const Lanes a = H[0][0] + damping, b = H[1][0], d = H[2][0], e = H[1][1] + damping, f = H[2][1], h = H[2][2] + damping;
  const Lanes A = e * h - f * f, B = d * f - b * h, C = b * f - d * e, E = a * h - d * d, F = b * d - a * f, I = a * e - b * b;
  const Lanes inverse = -1 / (a * A + b * B + d * C);
  w[0] = inverse * (A * gradient[0] + B * gradient[1] + C * gradient[2]);
  w[1] = inverse * (B * gradient[0] + E * gradient[1] + F * gradient[2]);
  w[2] = inverse * (C * gradient[0] + F * gradient[1] + I * gradient[2]);
}

// The rotation by the quaternion (2, w), w to first order, after R.
template <typename Lanes>
LONGARM_INLINE void turn(const Lanes w[3], const Lanes r[9], Lanes out[9]) {
  const Lanes x = 0.5 * w[0], y = 0.5 * w[1], z = 0.5 * w[2];
  const Lanes s = 2 / (1 + x * x + y * y + z * z);
  const Lanes Q[3][3] = {{1 - s * (y * y + z * z), s * (x * y - z), s * (x * z + y)},
                         {s * (x * y + z), 1 - s * (x * x + z * z), s * (y * z - x)},
                         {s * (x * z - y), s * (y * z + x), 1 - s * (x * x + y * y)}};
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < 3; ++i) out[3 * a + i] = Q[i][0] * r[3 * a] + Q[i][1] * r[3 * a + 1] + Q[i][2] * r[3 * a + 2];
  }
}

template <typename Lanes>
LONGARM_INLINE void descendLanes(const RotationCost& c, Rotations* rotations) {
  constexpr int kLanes = sizeof(Lanes) / sizeof(double);
  double scale = 0;
  for (int i = 0; i < 9; ++i) scale += c.M[i][i];
  for (int first = 0; first < kDescents; first += kLanes) {
    Lanes r[9], Mr[9];
    for (int i = 0; i < 9; ++i) std::memcpy(&r[i], &rotations->R[i][first], sizeof(Lanes));
    Lanes cost = evaluate(c, r, Mr), damping = Lanes{} + 1e-6;
    auto moving = cost <= cost;          // all that are numbers
    for (int round = 0; round < 40; ++round) {
      Lanes w[3], trial[9], trial_Mr[9];
      wayDown(c, r, Mr, Lanes(damping * scale), w);
      // No turn is longer than 0.8 rad: from there on they are taken the shorter the wilder they are.
      const Lanes length2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
      const Lanes shorter = length2 > 0.64 ? 1.6 / (0.8 + length2 / 0.8) : Lanes{} + 1;
      for (int k = 0; k < 3; ++k) w[k] *= shorter;
      turn(w, r, trial);
      const Lanes trial_cost = evaluate(c, trial, trial_Mr);
      const auto better = moving & (trial_cost <= cost);
      for (int i = 0; i < 9; ++i) {
        r[i] = better ? trial[i] : r[i];
        Mr[i] = better ? trial_Mr[i] : Mr[i];
      }
      cost = better ? trial_cost : cost;
      const Lanes less = 0.1 * damping, more = 10 * damping;
      damping = better ? (less < 1e-12 ? Lanes{} + 1e-12 : less) : more;
      moving &= ~(better & (length2 < 1e-6)) & (damping <= 1e3);
      long any = 0;
      for (int k = 0; k < kLanes; ++k) any |= moving[k];
      if (any == 0) break;
    }
    for (int i = 0; i < 9; ++i) std::memcpy(&rotations->R[i][first], &r[i], sizeof(Lanes));
  }
}

}  // namespace longarm::calibration::internal
