#pragma once

/// @file
/// The devices of a workcell behind a rosbridge server: real robots and the virtual one alike.

#include "session/robot/robot_runtime.h"

namespace longarm::session {

/// One connection to `url` that all devices share, with the topic names of workcell.backend.
/// @returns kInvalidInput when the workcell asks for another driver or the address is not a ws:// one.
Result<DeviceSet> makeRosbridgeDevices(const planning::Workcell& workcell, const std::string& url,
                                       const Clock& clock);

}  // namespace longarm::session
