#pragma once

/// @file
/// The inner loops of epipolar curves: plain arrays, vectorised for the processor they run on.

namespace longarm::vision::internal {

/// A camera as the loops need it.
struct LoopCamera {
  double fx, fy, skew, cx, cy;
  double k1, k2, p1, p2, k3;
};

/// A ray as the camera sees it, sampled at n inverse depths w = first + i step: p = (a + w t) / w.
struct LoopRay {
  double a[3], t[3];
  double first, step;
};

/// Pixels of the samples.  @pre Every sample is before the camera; u and v do not overlap and hold n.
void projectSamples(const LoopCamera& camera, const LoopRay& ray, int n, double* u, double* v);

/// The same where some may be behind: also z = depth w and the squared radius r2.  z <= 0 means behind; u, v and
/// r2 are then meaningless.  @pre the arrays do not overlap and hold n.
void projectSamplesWithRange(const LoopCamera& camera, const LoopRay& ray, int n, double* u, double* v, double* z,
                             double* r2);

}  // namespace longarm::vision::internal
