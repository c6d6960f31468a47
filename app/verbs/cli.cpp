#include "app/verbs/cli.h"

#include <algorithm>
#include <cstdio>
#include <iostream>

#include "core/printable.h"
#include "core/text.h"

namespace longarm::app {
namespace {

int exitOf(const Error& error) {
  return error.code == ErrorCode::kNoSolution || error.code == ErrorCode::kDegenerate ? kExitNoSolution
                                                                                      : kExitBadInput;
}

// Parser callback of nlohmann: refuses deep nesting before it costs a stack.
bool shallow(int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
  if (depth > 64) throw std::length_error("is nested deeper than 64 levels");
  return true;
}

}  // namespace

Answer noSolution(nlohmann::json json, const std::string& status, const std::string& reason) {
  json["status"] = status;
  json["reason"] = reason;
  return {std::move(json), status + ": " + reason + "\n", kExitNoSolution};
}

Cli::Cli()
    : m_app("Longarm: operator console for mobile manipulators.\n"
            "Without a verb it opens the console; with one it works without a display.") {
  m_app.set_version_flag("--version", "longarm " LONGARM_VERSION);
  m_app.require_subcommand(0, 1);
  m_app.fallthrough(false);
}

int Cli::run(int argc, char** argv, bool& opened) {
  opened = false;
  try {
    m_app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = m_app.exit(error);
    return code == 0 ? kExitDone : kExitUsage;
  }
  if (!m_chosen) {
    opened = true;
    return kExitDone;
  }
  try {
    return print(m_chosen());
  } catch (const std::exception& error) {
    return print(Error{ErrorCode::kInternal, std::string("unexpected: ") + error.what()});
  }
}

int Cli::print(const Result<Answer>& answer) const {
  nlohmann::json json;
  std::string table;
  int exit = kExitDone;
  if (answer.ok()) {
    json = answer->json;
    table = answer->table;
    exit = answer->exit;
  } else {
    exit = exitOf(answer.error());
    std::fprintf(stderr, "longarm: %s\n", printable(answer.error().message).c_str());
    if (exit == kExitBadInput) return exit;  // nothing was computed: no JSON
    json = {{"status", toString(answer.error().code)}, {"reason", answer.error().message}};
  }
  const std::string text =
      m_json ? json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n" : table;
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) != 0) return kExitBadInput;
  return exit;
}

nlohmann::json poseJson(const PoseInParent& pose) {
  const Eigen::Vector3d& t = pose.pose.translation();
  const Eigen::Vector4d q = quaternionXyzw(pose.pose.linear());
  return {{"parent", pose.parent}, {"xyz", {t.x(), t.y(), t.z()}}, {"quaternion_xyzw", {q[0], q[1], q[2], q[3]}}};
}

nlohmann::json vectorJson(const Eigen::VectorXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

Result<nlohmann::json> readJsonFile(const std::string& path) {
  auto text = readTextFile(path, 64u << 20);
  if (!text) return text.error();
  try {
    return nlohmann::json::parse(*text, shallow);
  } catch (const std::exception& error) {
    return Error{ErrorCode::kInvalidInput, path + ": is not JSON: " + error.what()};
  }
}

Result<Eigen::VectorXd> numbersOption(const std::string& option, const std::string& text) {
  const auto numbers = parseNumbers(text);
  if (!numbers) return Error{ErrorCode::kInvalidInput, option + ": " + numbers.error().message};
  Eigen::VectorXd v(static_cast<Eigen::Index>(numbers->size()));
  std::copy(numbers->begin(), numbers->end(), v.data());
  if (!v.allFinite()) return Error{ErrorCode::kInvalidInput, option + ": numbers must be finite"};
  return v;
}

std::string tableText(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      text += row[i];
      if (i + 1 < row.size()) text.append(widths[i] - row[i].size() + 2, ' ');
    }
    text += "\n";
  }
  return text;
}

}  // namespace longarm::app
