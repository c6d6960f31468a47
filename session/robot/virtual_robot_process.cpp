#include "session/robot/virtual_robot_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/clock.h"
#include "core/resource_path.h"
#include "core/text.h"

extern char** environ;

namespace longarm::session {
namespace {

constexpr const char* kExecutable = "longarm-virtual-robot";
constexpr std::size_t kMaxLine = 4096;

Result<std::string> urlOf(const std::string& line) {
  const auto answer = nlohmann::json::parse(line, nullptr, false);
  if (!answer.is_object() || !answer.contains("url") || !answer["url"].is_string()) {
    return Error{ErrorCode::kInvalidInput,
                 "the virtual robot said \"" + line.substr(0, 200) + "\" where {\"url\": ...} was expected"};
  }
  return answer["url"].get<std::string>();
}

// Two ends of a pipe that a child does not inherit by itself.
struct Pipe {
  int read = -1, write = -1;
  bool open() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return false;
    read = ends[0], write = ends[1];
    return true;
  }
};

int spawn(const std::string& executable, const std::vector<std::string>& arguments, const Pipe& in,
          const Pipe& out) {
  std::vector<char*> argv{const_cast<char*>(executable.c_str())};
  for (const auto& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in.read, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out.write, STDOUT_FILENO);
  pid_t pid = -1;
  const int failed = posix_spawn(&pid, executable.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  errno = failed;
  return failed == 0 ? pid : -1;
}

}  // namespace

struct VirtualRobotProcess::Ending {
  std::mutex mutex;
  std::optional<int> status;

  // Collects the child's end if it has come.
  bool ended(int pid) {
    std::lock_guard<std::mutex> lock(mutex);
    int now = 0;
    if (!status && waitpid(pid, &now, WNOHANG) == pid) status = now;
    return status.has_value();
  }
  bool waitFor(int pid, double seconds) {
    const SteadyClock clock;
    for (const double end = clock.now_s() + seconds; clock.now_s() < end; usleep(5000)) {
      if (ended(pid)) return true;
    }
    return ended(pid);
  }
};

VirtualRobotProcess::VirtualRobotProcess(int pid, int input, int output)
    : m_pid(pid), m_input(input), m_output(output), m_ending(std::make_unique<Ending>()) {}

VirtualRobotProcess::~VirtualRobotProcess() {
  closeInput();
  if (!m_ending->waitFor(m_pid, 1)) {
    ::kill(m_pid, SIGTERM);
    if (!m_ending->waitFor(m_pid, 1)) {
      ::kill(m_pid, SIGKILL);
      m_ending->waitFor(m_pid, 5);
    }
  }
  ::close(m_output);
}

void VirtualRobotProcess::closeInput() {
  if (m_input >= 0) ::close(m_input);
  m_input = -1;
}

Result<std::string> VirtualRobotProcess::find(const std::string& wanted) {
  namespace fs = std::filesystem;
  std::vector<fs::path> places;
  if (!wanted.empty()) {
    places.emplace_back(wanted);
  } else if (const char* set = std::getenv("LONGARM_VIRTUAL_ROBOT"); set != nullptr && *set != '\0') {
    places.emplace_back(set);
  } else {
    fs::path folder = executableFolder();
    for (int i = 0; i < 4 && !folder.empty(); ++i, folder = folder.parent_path())
      places.push_back(folder / kExecutable);
  }
  std::string tried;
  for (const auto& place : places) {
    if (::access(place.c_str(), X_OK) == 0) return place.string();
    tried += (tried.empty() ? "" : ", ") + place.string();
  }
  return Error{ErrorCode::kNotFound, "the virtual robot's executable is not there; tried " + tried +
                                         "; build it or set LONGARM_VIRTUAL_ROBOT"};
}

Result<std::unique_ptr<VirtualRobotProcess>> VirtualRobotProcess::start(
    const std::string& executable, const std::vector<std::string>& arguments, double timeout_s) {
  Pipe in, out;
  if (!in.open() || !out.open())
    return Error{ErrorCode::kInternal, std::string("pipe: ") + std::strerror(errno)};
  const int pid = spawn(executable, arguments, in, out);
  const std::string why = pid < 0 ? std::strerror(errno) : "";
  ::close(in.read);
  ::close(out.write);
  if (pid < 0) {
    ::close(in.write);
    ::close(out.read);
    return Error{ErrorCode::kNotFound, "the virtual robot " + executable + " cannot be started: " + why};
  }
  std::unique_ptr<VirtualRobotProcess> process(new VirtualRobotProcess(pid, in.write, out.read));
  if (auto status = process->readUrl(timeout_s); !status) return status.error();
  return process;
}

Status VirtualRobotProcess::readUrl(double timeout_s) {
  const SteadyClock clock;
  const double end = clock.now_s() + timeout_s;
  std::string line;
  while (line.size() < kMaxLine) {
    const double left = end - clock.now_s();
    pollfd ready{m_output, POLLIN, 0};
    if (left <= 0 || ::poll(&ready, 1, static_cast<int>(left * 1000) + 1) == 0) {
      return {ErrorCode::kTimeout,
              "the virtual robot said no address within " + formatNumber(timeout_s) + " s of its start"};
    }
    char c = 0;
    const auto count = ::read(m_output, &c, 1);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      m_ending->waitFor(m_pid, 1);
      return {ErrorCode::kDisconnected, "the virtual robot " + ending() + " before it said its address"};
    }
    if (c == '\n') break;
    line += c;
  }
  const auto url = urlOf(line);
  if (!url) return url.error();
  m_url = *url;
  return {};
}

bool VirtualRobotProcess::running() const { return !m_ending->ended(m_pid); }

std::string VirtualRobotProcess::ending() const {
  if (!m_ending->ended(m_pid)) return {};
  const int status = *m_ending->status;
  if (WIFSIGNALED(status)) return "was killed by signal " + std::to_string(WTERMSIG(status));
  return "ended with status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace longarm::session
