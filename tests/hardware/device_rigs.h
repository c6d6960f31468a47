#pragma once

/// @file
/// The benches of all drivers for the contract suite.

#include <vector>

#include "tests/hardware/device_contract.h"

namespace longarm::hardware::tests {

std::vector<DeviceCase> allDeviceCases();

}  // namespace longarm::hardware::tests
