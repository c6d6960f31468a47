#pragma once

/// @file
/// RobotFeed: what snapshots and aiming need of a connected robot, and nothing more.

#include <memory>
#include <optional>
#include <string>

#include "core/base_motion.h"
#include "core/motion.h"
#include "core/result.h"
#include "hardware/device.h"

namespace longarm::session {

/// Called on the GUI thread; never waits.
class RobotFeed {
 public:
  virtual ~RobotFeed() = default;
  /// Now on the clock of the stamps [s].
  virtual double now_s() const = 0;
  /// Null before the first, or for a camera that is not there.
  virtual std::shared_ptr<const hardware::Frame> latestFrame(const std::string& camera) const = 0;
  /// Null before the first.
  virtual std::shared_ptr<const JointState> jointState() const = 0;
  /// Interpolated; kStale outside the last seconds.
  virtual Result<JointState> jointStateAt(double stamp_s) const = 0;
  /// Newest odometry; empty: none, or no base.
  virtual std::optional<BaseState> base() const { return std::nullopt; }
  /// Sends a pan-tilt of the workcell to these angles [rad].
  virtual Status movePanTilt(const std::string& pan_tilt, double pan, double tilt) = 0;
  /// Setting of a camera's zoom at a time, 0 ... 1; empty for a camera without.  kStale outside the last seconds.
  virtual Result<std::optional<double>> zoomAt(const std::string& camera, double stamp_s) const = 0;
  virtual Status setZoom(const std::string& camera, double zoom01) = 0;
  /// 0 near ... 1 far.
  virtual Status setFocus(const std::string& camera, double focus01) = 0;
  virtual Status focusItself(const std::string& camera) = 0;
  /// Newest; empty for a camera without, or before it told.
  virtual std::optional<double> focus(const std::string& camera) const = 0;
};

}  // namespace longarm::session
