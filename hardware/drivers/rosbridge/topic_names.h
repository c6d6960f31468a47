#pragma once

/// @file
/// The topics of docs/robot_interface.md, with the replacements of a workcell.

#include <map>
#include <string>
#include <utility>

namespace longarm::hardware {

/// Immutable; thread-safe.
class TopicNames {
 public:
  /// @param replacements  Default name -> the robot's own name.
  explicit TopicNames(std::map<std::string, std::string> replacements = {})
      : m_replacements(std::move(replacements)) {}

  std::string jointStates() const { return named("/joint_states"); }
  std::string trajectory() const { return named("/arm_controller/joint_trajectory"); }
  std::string stop() const { return named("/arm_controller/stop"); }
  std::string heartbeat() const { return named("/longarm/heartbeat"); }
  std::string gripperCommand() const { return named("/gripper_controller/command"); }
  std::string gripperHolding() const { return named("/gripper_controller/holding"); }
  std::string panTiltCommand(const std::string& name) const { return named("/pan_tilt/" + name + "/command"); }
  std::string driveCommand() const { return named("/cmd_vel"); }
  std::string imu() const { return named("/imu/data"); }
  std::string odometry() const { return named("/odom"); }
  std::string image(const std::string& camera) const { return named("/camera/" + camera + "/image/compressed"); }
  std::string zoom(const std::string& camera) const { return named("/camera/" + camera + "/zoom"); }
  std::string zoomState(const std::string& camera) const { return named("/camera/" + camera + "/zoom_state"); }
  std::string focus(const std::string& camera) const { return named("/camera/" + camera + "/focus"); }
  std::string focusState(const std::string& camera) const { return named("/camera/" + camera + "/focus_state"); }

 private:
  std::string named(const std::string& usual) const {
    const auto found = m_replacements.find(usual);
    return found == m_replacements.end() ? usual : found->second;
  }

  const std::map<std::string, std::string> m_replacements;
};

}  // namespace longarm::hardware
