#include "vision/stereo/pair_many.h"

#ifdef LONGARM_WIDE_LANES
#include <cstring>
#include <limits>

// After the headers whose functions others share.
#pragma GCC target("arch=x86-64-v4")
#include "vision/stereo/pair_lanes.h"

namespace longarm::vision::internal {

int solveManyAvx512(const CameraPair& c, int n, const double* pixels_a, const double* pixels_b, double* points) {
  typedef double Lanes __attribute__((vector_size(64)));
  return pair_lanes::solveMany<Lanes>(c, n, pixels_a, pixels_b, points);
}

}  // namespace longarm::vision::internal
#endif
