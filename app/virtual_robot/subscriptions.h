#pragma once

/// @file
/// Subscriptions: which topics the client wants, how often and how written.

#include <map>
#include <optional>
#include <string>

#include "hardware/rosbridge_codec/protocol.h"

namespace longarm::virtual_robot {

/// How a topic's messages are to be written now.
struct Delivery {
  rosbridge::Dialect dialect = rosbridge::Dialect::kRos1;
  bool cbor = false;
};

/// Subscriptions by topic and id, as rosbridge keeps them: the fastest of a topic counts.  Thread-compatible.
class Subscriptions {
 public:
  void add(const rosbridge::Subscribe& subscribe);
  /// Without an id: all of the topic.
  void remove(const rosbridge::Unsubscribe& unsubscribe);
  void clear() { m_topics.clear(); }

  bool wanted(const std::string& topic) const { return m_topics.count(topic) != 0; }
  /// Least time between two messages of a topic [s].
  double period_s(const std::string& topic) const;
  /// Whether a message of the topic goes out at now_s; takes the turn.
  std::optional<Delivery> take(const std::string& topic, double now_s);

 private:
  struct Topic {
    std::map<std::string, rosbridge::Subscribe> by_id;
    double last_s = -1e9;
  };
  std::map<std::string, Topic> m_topics;
};

}  // namespace longarm::virtual_robot
