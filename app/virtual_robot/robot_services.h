#pragma once

/// @file
/// The services of the virtual robot: what it is, what is true, faults, steps, the end.

#include <functional>
#include <string>

#include "app/virtual_robot/camera_rig.h"
#include "app/virtual_robot/robot_body.h"
#include "hardware/rosbridge_codec/protocol.h"

namespace longarm::virtual_robot {

/// Answers of docs/robot_interface.md.  Thread-compatible.
class RobotServices {
 public:
  /// @param advance  lets simulated time pass [s]; empty unless in lockstep
  /// @param quit     ends the program
  /// All references must outlive it.
  RobotServices(RobotBody& body, const CameraRig& rig, std::function<void(double)> advance,
                std::function<void()> quit);

  /// Never fails: what cannot be done is answered with result false and {"error": sentence}.
  rosbridge::ServiceResponse call(const rosbridge::CallService& call);

 private:
  using Answer = Result<rosbridge::Body>;
  Answer info() const;
  Answer truth() const;
  Answer step(const rosbridge::Body& args);
  Answer fault(const rosbridge::Body& args);

  RobotBody& m_body;
  const CameraRig& m_rig;
  const std::function<void(double)> m_advance;
  const std::function<void()> m_quit;
};

}  // namespace longarm::virtual_robot
