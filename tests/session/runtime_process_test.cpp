#include <signal.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <fstream>

#include <gtest/gtest.h>

#include "session/robot/virtual_robot_process.h"

namespace longarm::session {
namespace {

// A little shell program in place of the virtual robot.
std::string program(const std::string& name, const std::string& body) {
  const std::string path = ::testing::TempDir() + "runtime_" + name + ".sh";
  std::ofstream(path) << "#!/bin/sh\n" << body << "\n";
  chmod(path.c_str(), 0755);
  return path;
}

TEST(VirtualRobotProcess, ReadsTheAddressAndEndsWithItsInput) {
  auto process = VirtualRobotProcess::start(
      program("good", "echo '{\"url\":\"ws://127.0.0.1:4711\"}'\ncat > /dev/null"), {});
  ASSERT_TRUE(process.ok()) << process.error().message;
  EXPECT_EQ((*process)->url(), "ws://127.0.0.1:4711");
  EXPECT_TRUE((*process)->running());
  EXPECT_TRUE((*process)->ending().empty());
}

TEST(VirtualRobotProcess, PassesItsArgumentsOn) {
  auto process = VirtualRobotProcess::start(program("args", "echo '{\"url\":\"'$2'\"}'\ncat > /dev/null"),
                                            {"--seed", "ws://7"});
  ASSERT_TRUE(process.ok()) << process.error().message;
  EXPECT_EQ((*process)->url(), "ws://7");
}

TEST(VirtualRobotProcess, SaysHowItEndedWhenItEndsTooEarly) {
  const auto process = VirtualRobotProcess::start(program("early", "exit 3"), {});
  ASSERT_FALSE(process.ok());
  EXPECT_EQ(process.error().code, ErrorCode::kDisconnected);
  EXPECT_NE(process.error().message.find("ended with status 3"), std::string::npos)
      << process.error().message;
}

TEST(VirtualRobotProcess, RefusesALineThatIsNoAddress) {
  const auto process = VirtualRobotProcess::start(program("wrong", "echo hello\ncat > /dev/null"), {});
  ASSERT_FALSE(process.ok());
  EXPECT_EQ(process.error().code, ErrorCode::kInvalidInput);
  EXPECT_NE(process.error().message.find("hello"), std::string::npos);
}

TEST(VirtualRobotProcess, GivesUpOnASilentProgram) {
  const auto process = VirtualRobotProcess::start(program("silent", "cat > /dev/null"), {}, 0.2);
  ASSERT_FALSE(process.ok());
  EXPECT_EQ(process.error().code, ErrorCode::kTimeout);
}

TEST(VirtualRobotProcess, KnowsThatItWasKilled) {
  auto process =
      VirtualRobotProcess::start(program("killed", "echo '{\"url\":\"ws://x\"}'\nexec cat > /dev/null"), {});
  ASSERT_TRUE(process.ok());
  ::kill((*process)->pid(), SIGKILL);
  while ((*process)->running()) continue;
  EXPECT_EQ((*process)->ending(), "was killed by signal 9");
}

TEST(VirtualRobotProcess, NamesThePlacesWhereItLookedForTheExecutable) {
  const auto found = VirtualRobotProcess::find("/nowhere/longarm-virtual-robot");
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().code, ErrorCode::kNotFound);
  EXPECT_NE(found.error().message.find("/nowhere/longarm-virtual-robot"), std::string::npos);
  EXPECT_FALSE(VirtualRobotProcess::start("/nowhere/longarm-virtual-robot", {}).ok());
}

TEST(VirtualRobotProcess, TakesTheExecutableFromTheEnvironment) {
  const auto path = program("env", "exit 0");
  setenv("LONGARM_VIRTUAL_ROBOT", path.c_str(), 1);
  const auto found = VirtualRobotProcess::find("");
  unsetenv("LONGARM_VIRTUAL_ROBOT");
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(*found, path);
}

}  // namespace
}  // namespace longarm::session
