#pragma once

/// @file
/// SocketWorker: the WebSocket and its timers, on a thread of their own.  Internal to the driver: has Qt in it.

#include <atomic>
#include <memory>
#include <string>
#include <string_view>

#include <QByteArray>
#include <QObject>
#include <QTimer>
#include <QWebSocket>

#include "core/clock.h"
#include "hardware/drivers/rosbridge/connection.h"

namespace longarm::hardware {

/// What the worker tells; all on the worker's thread, nothing thrown.
class SocketOwner {
 public:
  virtual ~SocketOwner() = default;
  virtual void onOpened() noexcept = 0;
  virtual void onClosed(const std::string& why) noexcept = 0;
  virtual void onFrame(std::string_view bytes, bool binary) noexcept = 0;
  /// Something waits in the outbox, or some milliseconds have passed.
  virtual void onTurn() noexcept = 0;
  /// Whether a call waits for its answer: a peer that works on it may be silent, for the caller's patience.
  virtual bool awaitsAnswer() const noexcept = 0;
};

/// Lives on its thread, except wake() (any thread).
class SocketWorker final : public QObject {
 public:
  SocketWorker(const ConnectionSettings& settings, SocketOwner& owner);
  ~SocketWorker() override;

  void begin();
  /// Sends what is urgent, says goodbye.
  void end();
  /// Has onTurn() called before anything else that waits for the thread.
  void wake();

  /// @returns whether the socket took it.
  bool write(const std::string& text);
  void flush();
  /// Gives the link up and connects again later.
  void abandon(const std::string& why);

 protected:
  bool event(QEvent* event) override;

 private:
  void connectNow();
  void makeSocket();
  void opened();
  void heard(const QByteArray& bytes, bool binary);
  void lost(const std::string& why);
  void watch();

  const ConnectionSettings m_settings;
  SocketOwner& m_owner;
  const SteadyClock m_steady;
  std::unique_ptr<QWebSocket> m_socket;
  std::unique_ptr<QTimer> m_turn, m_retry;
  std::atomic<bool> m_woken{false};
  bool m_open = false, m_connecting = false, m_ending = false;
  double m_retry_s = 0, m_heard_s = 0, m_pinged_s = 0, m_began_s = 0, m_opened_s = 0;
};

/// Makes the program's QCoreApplication if nobody has: event loops of Qt need one.  Thread-safe.
void ensureApplication();

}  // namespace longarm::hardware
