#pragma once

/// @file
/// BridgeServer: a small robot behind a rosbridge server of its own, to try the driver on.

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/clock.h"
#include "hardware/rosbridge_codec/protocol.h"
#include "hardware/sim/simulated_arm.h"
#include "hardware/sim/simulated_base.h"
#include "hardware/sim/simulated_gripper.h"
#include "hardware/sim/simulated_imu.h"
#include "hardware/sim/simulated_pan_tilt.h"

class QThread;

namespace longarm::hardware::tests {

struct BridgeOptions {
  int port = 0;                          ///< 0: any free one.
  double clock_ahead_s = 5000;           ///< Of the robot's clock.
  bool lockstep = false;                 ///< Time passes only by the service /virtual_robot/step.
  rosbridge::Dialect dialect = rosbridge::Dialect::kRos1;
  bool cbor = true;                      ///< Pictures as CBOR where that is asked for.
};

/// What the console sent, and when it came on the machine's steady clock.
struct Received {
  rosbridge::Operation operation;
  double at_s = 0;
};

/// Three arm joints joint_1 ... joint_3, "finger", "pan" and "tilt"; camera topics of any name.  Brakes when the
/// heartbeat has been silent for 0.25 s.  Thread-safe; runs on a thread of its own.
class BridgeServer {
 public:
  explicit BridgeServer(BridgeOptions options = {});
  ~BridgeServer();

  std::string url() const;
  int port() const;
  SimulatedArm& arm() { return *m_arm; }
  SimulatedGripper& gripper() { return *m_gripper; }
  SimulatedPanTilt& panTilt() { return *m_pan_tilt; }
  SimulatedBase& base() { return *m_base; }
  SimulatedImu& imu() { return *m_imu; }

  std::vector<Received> received() const;
  /// How many publications of a topic came, and the newest of them.
  int published(const std::string& topic) const;
  rosbridge::Body newest(const std::string& topic) const;
  bool subscribed(const std::string& topic) const;
  /// When the first publication of `topic` after `since_s` came [s], or < 0.
  double cameAt(const std::string& topic, double since_s) const;
  int clients() const { return m_clients; }

  void sendText(const std::string& frame);
  void sendBinary(const std::string& frame);
  void closeClients();
  /// Joint states and pictures pause.
  void setQuiet(bool quiet) { m_quiet = quiet; }

 private:
  struct Socket;
  void run(const std::function<void()>& task);
  void turn();                           // on the server's thread, like all below
  void publishAll();
  void take(const std::string& frame);
  void obey(const rosbridge::Publish& message);
  rosbridge::ServiceResponse serve(const rosbridge::CallService& call);
  void reply(const rosbridge::Operation& operation, bool binary = false);
  rosbridge::JointStateMessage jointStates() const;
  void publishPictures();

  const BridgeOptions m_options;
  SteadyClock m_steady;
  ManualClock m_manual{50};
  const Clock& m_clock;
  std::unique_ptr<SimulatedArm> m_arm;
  std::unique_ptr<SimulatedGripper> m_gripper;
  std::unique_ptr<SimulatedPanTilt> m_pan_tilt;
  std::unique_ptr<SimulatedBase> m_base;
  std::unique_ptr<SimulatedImu> m_imu;
  std::atomic<int> m_clients{0};
  std::atomic<bool> m_quiet{false};
  mutable std::mutex m_mutex;            // guards what follows
  std::vector<Received> m_received;
  struct Topic {
    int count = 0;
    rosbridge::Body newest;
    std::vector<double> times;
  };
  std::map<std::string, Topic> m_topics;
  std::map<std::string, rosbridge::Subscribe> m_subscriptions;
  double m_heard_s = 0;
  int m_turns = 0;
  std::unique_ptr<QThread> m_thread;
  std::unique_ptr<Socket> m_socket;
};

/// Waits until `condition` holds.  @returns whether it did in time.
bool eventually(const std::function<bool()>& condition, double timeout_s = 5);

}  // namespace longarm::hardware::tests
