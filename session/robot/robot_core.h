#pragma once

/// @file
/// RobotCore: one connected life of a robot, from start to restart: its process, devices, gate and motion
/// loop.

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "session/robot/motion_loop.h"
#include "session/robot/robot_runtime.h"
#include "session/robot/virtual_robot_process.h"

namespace longarm::session {

/// How the connection does, as a state and a sentence.
struct LinkReport {
  LinkState state = LinkState::kClosed;
  std::string text;
  double state_age_s = -1;
};

/// Thread-safe, except tick(): one thread only.
class RobotCore {
 public:
  /// As RobotRuntime::start().  Everything that is borrowed outlives it.
  static Result<std::shared_ptr<RobotCore>> create(std::shared_ptr<const planning::Workcell> workcell,
                                                   const RuntimeOptions& options, const Clock& clock,
                                                   MotionLoop::Report report);
  ~RobotCore();

  const DeviceSet& devices() const { return m_devices; }
  hardware::MotionGate& gate() { return *m_gate; }
  MotionLoop& loop() { return *m_loop; }
  const VirtualRobotProcess* process() const { return m_process.get(); }

  /// One cycle of the motion thread: motion, every fifth time upkeep.
  void tick();
  void stop(const std::string& source, const std::string& reason) noexcept;
  Status resetStop();
  void streamCamera(const std::string& name, bool on);

  LinkReport link() const;
  std::vector<std::string> faults() const;
  /// As RuntimeStatus::up.
  std::optional<Eigen::Vector3d> up() const;
  /// Fills what only gate and devices know: gate, moving, stop_confirmed, tracking.
  void describeMotion(RuntimeStatus& status) const;

 private:
  RobotCore(std::shared_ptr<const planning::Workcell> workcell, const RuntimeOptions& options, const Clock& clock,
            MotionLoop::Report report);
  Status connect();
  Status startProcess();
  void waitUntilOpen() const;
  void makeMotion();
  std::vector<hardware::Device*> allDevices() const;
  void upkeep();
  void reportLink();
  bool standsStill() const;

  const std::shared_ptr<const planning::Workcell> m_cell;
  const planning::Workcell& m_workcell;
  const RuntimeOptions m_options;
  const Clock& m_clock;
  const MotionLoop::Report m_report;
  std::unique_ptr<VirtualRobotProcess> m_process;
  std::string m_url;
  DeviceSet m_devices;
  std::unique_ptr<hardware::MotionGate> m_gate;
  std::unique_ptr<MotionLoop> m_loop;
  unsigned m_ticks = 0;
  LinkState m_reported_link = LinkState::kConnecting;
  std::atomic<bool> m_was_up{false};
  mutable std::mutex m_mutex;
  std::set<std::string> m_streams;  // Cameras whose pictures are wanted.
};

}  // namespace longarm::session
