#pragma once

/// @file
/// Connection: one rosbridge link that all devices of a robot share.

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/clock.h"
#include "core/result.h"
#include "hardware/rosbridge_codec/protocol.h"

namespace longarm::hardware {

struct ConnectionSettings {
  std::string url;                       ///< ws://host:port
  std::string heartbeat_topic = "/longarm/heartbeat";
  double heartbeat_period_s = 0.05;      ///< On the console's clock.
  /// Heartbeats go out while the clock is below this [s]; null: never.
  std::shared_ptr<std::atomic<double>> alive_until_s;
  double first_retry_s = 0.1, last_retry_s = 2;   ///< Wait before connecting again, doubled from one to the other.
  double connect_timeout_s = 3;
  double silence_s = 5;                  ///< Neither a message nor an answer to a ping for so long, and no call waits: dead.
  double motion_deadline_s = 0.2;        ///< Motion that could not be sent within this is not sent at all.
  std::size_t mailbox = 256;             ///< Messages that may wait to be sent.
  std::size_t max_backlog_bytes = 1u << 20;   ///< More than this unsent: the link is dead.
};

/// A robot's server as the devices see it.  Runs one thread of its own from the first attach() to the last detach();
/// connects by itself, again and again.  Works with or without a QCoreApplication.
///
/// Thread-safe.  Callbacks come on the connection's thread, one at a time; in them only post(), postUrgent(), up() and
/// dialect() may be called.
class Connection {
 public:
  struct Events {
    std::function<void()> up;                         ///< The link stands (again); at once if it does already.
    std::function<void(const Error& why)> down;       ///< It was lost, or could not be made; tried again by itself.
    /// The peer sent something that cannot be used; told to the one alone that attached first.
    std::function<void(const Error& what)> trouble;
    std::function<void(const Error& what)> fault;     ///< The peer does not speak rosbridge.
  };
  /// `received_s` is on the console's clock.  A failure is reported as trouble.
  using Handler = std::function<Status(const rosbridge::Publish& message, double received_s)>;

  /// @param clock  outlives the connection
  Connection(ConnectionSettings settings, const Clock& clock);
  ~Connection();

  const std::string& url() const;
  std::uint64_t attach(Events events);
  /// After it returns none of the callbacks runs or will run.  The last one ends the connection, after what is urgent
  /// has gone out.
  void detach(std::uint64_t id) noexcept;

  /// Kept over lost links.
  std::uint64_t subscribe(rosbridge::Subscribe what, Handler handler);
  void unsubscribe(std::uint64_t id) noexcept;
  /// Says what will be published; kept over lost links.  Again for the same topic: no effect.
  void advertise(const std::string& topic, const std::string& type);

  bool up() const;
  /// Which ROS the peer speaks, by the first joint state's way of writing time; ROS 1 until then.
  rosbridge::Dialect dialect() const;
  /// kDisconnected naming the address while the link is down.
  Status requireUp() const;

  /// Sends in turn.  @returns kDisconnected, or kRefused when too much waits.
  Status post(const rosbridge::Operation& operation);
  /// The same for what moves something: dropped when it cannot go out in time or STOP overtakes it.
  Status postMotion(const rosbridge::Operation& operation);
  /// Sends before everything that waits, and drops waiting motion.
  Status postUrgent(const rosbridge::Operation& operation);

  /// Calls a service and waits for the answer.  Waits for the first connection, too; after a lost link it does not.
  /// @returns kDisconnected, kTimeout, or kRefused with the robot's words when it says no.
  Result<rosbridge::Body> call(const std::string& service, const rosbridge::Body& arguments, double timeout_s);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace longarm::hardware
