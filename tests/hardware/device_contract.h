#pragma once

/// @file
/// What every device must do, whatever its kind and driver.  To run the suite on yours: derive a DeviceRig and add one
/// line to device_contract_test.cpp.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "hardware/device.h"

namespace longarm::hardware::tests {

/// One device on its bench.
class DeviceRig {
 public:
  virtual ~DeviceRig() = default;
  virtual Device& device() = 0;
  /// Gives up the device, as a program does that ends.
  virtual void destroyDevice() = 0;
  /// The kind's command: starts a motion that lasts about a second (for a camera: a zoom).
  virtual Status command() = 0;
  /// Whether it moves now; nullopt for devices that do not move or move at once.
  virtual std::optional<bool> moves() { return std::nullopt; }
  /// Lets time pass on the device's clock.
  virtual void pass(double seconds) = 0;
  /// Whether configuration is all its command is, allowed while idle.
  virtual bool commandIsConfiguration() const { return false; }
  /// Brings it into kFault from outside.  @returns whether such a thing can be done to it.
  virtual bool breakIt() = 0;
  /// Whatever made the fault is over.
  virtual void mend() {}

  /// Waits, letting time pass.
  bool until(const std::function<bool()>& condition) {
    for (int i = 0; i < 1000 && !condition(); ++i) pass(0.005);
    return condition();
  }
  bool becomes(DeviceState state) {
    return until([&] { return device().state() == state; });
  }
  void openAndActivate() {
    ASSERT_TRUE(device().open().ok());
    ASSERT_TRUE(becomes(DeviceState::kIdle)) << device().message();
    const auto active = device().activate();
    ASSERT_TRUE(active.ok()) << active.error().message;
  }
};

struct DeviceCase {
  std::string name;
  std::function<std::unique_ptr<DeviceRig>()> make;
};

class DeviceContract : public ::testing::TestWithParam<DeviceCase> {
 protected:
  void SetUp() override { m_rig = GetParam().make(); }
  DeviceRig& rig() { return *m_rig; }
  Device& device() { return m_rig->device(); }

  std::unique_ptr<DeviceRig> m_rig;
};

}  // namespace longarm::hardware::tests
