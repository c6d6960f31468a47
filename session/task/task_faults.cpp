#include "session/task/task_faults.h"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace longarm::session {
namespace {

constexpr double kLinkDelay_s = 0.1;     // each way
constexpr double kForGood = -1;

const std::vector<std::string>& knownFaults() {
  static const std::vector<std::string> names = {"link_cut",        "link_delay",     "frozen_camera",
                                                 "dark_camera",     "knocked_camera", "joint_stiction",
                                                 "slipping_grasp",  "moved_base",     "glare"};
  return names;
}

bool isLinkFault(const std::string& name) { return name.rfind("link_", 0) == 0; }

}  // namespace

Result<TaskFaults> TaskFaults::make(std::vector<std::string> names, bool lockstep) {
  const auto& known = knownFaults();
  for (const auto& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    std::string list;
    for (const auto& each : known) list += (list.empty() ? "" : ", ") + each;
    return Error{ErrorCode::kInvalidInput, "no fault is called \"" + name + "\"; there are " + list};
  }
  return TaskFaults(std::move(names), lockstep);
}

std::function<std::string(const std::string&)> TaskFaults::through() {
  if (m_lockstep || std::none_of(m_names.begin(), m_names.end(), isLinkFault)) return {};
  return [proxy = m_proxy](const std::string& url) {
    auto started = hardware::FaultProxy::start(url);
    if (!started) return url;            // the fault is then refused in its turn, with a sentence
    *proxy = std::move(*started);
    return (*proxy)->url();
  };
}

Status TaskFaults::strikeAt(double done, RobotRuntime& runtime) {
  while (m_next < m_names.size() &&
         done >= static_cast<double>(m_next + 1) / static_cast<double>(m_names.size() + 1)) {
    if (auto status = strike(m_names[m_next++], runtime); !status) return status;
  }
  return {};
}

Status TaskFaults::strike(const std::string& name, RobotRuntime& runtime) {
  if (isLinkFault(name) && !m_lockstep) {
    if (*m_proxy == nullptr) return {ErrorCode::kInternal, name + ": there is no proxy in the link"};
    if (name == "link_cut") {
      (*m_proxy)->cut(kForGood);
    } else {
      (*m_proxy)->setDelay(hardware::FaultProxy::Direction::kBoth, kLinkDelay_s);
    }
    return {};
  }
  const nlohmann::json arguments = {{"name", name}, {"duration_s", 0}, {"target", ""}};
  const auto started = runtime.callService("/virtual_robot/fault", arguments.dump());
  if (!started) return started.error();
  return {};
}

}  // namespace longarm::session
