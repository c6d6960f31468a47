#include "vision/stereo/epipolar_kernel.h"

// The loader picks the widest version; not under sanitizers, whose run time is not ready when it asks.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define LONGARM_LOOP_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), optimize("O3")))
#else
#define LONGARM_LOOP_CLONES
#endif

namespace longarm::vision::internal {

LONGARM_LOOP_CLONES
void projectAlongRay(const LoopCamera& camera, const double a[3], const double t[3], const double* __restrict w, int n,
                     double* __restrict u, double* __restrict v, double* __restrict z, double* __restrict r2) {
  const LoopCamera c = camera;
  const double ax = a[0], ay = a[1], az = a[2], tx = t[0], ty = t[1], tz = t[2];
  for (int i = 0; i < n; ++i) {
    const double depth = az + w[i] * tz;
    const double inverse = 1 / depth;
    const double x = (ax + w[i] * tx) * inverse;
    const double y = (ay + w[i] * ty) * inverse;
    const double xx = x * x, yy = y * y, xy2 = 2 * x * y;
    const double r = xx + yy;
    const double g = 1 + r * (c.k1 + r * (c.k2 + r * c.k3));
    const double xd = x * g + c.p1 * xy2 + c.p2 * (r + 2 * xx);
    const double yd = y * g + c.p1 * (r + 2 * yy) + c.p2 * xy2;
    u[i] = c.fx * xd + c.skew * yd + c.cx;
    v[i] = c.fy * yd + c.cy;
    z[i] = depth;
    r2[i] = r;
  }
}

}  // namespace longarm::vision::internal
