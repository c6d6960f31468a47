#include "calibration/pose/rotation_descent.h"

#include "calibration/pose/rotation_descent_lanes.h"
#include "core/processor.h"

namespace longarm::calibration::internal {

void descendAvx2(const RotationCost& cost, Rotations* rotations);
void descendAvx512(const RotationCost& cost, Rotations* rotations);

namespace {

typedef double Two __attribute__((vector_size(16)));

void descendAnywhere(const RotationCost& cost, Rotations* rotations) { descendLanes<Two>(cost, rotations); }

}  // namespace

void descendTogether(const RotationCost& cost, Rotations* rotations) {
#ifdef LONGARM_WIDE_LANES
  static const auto descend = widestOf(descendAnywhere, descendAvx2, descendAvx512);
#else
  static const auto descend = descendAnywhere;
#endif
  descend(cost, rotations);
}

}  // namespace longarm::calibration::internal
