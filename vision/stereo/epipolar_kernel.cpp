#include "vision/stereo/epipolar_kernel.h"

#include "vision/stereo/processor_clones.h"

namespace longarm::vision::internal {
namespace {

#define LONGARM_INLINE inline __attribute__((always_inline))

LONGARM_INLINE void distortToPixel(const LoopCamera& c, double x, double y, double* u, double* v, double* r2) {
  const double xx = x * x, yy = y * y, xy2 = 2 * x * y;
  const double r = xx + yy;
  const double g = 1 + r * (c.k1 + r * (c.k2 + r * c.k3));
  const double xd = x * g + c.p1 * xy2 + c.p2 * (r + 2 * xx);
  const double yd = y * g + c.p1 * (r + 2 * yy) + c.p2 * xy2;
  *u = c.fx * xd + c.skew * yd + c.cx;
  *v = c.fy * yd + c.cy;
  *r2 = r;
}

}  // namespace

LONGARM_PROCESSOR_CLONES
void projectSamples(const LoopCamera& camera, const LoopRay& ray, int n, double* __restrict u, double* __restrict v) {
  const LoopCamera c = camera;
  const LoopRay r = ray;
  double unused = 0;
  // Samples i and i + half share one division, the loop's dearest step.
  const int half = n / 2;
  double* __restrict u_far = u + half;
  double* __restrict v_far = v + half;
  for (int i = 0; i < half; ++i) {
    const double w0 = r.first + r.step * i, w1 = r.first + r.step * (i + half);
    const double z0 = r.a[2] + w0 * r.t[2], z1 = r.a[2] + w1 * r.t[2];
    const double inverse = 1 / (z0 * z1);
    const double i0 = inverse * z1, i1 = inverse * z0;
    distortToPixel(c, (r.a[0] + w0 * r.t[0]) * i0, (r.a[1] + w0 * r.t[1]) * i0, &u[i], &v[i], &unused);
    distortToPixel(c, (r.a[0] + w1 * r.t[0]) * i1, (r.a[1] + w1 * r.t[1]) * i1, &u_far[i], &v_far[i], &unused);
  }
  if (n % 2 != 0) {
    const double w = r.first + r.step * (n - 1), inverse = 1 / (r.a[2] + w * r.t[2]);
    distortToPixel(c, (r.a[0] + w * r.t[0]) * inverse, (r.a[1] + w * r.t[1]) * inverse, &u[n - 1], &v[n - 1], &unused);
  }
}

LONGARM_PROCESSOR_CLONES
void projectSamplesWithRange(const LoopCamera& camera, const LoopRay& ray, int n, double* __restrict u,
                             double* __restrict v, double* __restrict z, double* __restrict r2) {
  const LoopCamera c = camera;
  const LoopRay r = ray;
  for (int i = 0; i < n; ++i) {
    const double w = r.first + r.step * i;
    z[i] = r.a[2] + w * r.t[2];
    const double inverse = 1 / z[i];
    distortToPixel(c, (r.a[0] + w * r.t[0]) * inverse, (r.a[1] + w * r.t[1]) * inverse, &u[i], &v[i], &r2[i]);
  }
}

}  // namespace longarm::vision::internal
