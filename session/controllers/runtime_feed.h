#pragma once

/// @file
/// RuntimeFeed: a RobotRuntime as snapshots and aiming see it.

#include "session/controllers/robot_feed.h"
#include "session/robot/robot_runtime.h"

namespace longarm::session {

/// Borrows the runtime, which must outlive this.
class RuntimeFeed final : public RobotFeed {
 public:
  explicit RuntimeFeed(RobotRuntime& runtime) : m_runtime(runtime) {}
  double now_s() const override { return m_runtime.clock().now_s(); }
  std::shared_ptr<const hardware::Frame> latestFrame(const std::string& camera) const override {
    return m_runtime.cameraFrame(camera);
  }
  std::shared_ptr<const JointState> jointState() const override { return m_runtime.jointState(); }
  Result<JointState> jointStateAt(double stamp_s) const override { return m_runtime.jointStateAt(stamp_s); }
  std::optional<BaseState> base() const override { return m_runtime.status().base; }
  Status movePanTilt(const std::string& pan_tilt, double pan, double tilt) override {
    return m_runtime.movePanTilt(pan_tilt, pan, tilt);
  }
  Result<std::optional<double>> zoomAt(const std::string& camera, double stamp_s) const override {
    return m_runtime.zoomAt(camera, stamp_s);
  }
  Status setZoom(const std::string& camera, double zoom01) override { return m_runtime.setZoom(camera, zoom01); }
  Status setFocus(const std::string& camera, double focus01) override { return m_runtime.setFocus(camera, focus01); }
  Status focusItself(const std::string& camera) override { return m_runtime.focusItself(camera); }
  std::optional<double> focus(const std::string& camera) const override { return m_runtime.focus(camera); }

 private:
  RobotRuntime& m_runtime;
};

}  // namespace longarm::session
