#include "core/processor.h"

#ifdef LONGARM_WIDE_LANES
#include <cstring>

// After the headers whose functions others share.
#pragma GCC target("arch=x86-64-v3")
#include "calibration/pose/rotation_descent_lanes.h"

namespace longarm::calibration::internal {

void descendAvx2(const RotationCost& cost, Rotations* rotations) {
  typedef double Lanes __attribute__((vector_size(32)));
  descendLanes<Lanes>(cost, rotations);
}

}  // namespace longarm::calibration::internal
#endif
