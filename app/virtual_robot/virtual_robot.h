#pragma once

/// @file
/// VirtualRobot: body, cameras and protocol under one clock, without a socket.

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "app/virtual_robot/camera_rig.h"
#include "app/virtual_robot/render_thread.h"
#include "app/virtual_robot/robot_body.h"
#include "app/virtual_robot/robot_protocol.h"
#include "app/virtual_robot/robot_services.h"
#include "core/result.h"

namespace longarm::virtual_robot {

struct RobotOptions {
  std::string scenario = "grab_pipe";    ///< Built-in name or file.
  std::string variant;                   ///< Empty: the scenario's.
  unsigned seed = 1;                     ///< 0: the scenario as its file has it.
  bool lockstep = false;                 ///< Time passes only by the service /virtual_robot/step.
  bool ideal = false;                    ///< No offsets, backlash, latency or noise.
  bool cameras = true;
};

/// How it reaches the world around it.
struct RobotOutlets {
  std::function<void(Frame)> send;       ///< To the client, on the caller's thread.
  std::function<void()> wake;            ///< Called on the render thread when deliverPictures() has something to do.
  std::function<void()> quit;            ///< The client asked the program to end.
  std::function<void(const std::string&)> log;     ///< A sentence for people; on the caller's thread.
};

/// In lockstep the same seed, calls and frames give the same frames, pictures included.  Thread-compatible; `wake`
/// alone comes from elsewhere.
class VirtualRobot {
 public:
  /// @returns the errors of loadScenario, loadWorkcell, RobotBody and the camera files.
  static Result<std::unique_ptr<VirtualRobot>> create(const RobotOptions& options, RobotOutlets outlets);

  RobotProtocol& protocol() { return *m_protocol; }
  const RobotBody& body() const { return *m_body; }

  /// Without lockstep: lets time pass up to `robot_time_s` on the robot's clock, at most kMostAtOnce_s of it.
  void advanceTo(double robot_time_s);
  /// Sends the pictures that are ready.
  void deliverPictures();

  static constexpr double kMostAtOnce_s = 0.25;

 private:
  VirtualRobot(const RobotOptions& options, RobotOutlets outlets, std::unique_ptr<RobotBody> body, CameraRig rig);
  void step(double seconds);
  void tick();
  void showThings();
  void takePictures();
  PictureRequest requestFor(const std::vector<std::string>& cameras);
  void collect(Picture picture);
  void publish(Picture picture);

  const RobotOptions m_options;
  const RobotOutlets m_outlets;
  std::unique_ptr<RobotBody> m_body;
  CameraRig m_rig;
  std::unique_ptr<RobotServices> m_services;
  std::unique_ptr<RobotProtocol> m_protocol;
  std::mutex m_mutex;                    // of what the render thread hands over
  std::vector<Picture> m_ready;
  std::vector<std::string> m_complaints;
  struct Spectator {                     // camera that something is held before, as it was at the start
    Pose X_WC;
    double fx;
  };
  std::map<std::string, Spectator> m_spectators;
  std::map<std::string, std::string> m_frozen;     // camera -> picture it repeats
  double m_next_render_s = 0;
  std::unique_ptr<RenderThread> m_renderer;        // ends first
};

}  // namespace longarm::virtual_robot
