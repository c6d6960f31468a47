#include "vision/stereo/pair_kernel.h"

#include "vision/stereo/pair_core.h"
#include "vision/stereo/processor_clones.h"

namespace longarm::vision::internal {

LONGARM_PROCESSOR_CLONES
PairAnswer solveRays(const CameraPair& c, const double x[2], const double y[2], const double d_xx[2],
                     const double d_xy[2], const double d_yy[2], PairSolution* out) {
  const pair_core::Ideal a{x[0], y[0], d_xx[0], d_xy[0], d_yy[0]}, b{x[1], y[1], d_xx[1], d_xy[1], d_yy[1]};
  return pair_core::solve(c, a, b, out) ? PairAnswer::kLocated : PairAnswer::kRefused;
}

// Both lenses are inverted in step: the radial series, then two rounds of Newton without a branch.
LONGARM_PROCESSOR_CLONES
PairAnswer solvePixels(const CameraPair& c, const double u[2], const double v[2], PairSolution* out) {
  pair_core::Ideal at[2];
  pair_core::Guess guess[2];
  double error2[2];
  for (int k = 0; k < 2; ++k) guess[k] = pair_core::guess(c, k, u[k], v[k], &at[k]);
  for (int k = 0; k < 2; ++k) pair_core::refine(c, k, guess[k], &at[k]);
  for (int k = 0; k < 2; ++k) error2[k] = pair_core::refine(c, k, guess[k], &at[k]);
  if (!(pair_core::settled(c, 0, error2[0], at[0]) && pair_core::settled(c, 1, error2[1], at[1]))) return PairAnswer::kLensUnsettled;
  return pair_core::solve(c, at[0], at[1], out) ? PairAnswer::kLocated : PairAnswer::kRefused;
}

LONGARM_PROCESSOR_CLONES
void solvePixelsOfMany(const CameraPair& c, int n, const PairPixels& in, const PairPlaces& out) {
  const double* __restrict__ ua = in.u_a;
  const double* __restrict__ va = in.v_a;
  const double* __restrict__ ub = in.u_b;
  const double* __restrict__ vb = in.v_b;
  double* __restrict__ px = out.x;
  double* __restrict__ py = out.y;
  double* __restrict__ pz = out.z;
  double* __restrict__ good = out.located;
  for (int i = 0; i < n; ++i) {
    pair_core::Ideal a, b;
    const pair_core::Guess guess_a = pair_core::guess(c, 0, ua[i], va[i], &a), guess_b = pair_core::guess(c, 1, ub[i], vb[i], &b);
    pair_core::refine(c, 0, guess_a, &a);
    pair_core::refine(c, 1, guess_b, &b);
    const double error_a = pair_core::refine(c, 0, guess_a, &a), error_b = pair_core::refine(c, 1, guess_b, &b);
    PairSolution solution;
    const bool solved = pair_core::solve(c, a, b, &solution);
    px[i] = solution.p[0];
    py[i] = solution.p[1];
    pz[i] = solution.p[2];
    good[i] = (pair_core::settled(c, 0, error_a, a) & pair_core::settled(c, 1, error_b, b) & solved) ? 1.0 : 0.0;
  }
}

}  // namespace longarm::vision::internal
