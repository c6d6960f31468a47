#include "vision/stereo/pair_many.h"

#include "vision/stereo/pair_lanes.h"

namespace longarm::vision::internal {
namespace {

typedef double Two __attribute__((vector_size(16)));

int solveManyAnywhere(const CameraPair& c, int n, const double* pixels_a, const double* pixels_b, double* points) {
  return pair_lanes::solveMany<Two>(c, n, pixels_a, pixels_b, points);
}

}  // namespace

int solvePixelsOfMany(const CameraPair& pair, int n, const double* pixels_a, const double* pixels_b, double* points) {
#ifdef LONGARM_WIDE_LANES
  static const auto solve = widestOf(solveManyAnywhere, solveManyAvx2, solveManyAvx512);
#else
  static const auto solve = solveManyAnywhere;
#endif
  return solve(pair, n, pixels_a, pixels_b, points);
}

}  // namespace longarm::vision::internal
