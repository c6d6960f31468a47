#include "calibration/pose/rotation_descent.h"

#include "calibration/pose/rotation_descent_lanes.h"
#include "core/processor.h"

namespace longarm::calibration::internal {

void descendAvx2(const RotationCost& cost, Rotations* rotations);
void descendAvx512(const RotationCost& cost, Rotations* rotations);

namespace {

typedef double Two __attribute__((vector_size(16)));

void descendAnywhere(const RotationCost& cost, Rotations* rotations) { descendLanes<Two>(cost, rotations); }

auto widest() {
#ifdef LONGARM_WIDE_LANES
  if (processorLanes() == ProcessorLanes::kEight) return descendAvx512;
  if (processorLanes() == ProcessorLanes::kFour) return descendAvx2;
#endif
  return descendAnywhere;
}

}  // namespace

void descendTogether(const RotationCost& cost, Rotations* rotations) {
  static const auto descend = widest();
  descend(cost, rotations);
}

}  // namespace longarm::calibration::internal
