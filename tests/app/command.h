#pragma once

/// @file
/// Runs the built `longarm` as a script would.

#include <array>
#include <cstdio>
#include <string>

#include <sys/wait.h>

#include <nlohmann/json.hpp>

namespace longarm::tests {

struct CommandResult {
  int exit = -1;                 ///< -1: ended by a signal.
  std::string out, err;
  nlohmann::json json() const { return nlohmann::json::parse(out, nullptr, false); }
};

inline std::string slurp(const std::string& path) {
  std::string text;
  if (FILE* file = std::fopen(path.c_str(), "rb")) {
    std::array<char, 4096> buffer{};
    for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), file)) > 0;) text.append(buffer.data(), n);
    std::fclose(file);
  }
  return text;
}

/// @param arguments as typed in a shell.
inline CommandResult longarm(const std::string& arguments) {
  static int counter = 0;
  const std::string err = testing::TempDir() + "longarm_err_" + std::to_string(::getpid()) + "_" + std::to_string(counter++);
  CommandResult result;
  FILE* pipe = ::popen(("env -u DISPLAY -u WAYLAND_DISPLAY -u QT_QPA_PLATFORM " LONGARM_BINARY " " + arguments + " 2>" + err).c_str(), "r");
  std::array<char, 4096> buffer{};
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) result.out.append(buffer.data(), n);
  const int status = ::pclose(pipe);
  if (WIFEXITED(status)) result.exit = WEXITSTATUS(status);
  result.err = slurp(err);
  std::remove(err.c_str());
  return result;
}

}  // namespace longarm::tests
