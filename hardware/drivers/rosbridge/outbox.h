#pragma once

/// @file
/// Outbox: what waits to go out.  STOP passes everything.

#include <cstddef>
#include <deque>
#include <optional>
#include <string>

#include "core/result.h"

namespace longarm::hardware {

/// A bounded queue of encoded operations, and one before it for what is urgent.  Thread-compatible.
class Outbox {
 public:
  explicit Outbox(std::size_t capacity = 256) : m_capacity(capacity) {}

  struct Item {
    std::string text;
    bool motion = false;                 ///< Moves something: dropped when STOP comes.
    double deadline_s = 0;               ///< Motion is not sent after this [s on the console's clock].
  };

  struct Next {
    std::string text;
    bool urgent = false;
  };

  /// @returns kRefused when the queue is full.
  Status push(Item item);
  /// Goes out first; motion that still waits is dropped, because it is older than the stop.
  void pushUrgent(std::string text);
  /// What goes out next; motion whose deadline has passed is skipped and counted.
  std::optional<Next> pop(double now_s);
  bool empty() const { return m_urgent.empty() && m_items.empty(); }
  void clear();
  /// How many were dropped: too late, or overtaken by a stop.
  std::size_t dropped() const { return m_dropped; }

 private:
  const std::size_t m_capacity;
  std::deque<std::string> m_urgent;
  std::deque<Item> m_items;
  std::size_t m_dropped = 0;
};

}  // namespace longarm::hardware
