#pragma once

/// @file
/// SimulatedCamera: delivers encoded pictures at a fixed rate.

#include <functional>
#include <string>

#include "core/clock.h"
#include "hardware/device_runner.h"

namespace longarm::hardware {

/// The picture of frame k is what `source` says; its stamp is k / rate on the clock.  Streams while kActive; the
/// last picture stays visible afterwards.  Deterministic on a ManualClock.  Thread-safe.
class SimulatedCamera final : public RunnerDevice<Camera> {
 public:
  /// Encoded bytes ("png" or "jpeg" as `format` says) of frame k.
  using Source = std::function<std::string(std::uint64_t k)>;

  SimulatedCamera(std::string name, double rate_hz, std::string format, Source source, const Clock& clock);
  ~SimulatedCamera() override;

  std::shared_ptr<const Frame> latestFrame() const override;
  Status setZoom(double zoom01) override;
  bool zooms() const override { return true; }
  Result<double> zoom() const override;
  Result<double> zoomAt(double /*stamp_s*/) const override { return zoom(); }   ///< It is there at once.

  void injectFault(const std::string& why);
  /// A frozen picture: no new frames come though the camera is active.
  void freeze(bool frozen);

 protected:
  Status onStop() override;

 private:
  void refresh(double now_s) const;      // m_mutex held

  const double m_rate_hz;
  const std::string m_format;
  const Source m_source;
  const Clock& m_clock;
  mutable std::mutex m_mutex;
  mutable std::shared_ptr<const Frame> m_frame;
  bool m_frozen = false;
  double m_zoom = 0;
};

}  // namespace longarm::hardware
