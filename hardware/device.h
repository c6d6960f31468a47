#pragma once

/// @file
/// The device layer: life cycle and narrow kinds.  Drivers live under hardware/drivers; nothing above this
/// room knows which one it talks to.  What each state allows is in docs/architecture.md.

#include <functional>
#include <memory>
#include <string>

#include <Eigen/Core>

#include "core/attitude.h"
#include "core/base_motion.h"
#include "core/latest_value.h"
#include "core/motion.h"
#include "core/result.h"

namespace longarm::hardware {

enum class DeviceState { kClosed, kOpening, kIdle, kActive, kFault };
const char* toString(DeviceState state);

/// Life cycle common to all.  Every method may be called from any thread; errors come back as values.
class Device {
 public:
  virtual ~Device() = default;
  virtual std::string name() const = 0;
  virtual DeviceState state() const = 0;
  /// Why it is in kFault, or the last retryable error; empty if none.
  virtual std::string message() const = 0;
  virtual Status open() = 0;             ///< Idempotent; returns at once, state goes kOpening then kIdle.
  virtual void close() noexcept = 0;     ///< Idempotent; stops first.
  virtual Status activate() = 0;         ///< kIdle -> kActive; kRefused in any other state.
  virtual void deactivate() noexcept = 0;
  /// Stops whatever it does, any state, any thread, no waiting for queued commands.
  virtual void stop() noexcept = 0;
  virtual Status clearFault() = 0;       ///< kFault -> kIdle; an explicit act of the operator.
};

class RobotArm : public virtual Device {
 public:
  /// Newest measured joints of the whole robot; null before the first.
  virtual std::shared_ptr<const JointState> jointState() const = 0;
  /// Joint state at a time on the console's clock, interpolated from the last seconds; kStale outside them.
  virtual Result<JointState> jointStateAt(double stamp_s) const = 0;
  /// Streams one horizon.  Called by MotionGate only.  kRefused unless kActive.
  virtual Status send(const Horizon& horizon) = 0;
};

class Gripper : public virtual Device {
 public:
  virtual Status setOpening(double position) = 0;        ///< Joint position [m or rad]
  virtual double position() const = 0;
  virtual bool holding() const = 0;                      ///< Closed on something.
};

class PanTilt : public virtual Device {
 public:
  virtual Status moveTo(double pan, double tilt) = 0;    ///< [rad]
  virtual double pan() const = 0;
  virtual double tilt() const = 0;
  virtual bool moving() const = 0;
};

/// A base that drives.
class MobileBase : public virtual Device {
 public:
  /// Newest odometry; null before the first.
  virtual std::shared_ptr<const BaseState> odometry() const = 0;
  /// A velocity for the next quarter of a second: the base stops by itself when nothing follows.  Called by
  /// MotionGate only.  kRefused unless kActive, as checkTwist().
  virtual Status drive(const BaseTwist& twist) = 0;
};

/// Tells which way is up.
class Imu : public virtual Device {
 public:
  /// Newest attitude; null before the first.
  virtual std::shared_ptr<const Attitude> attitude() const = 0;
};

/// One decoded-or-not picture with its time of exposure.
struct Frame {
  std::string camera;
  double stamp_s = 0;                    ///< Exposure, on the console's monotonic clock [s].
  double received_s = 0;
  std::uint64_t sequence = 0;
  std::string format;                    ///< "jpeg" or "png".
  std::string data;                      ///< Encoded bytes.
};

/// Settings of lens and focus run from 0 to 1 over their whole travel: 0 is wide and near.  The zoom may be made of an
/// optical and a digital part.
class Camera : public virtual Device {
 public:
  virtual std::shared_ptr<const Frame> latestFrame() const = 0;   ///< Null before the first.
  /// Whether zoom and focus can be commanded.
  virtual bool zooms() const { return false; }
  virtual Status setZoom(double /*zoom01*/) { return noZoom(); }
  virtual Status setFocus(double /*focus01*/) { return noZoom(); }
  virtual Status focusItself() { return noZoom(); }               ///< Until the next setFocus().
  /// As the camera tells it, newest; kStale before the first.
  virtual Result<double> zoom() const { return noZoom(); }
  virtual Result<double> focus() const { return noZoom(); }
  /// The zoom at a time on the console's clock; kStale outside the last seconds.
  virtual Result<double> zoomAt(double /*stamp_s*/) const { return noZoom(); }
  /// Ends a change of zoom or focus under way; pictures go on.  Any thread, no waiting.
  virtual void haltLens() noexcept {}

 private:
  Error noZoom() const { return {ErrorCode::kRefused, name() + ": this camera has no zoom"}; }
};

}  // namespace longarm::hardware
