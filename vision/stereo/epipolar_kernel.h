#pragma once

/// @file
/// The inner loop of epipolar curves: plain arrays, vectorised for the processor it runs on.

namespace longarm::vision::internal {

/// A camera as the loop needs it.
struct LoopCamera {
  double fx, fy, skew, cx, cy;
  double k1, k2, p1, p2, k3;
};

/// For inverse depths w[i] projects a + w[i] * t: pixel (u, v), depth / (1 / w) as z, squared radius r2.
/// z <= 0 means behind; u, v and r2 are then meaningless.  @pre the arrays do not overlap.
void projectAlongRay(const LoopCamera& camera, const double a[3], const double t[3], const double* w, int n, double* u,
                     double* v, double* z, double* r2);

}  // namespace longarm::vision::internal
