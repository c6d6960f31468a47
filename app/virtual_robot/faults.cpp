#include "app/virtual_robot/faults.h"

#include <algorithm>
#include <limits>

namespace longarm::virtual_robot {
namespace {

constexpr double kMidMotion_s = 1.0;

}  // namespace

const std::vector<std::string>& faultNames() {
  static const std::vector<std::string> names = {"link_cut",        "link_delay",     "frozen_camera",
                                                 "dark_camera",     "knocked_camera", "joint_stiction",
                                                 "slipping_grasp",  "moved_base",     "glare"};
  return names;
}

FaultBoard::FaultBoard(std::vector<planning::ScenarioFault> planned) : m_planned(std::move(planned)) {}

Status FaultBoard::start(const std::string& name, double now_s, double duration_s, const std::string& target) {
  if (name == "clear") {
    m_active.clear();
    m_planned.clear();
    return {};
  }
  const auto& known = faultNames();
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    std::string list;
    for (const auto& each : known) list += each + ", ";
    return {ErrorCode::kNotFound, "no fault is called \"" + name + "\"; there are " + list + "clear"};
  }
  const double until_s = duration_s > 0 ? now_s + duration_s : std::numeric_limits<double>::infinity();
  m_active.erase(std::remove_if(m_active.begin(), m_active.end(),
                                [&](const Active& a) { return a.name == name && a.target == target; }),
                 m_active.end());
  m_active.push_back({name, target, until_s});
  return {};
}

void FaultBoard::tick(double now_s, bool arm_moves, double seconds) {
  if (arm_moves) m_moved_s += seconds;
  for (auto it = m_planned.begin(); it != m_planned.end();) {
    const bool due = it->at_s ? now_s >= *it->at_s : m_moved_s >= kMidMotion_s;
    if (!due) {
      ++it;
      continue;
    }
    const planning::ScenarioFault fault = *it;
    it = m_planned.erase(it);
    (void)start(fault.name, now_s, fault.duration_s, fault.target).ok();
  }
  m_active.erase(std::remove_if(m_active.begin(), m_active.end(),
                                [now_s](const Active& a) { return a.until_s <= now_s; }),
                 m_active.end());
}

const FaultBoard::Active* FaultBoard::find(const std::string& name) const {
  const auto it = std::find_if(m_active.begin(), m_active.end(), [&](const Active& a) { return a.name == name; });
  return it == m_active.end() ? nullptr : &*it;
}

bool FaultBoard::active(const std::string& name) const { return find(name) != nullptr; }

std::optional<std::string> FaultBoard::target(const std::string& name) const {
  const Active* fault = find(name);
  return fault == nullptr ? std::nullopt : std::optional<std::string>(fault->target);
}

bool FaultBoard::strikes(const std::string& name, const std::string& candidate, const std::string& usual) const {
  return std::any_of(m_active.begin(), m_active.end(), [&](const Active& a) {
    return a.name == name && (a.target.empty() ? usual : a.target) == candidate;
  });
}

std::vector<std::string> FaultBoard::names() const {
  std::vector<std::string> out;
  for (const auto& a : m_active) out.push_back(a.name);
  return out;
}

}  // namespace longarm::virtual_robot
