#include "vision/stereo/pair_many.h"

#include "vision/stereo/pair_lanes.h"

namespace longarm::vision::internal {
namespace {

typedef double Two __attribute__((vector_size(16)));

int solveManyAnywhere(const CameraPair& c, int n, const double* pixels_a, const double* pixels_b, double* points) {
  return pair_lanes::solveMany<Two>(c, n, pixels_a, pixels_b, points);
}

auto widest() {
#ifdef LONGARM_WIDE_LANES
  if (processorLanes() == ProcessorLanes::kEight) return solveManyAvx512;
  if (processorLanes() == ProcessorLanes::kFour) return solveManyAvx2;
#endif
  return solveManyAnywhere;
}

}  // namespace

int solvePixelsOfMany(const CameraPair& pair, int n, const double* pixels_a, const double* pixels_b, double* points) {
  static const auto solve = widest();
  return solve(pair, n, pixels_a, pixels_b, points);
}

}  // namespace longarm::vision::internal
