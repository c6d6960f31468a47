#include "app/virtual_robot/subscriptions.h"

#include <algorithm>
#include <limits>

namespace longarm::virtual_robot {
namespace {

constexpr std::size_t kMaxTopics = 256, kMaxIds = 64;

}  // namespace

void Subscriptions::add(const rosbridge::Subscribe& subscribe) {
  if (m_topics.size() >= kMaxTopics && !wanted(subscribe.topic)) return;
  auto& ids = m_topics[subscribe.topic].by_id;
  if (ids.size() < kMaxIds || ids.count(subscribe.id) != 0) ids[subscribe.id] = subscribe;
}

void Subscriptions::remove(const rosbridge::Unsubscribe& unsubscribe) {
  const auto found = m_topics.find(unsubscribe.topic);
  if (found == m_topics.end()) return;
  if (unsubscribe.id.empty()) {
    found->second.by_id.clear();
  } else {
    found->second.by_id.erase(unsubscribe.id);
  }
  if (found->second.by_id.empty()) m_topics.erase(found);
}

double Subscriptions::period_s(const std::string& topic) const {
  const auto found = m_topics.find(topic);
  if (found == m_topics.end()) return std::numeric_limits<double>::infinity();
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [id, subscribe] : found->second.by_id) {
    least = std::min(least, std::max(0, subscribe.throttle_rate_ms) / 1000.0);
  }
  return least;
}

std::optional<Delivery> Subscriptions::take(const std::string& topic, double now_s) {
  const auto found = m_topics.find(topic);
  if (found == m_topics.end() || now_s - found->second.last_s < period_s(topic) - 1e-6) return {};
  found->second.last_s = now_s;
  Delivery out;
  for (const auto& [id, subscribe] : found->second.by_id) {
    if (subscribe.compression == "cbor") out.cbor = true;
    if (subscribe.type.find("/msg/") != std::string::npos) out.dialect = rosbridge::Dialect::kRos2;
  }
  return out;
}

}  // namespace longarm::virtual_robot
