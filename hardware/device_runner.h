#pragma once

/// @file
/// DeviceRunner: the life cycle, written once.  Every driver holds one; it catches what the driver throws, logs
/// each trouble once, and is the only place where a device's state changes.

#include <functional>
#include <mutex>
#include <string>

#include "core/result.h"
#include "hardware/device.h"

namespace longarm::hardware {

/// Thread-safe.  Life-cycle calls (open, close, activate, deactivate, clearFault) wait for each other; stop() and
/// state() wait for none of them.  The driver's functions run without the state's lock held.
class DeviceRunner {
 public:
  using Action = std::function<Status()>;

  explicit DeviceRunner(std::string name);

  const std::string& name() const { return m_name; }
  DeviceState state() const;
  std::string message() const;

  /// kClosed -> kOpening, then `start`; no effect in other states.  The device is kIdle when opened() is called,
  /// by `start` itself or later by another thread.  When `start` fails the device is kClosed again.
  Status open(const Action& start);
  /// The connection stands: kOpening -> kIdle.  @returns whether it was kOpening.
  bool opened();
  /// Any state -> kClosed: runs `halt`, then `finish`.
  void close(const Action& halt, const Action& finish) noexcept;
  /// kIdle -> kActive; kRefused in any other state.
  Status activate(const Action& start);
  /// kActive -> kIdle.
  void deactivate(const Action& halt) noexcept;
  /// Runs `halt` in any state, then kActive -> kIdle.
  void stop(const Action& halt) noexcept;
  /// kFault -> kIdle when `recover` succeeds; no effect when there is no fault.
  Status clearFault(const Action& recover);

  /// Trouble that ends work: any open state -> kFault.  Logged once per change.
  void fault(const Error& error) noexcept;
  /// Trouble that may pass: kept as message(), state unchanged.  Logged once until it changes or recovered().
  void trouble(const Error& error) noexcept;
  void recovered() noexcept;

  /// Runs a command if the device is kActive (else kRefused); what it throws becomes kInternal.
  Status command(const char* what, const Action& action);
  /// The same in kIdle and kActive, for configuration.
  Status configure(const char* what, const Action& action);
  /// kRefused unless kActive.
  Status requireActive(const char* what) const;

 private:
  Status guarded(const char* what, const Action& action) noexcept;
  Status refused(const char* what, DeviceState state, const char* wanted) const;
  void change(DeviceState from, DeviceState to);
  void set(DeviceState state);

  const std::string m_name;
  std::mutex m_life_mutex;
  mutable std::mutex m_mutex;
  DeviceState m_state = DeviceState::kClosed;
  std::string m_message;
};

/// A device of one kind whose life cycle is a DeviceRunner's.  A driver overrides what it needs; its destructor
/// must call close(), because here the overrides are gone already.
template <typename Kind>
class RunnerDevice : public Kind {
 public:
  explicit RunnerDevice(std::string name) : m_runner(std::move(name)) {}

  std::string name() const override { return m_runner.name(); }
  DeviceState state() const override { return m_runner.state(); }
  std::string message() const override { return m_runner.message(); }
  Status open() override {
    return m_runner.open([this] { return onOpen(); });
  }
  void close() noexcept override {
    m_runner.close([this] { return onStop(); }, [this] { return onClose(); });
  }
  Status activate() override {
    return m_runner.activate([this] { return onActivate(); });
  }
  void deactivate() noexcept override {
    m_runner.deactivate([this] { return onStop(); });
  }
  void stop() noexcept override {
    m_runner.stop([this] { return onStop(); });
  }
  Status clearFault() override {
    return m_runner.clearFault([this] { return onClearFault(); });
  }

 protected:
  /// Starts connecting; returns at once.  Calls runner().opened() now or, from its own thread, later.
  virtual Status onOpen() {
    m_runner.opened();
    return {};
  }
  virtual Status onClose() { return {}; }
  virtual Status onActivate() { return {}; }
  /// Halts whatever moves.  Called from any thread in any state; takes no lock that is held for long.
  virtual Status onStop() { return {}; }
  virtual Status onClearFault() { return {}; }

  DeviceRunner& runner() { return m_runner; }
  const DeviceRunner& runner() const { return m_runner; }

 private:
  DeviceRunner m_runner;
};

}  // namespace longarm::hardware
