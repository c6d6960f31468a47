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
  pair_lens::Guess<double> guess[2];
  double error2[2];
  for (int k = 0; k < 2; ++k) guess[k] = pair_lens::guess(c, k, u[k], v[k], &at[k]);
  for (int k = 0; k < 2; ++k) pair_lens::refine(c, k, guess[k], &at[k]);
  for (int k = 0; k < 2; ++k) error2[k] = pair_lens::refine(c, k, guess[k], &at[k]);
  if (!(pair_lens::settled(c, 0, error2[0], at[0]) && pair_lens::settled(c, 1, error2[1], at[1]))) return PairAnswer::kLensUnsettled;
  return pair_core::solve(c, at[0], at[1], out) ? PairAnswer::kLocated : PairAnswer::kRefused;
}

}  // namespace longarm::vision::internal
