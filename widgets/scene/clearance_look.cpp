#include "widgets/scene/clearance_look.h"

namespace longarm::scene {

Eigen::Vector3d clearanceColor(planning::ClearanceBand band) {
  switch (band) {
    case planning::ClearanceBand::kTight: return {0.902, 0.380, 0.0};
    case planning::ClearanceBand::kNear: return {0.941, 0.894, 0.259};
    case planning::ClearanceBand::kFree: break;
  }
  return {0.361, 0.941, 0.549};
}

}  // namespace longarm::scene
