#pragma once

/// @file
/// SimulatedArm: follows horizons exactly, on any Clock.

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/clock.h"
#include "hardware/device_runner.h"

namespace longarm::hardware {

/// Where the joints are is a function of the clock alone: deterministic with a ManualClock.  A horizon may name
/// any of the joints; the others stay.  stop() brakes along the horizon in force.  Thread-safe.
class SimulatedArm final : public RunnerDevice<RobotArm> {
 public:
  /// @param clock  outlives the arm
  /// @pre all vectors have one entry per joint
  SimulatedArm(std::string name, std::vector<std::string> joints, Eigen::VectorXd start,
               Eigen::VectorXd stop_deceleration, const Clock& clock);
  ~SimulatedArm() override;

  std::shared_ptr<const JointState> jointState() const override;
  Result<JointState> jointStateAt(double stamp_s) const override;
  Status send(const Horizon& horizon) override;

  /// What a test does to it: a fault as a controller would report it.
  void injectFault(const std::string& why);
  /// Added to everything measured from now on, as by a slipped encoder [rad or m].
  void setOffset(const Eigen::VectorXd& offset);
  /// Measured states keep the stamp they have now, as behind a link that is cut.
  void freeze(bool frozen);
  std::uint64_t horizonsReceived() const;

 protected:
  Status onOpen() override;
  Status onStop() override;

 private:
  struct Leg {
    Trajectory path;
    double start_s = 0;
  };

  JointState stateAt(double now_s) const;                 // m_mutex held
  Status take(const Horizon& horizon);
  Result<Trajectory> completed(const Horizon& horizon, const JointState& at_start) const;

  const std::vector<std::string> m_joints;
  const Eigen::VectorXd m_start, m_stop_deceleration;
  const Clock& m_clock;
  mutable std::mutex m_mutex;
  std::deque<Leg> m_legs;                // all joints, oldest first
  Eigen::VectorXd m_offset;
  double m_opened_s = 0;
  double m_frozen_s = -1;
  std::uint64_t m_received = 0;
};

}  // namespace longarm::hardware
