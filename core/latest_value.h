#pragma once

/// @file
/// LatestValue: a mailbox of one between threads; the newest wins.

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

namespace longarm {

/// Holds the newest immutable T published by any thread.  Thread-safe.
template <typename T>
class LatestValue {
 public:
  void publish(T value) { publish(std::make_shared<const T>(std::move(value))); }
  void publish(std::shared_ptr<const T> value) {
    std::lock_guard<std::mutex> lock(m_mutex);
    m_value = std::move(value);
    ++m_count;
  }
  /// The newest value, or null before the first.
  std::shared_ptr<const T> get() const {
    std::lock_guard<std::mutex> lock(m_mutex);
    return m_value;
  }
  /// How many values have been published: lets a poller see that there is a new one.
  std::uint64_t count() const {
    std::lock_guard<std::mutex> lock(m_mutex);
    return m_count;
  }
  void clear() {
    std::lock_guard<std::mutex> lock(m_mutex);
    m_value.reset();
  }

 private:
  mutable std::mutex m_mutex;
  std::shared_ptr<const T> m_value;
  std::uint64_t m_count = 0;
};

}  // namespace longarm
