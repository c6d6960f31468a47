#pragma once

/// @file
/// VirtualRobotProcess: longarm-virtual-robot as a child.

#include <memory>
#include <string>
#include <vector>

#include "core/result.h"

namespace longarm::session {

/// Owns one child process.  Thread-safe.  The child ends with its parent, because its standard input closes.
class VirtualRobotProcess {
 public:
  /// Where the executable is: `wanted` if not empty, $LONGARM_VIRTUAL_ROBOT, beside the running executable or
  /// up to three folders above it.  @returns kNotFound naming the places tried.
  static Result<std::string> find(const std::string& wanted);
  /// Starts it and waits for the line {"url": "ws://..."}.
  /// @returns kNotFound when it cannot be started, kDisconnected when it ends before saying its address (with
  /// how it
  ///   ended), kTimeout, kInvalidInput for a line that is something else.
  static Result<std::unique_ptr<VirtualRobotProcess>> start(const std::string& executable,
                                                            const std::vector<std::string>& arguments,
                                                            double timeout_s = 10);
  ~VirtualRobotProcess();  ///< Asks it to end, after a second insists.

  const std::string& url() const { return m_url; }
  int pid() const { return m_pid; }
  bool running() const;
  /// "ended with status 3" or "was killed by signal 9"; empty while it runs.
  std::string ending() const;

 private:
  VirtualRobotProcess(int pid, int input, int output);
  Status readUrl(double timeout_s);
  void closeInput();

  int m_pid;
  int m_input, m_output;  // Our ends of its standard streams.
  std::string m_url;
  struct Ending;
  std::unique_ptr<Ending> m_ending;
};

}  // namespace longarm::session
