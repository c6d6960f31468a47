#pragma once

/// @file
/// Many descents on the rotations at once.

namespace longarm::calibration::internal {

/// Descents side by side: one from each rotation of the cube.
constexpr int kDescents = 24;

/// r^T M r + 2 g^T r over the column-wise entries r of a rotation; M symmetric, positive semidefinite.
struct RotationCost {
  double M[9][9], g[9];
};

/// Starts, and where they came to rest: entry i of descent k is R[i][k], column-wise.
struct Rotations {
  alignas(64) double R[9][kDescents];
};

/// Levenberg and Marquardt's descent from each start until the next turn is below 1e-3 rad, or 40 rounds.
/// Pure function; as many descents at once as the processor holds.
void descendTogether(const RotationCost& cost, Rotations* rotations);

}  // namespace longarm::calibration::internal
