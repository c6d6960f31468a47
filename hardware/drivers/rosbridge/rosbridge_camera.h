#pragma once

/// @file
/// RosbridgeCamera: compressed pictures, subscribed to while it is active; zoom and focus.

#include <atomic>
#include <mutex>

#include "hardware/drivers/rosbridge/lens_state.h"
#include "hardware/drivers/rosbridge/linked_device.h"
#include "hardware/drivers/rosbridge/topic_names.h"

namespace longarm::hardware {

struct CameraSettings {
  double max_rate_hz = 20;               ///< The robot sends no more than so many a second.
  bool zooms = false;
};

/// The last picture stays visible after deactivate().  Thread-safe.
class RosbridgeCamera final : public LinkedDevice<Camera> {
 public:
  RosbridgeCamera(std::string name, RosbridgeRobot robot, CameraSettings settings, const TopicNames& topics);
  ~RosbridgeCamera() override;

  std::shared_ptr<const Frame> latestFrame() const override { return m_frame.get(); }
  bool zooms() const override { return m_settings.zooms; }
  /// @returns kDisconnected, kRefused for a camera without zoom or that is closed, kOutOfLimits.
  Status setZoom(double zoom01) override;
  Status setFocus(double focus01) override;
  Status focusItself() override;
  Result<double> zoom() const override { return m_settings.zooms ? m_zoom.newest() : Camera::zoom(); }
  Result<double> focus() const override { return m_settings.zooms ? m_focus.newest() : Camera::focus(); }
  Result<double> zoomAt(double stamp_s) const override { return m_settings.zooms ? m_zoom.at(stamp_s) : Camera::zoomAt(stamp_s); }
  void haltLens() noexcept override;

 protected:
  Status onOpen() override;
  Status onClose() override;
  Status onActivate() override;
  Status onStop() override;

 private:
  Status take(const rosbridge::Publish& message, double received_s);
  Status command(LensState& lens, const char* doing, double wanted);

  const CameraSettings m_settings;
  const std::string m_image_topic;
  LensState m_zoom, m_focus;
  LatestValue<Frame> m_frame;
  std::mutex m_mutex;                    // guards m_subscription
  std::uint64_t m_subscription = 0;      // 0: none
  std::uint64_t m_count = 0;             // of pictures; connection's thread only
};

}  // namespace longarm::hardware
