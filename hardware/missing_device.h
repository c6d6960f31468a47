#pragma once

/// @file
/// MissingDevice: stands in for a configured device whose driver this build does not have.

#include <map>
#include <string>
#include <utility>

#include "hardware/device.h"

namespace longarm::hardware {

/// Of every kind at once; stays kClosed, refuses everything with the sentence that names the driver, and keeps
/// the settings so that they are saved back untouched.  Thread-safe (immutable).
class MissingDevice final : public RobotArm, public Gripper, public PanTilt, public Camera {
 public:
  using Settings = std::map<std::string, std::string>;

  MissingDevice(std::string name, std::string driver, Settings settings = {})
      : m_name(std::move(name)), m_driver(std::move(driver)), m_settings(std::move(settings)) {}

  const std::string& driver() const { return m_driver; }
  const Settings& settings() const { return m_settings; }

  std::string name() const override { return m_name; }
  DeviceState state() const override { return DeviceState::kClosed; }
  std::string message() const override { return why().message; }
  Status open() override { return why(); }
  void close() noexcept override {}
  Status activate() override { return why(); }
  void deactivate() noexcept override {}
  void stop() noexcept override {}
  Status clearFault() override { return why(); }

  std::shared_ptr<const JointState> jointState() const override { return nullptr; }
  Result<JointState> jointStateAt(double) const override { return why(); }
  Status send(const Horizon&) override { return why(); }

  Status setOpening(double) override { return why(); }
  double position() const override { return 0; }
  bool holding() const override { return false; }

  Status moveTo(double, double) override { return why(); }
  double pan() const override { return 0; }
  double tilt() const override { return 0; }
  bool moving() const override { return false; }

  std::shared_ptr<const Frame> latestFrame() const override { return nullptr; }
  Status setZoom(double) override { return why(); }

 private:
  Error why() const {
    return {ErrorCode::kNotFound, m_name + ": this build has no driver \"" + m_driver +
                                      "\"; the settings are kept. Choose another driver in the workcell file"};
  }

  std::string m_name, m_driver;
  Settings m_settings;
};

}  // namespace longarm::hardware
