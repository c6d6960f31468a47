#include "hardware/drivers/rosbridge/outbox.h"

#include <algorithm>
#include <utility>

namespace longarm::hardware {

Status Outbox::push(Item item) {
  if (m_items.size() >= m_capacity) {
    return {ErrorCode::kRefused, std::to_string(m_items.size()) +
                                     " messages to the robot wait already; the link does not keep up"};
  }
  m_items.push_back(std::move(item));
  return {};
}

void Outbox::pushUrgent(std::string text) {
  const auto motion = std::remove_if(m_items.begin(), m_items.end(), [](const Item& item) { return item.motion; });
  m_dropped += static_cast<std::size_t>(m_items.end() - motion);
  m_items.erase(motion, m_items.end());
  if (m_urgent.size() >= m_capacity) m_urgent.pop_front();   // the newest stop says it all
  m_urgent.push_back(std::move(text));
}

std::optional<Outbox::Next> Outbox::pop(double now_s) {
  if (!m_urgent.empty()) {
    Next out{std::move(m_urgent.front()), true};
    m_urgent.pop_front();
    return out;
  }
  while (!m_items.empty()) {
    Item item = std::move(m_items.front());
    m_items.pop_front();
    if (!item.motion || item.deadline_s >= now_s) return Next{std::move(item.text), false};
    ++m_dropped;
  }
  return std::nullopt;
}

void Outbox::clear() {
  m_urgent.clear();
  m_items.clear();
}

}  // namespace longarm::hardware
