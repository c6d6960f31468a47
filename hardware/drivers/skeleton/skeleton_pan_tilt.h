#pragma once

/// @file
/// A driver to copy.  To add one for your hardware:
///  1. copy this folder to hardware/drivers/<what>/ and rename; choose the kinds it serves from hardware/device.h;
///  2. add its target (longarm::driver_<what>) as hardware/drivers/skeleton/CMakeLists.txt does;
///  3. run the contract suite on it: one line in tests/hardware/device_contract_test.cpp;
///  4. let session/robot construct it where the workcell says `driver: <what>`.
///
/// Rules that the suite cannot see: third-party headers stay out of this header; one thread per physical
/// connection; settings are copied at open(), never shared; onStop() waits for no queue.

#include <atomic>
#include <condition_variable>
#include <string>
#include <thread>

#include "core/clock.h"
#include "hardware/device_runner.h"

namespace longarm::hardware {

/// Drives an imaginary pan-tilt unit that answers at once: the shape of a driver without a protocol.
/// Thread-safe.
class SkeletonPanTilt final : public RunnerDevice<PanTilt> {
 public:
  struct Settings {
    std::string port = "/dev/serial/by-id/unit";   ///< Shows how settings look; nothing is opened.
    double reach = 1.5;                            ///< Either way [rad].
    double command_deadline_s = 0.5;               ///< No fresh command for so long: the unit halts.
  };

  SkeletonPanTilt(std::string name, Settings settings, const Clock& clock);
  ~SkeletonPanTilt() override;

  Status moveTo(double pan, double tilt) override;
  double pan() const override { return m_pan; }
  double tilt() const override { return m_tilt; }
  bool moving() const override { return m_moving; }

 protected:
  Status onOpen() override;
  Status onClose() override;
  Status onStop() override;

 private:
  void run();                            // the connection's thread

  const Settings m_settings;
  const Clock& m_clock;
  std::thread m_thread;
  std::mutex m_mutex;                    // guards the mailbox of one command
  std::condition_variable m_wake;
  bool m_quit = false, m_has_command = false;
  double m_wanted_pan = 0, m_wanted_tilt = 0, m_commanded_s = 0;
  std::atomic<double> m_pan{0}, m_tilt{0};
  std::atomic<bool> m_moving{false};
};

}  // namespace longarm::hardware
