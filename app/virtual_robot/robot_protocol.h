#pragma once

/// @file
/// RobotProtocol: the robot's end of the link, without a socket.

#include <deque>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "app/virtual_robot/camera_rig.h"
#include "app/virtual_robot/picture_maker.h"
#include "app/virtual_robot/robot_body.h"
#include "app/virtual_robot/robot_services.h"
#include "app/virtual_robot/subscriptions.h"
#include "hardware/rosbridge_codec/protocol.h"

namespace longarm::virtual_robot {

/// One WebSocket frame.
struct Frame {
  bool binary = false;
  std::string bytes;
};

/// Reads what the client sends, moves the body, and writes what it subscribed to.  Whatever cannot be read or done is
/// answered with a status operation, the same sentence (numbers apart) at most once a second.  The faults link_cut and link_delay act
/// here, on everything but services.  Thread-compatible; never throws.
class RobotProtocol {
 public:
  /// Latency of the link under link_delay, each way.
  static constexpr double kDelay_s = 0.3;

  /// @param cameras  false: nobody takes pictures, and whoever subscribes is told.
  /// @param send     takes each frame.  All references must outlive it.
  RobotProtocol(RobotBody& body, CameraRig& rig, RobotServices& services, bool cameras,
                std::function<void(Frame)> send);

  void connected();
  /// The client is gone: its subscriptions end and the arm brakes.
  void disconnected();
  void receiveText(std::string_view frame);
  void receiveBinary(std::string_view frame);
  /// Publishes what a tick brought; call after RobotBody::tick().
  void afterTick();
  void publish(const Picture& picture);
  /// A sentence for the client: "error", "warning", "info".
  void tell(const std::string& level, const std::string& text);

 private:
  struct Delayed {
    double due_s;
    rosbridge::Operation operation;
  };

  void receive(const Result<rosbridge::Operation>& operation);
  void act(const rosbridge::Operation& operation);
  void act(const rosbridge::Publish& publish);
  Status command(const rosbridge::Publish& publish);
  Status followHorizon(const rosbridge::Body& message);
  Status aim(const std::string& pan_tilt, const rosbridge::Body& message);
  void subscribe(const rosbridge::Subscribe& subscribe);
  void updateCameras();
  void publishStates();
  void publishAttitude();
  template <typename Message>
  void publish(const std::string& topic, const Message& message);
  void send(Frame frame, bool delayed);
  void flushDelayed();

  RobotBody& m_body;
  CameraRig& m_rig;
  RobotServices& m_services;
  const bool m_cameras;
  const std::function<void(Frame)> m_send;
  Subscriptions m_subscriptions;
  std::map<std::string, double> m_told;            // sentence -> when
  std::deque<std::pair<double, Frame>> m_outgoing;
  std::deque<Delayed> m_incoming;
  std::map<std::string, double> m_published;       // state topics: value published last
  std::map<std::string, double> m_published_s;     // ... and when
  bool m_connected = false;
};

}  // namespace longarm::virtual_robot
