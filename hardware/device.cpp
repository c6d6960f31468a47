#include "hardware/device.h"

namespace longarm::hardware {

const char* toString(DeviceState state) {
  switch (state) {
    case DeviceState::kClosed: return "closed";
    case DeviceState::kOpening: return "opening";
    case DeviceState::kIdle: return "idle";
    case DeviceState::kActive: return "active";
    case DeviceState::kFault: return "in fault";
  }
  return "unknown";
}

}  // namespace longarm::hardware
