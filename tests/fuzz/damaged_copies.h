#pragma once

/// @file
/// Feeds damaged copies of a good file to a reader and judges every answer.

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include <unistd.h>

#include <gtest/gtest.h>

#include "core/result.h"
#include "tests/support/fuzz.h"

namespace longarm::tests {

constexpr int kCopies = 1000;                            ///< Of each kind of file.
constexpr std::chrono::seconds kLongest{30};             ///< An answer that takes longer is a hang.

/// A folder that goes away with its test.
class ScratchFolder {
 public:
  ScratchFolder()
      : m_path(std::filesystem::temp_directory_path() /
               ("longarm_fuzz_" + std::to_string(::getpid()) + "_" +
                testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::remove_all(m_path);
    std::filesystem::create_directories(m_path);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(m_path, ignored);
  }
  std::string file(const std::string& name) const { return (m_path / name).string(); }
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(file(name), std::ios::binary) << content;
    return file(name);
  }
  const std::filesystem::path& path() const { return m_path; }

 private:
  std::filesystem::path m_path;
};

inline std::string contentOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// One line for a terminal: UTF-8 or ASCII, no control characters, not endless.
inline std::string faultOfSentence(const std::string& text) {
  if (text.size() > 1500) return "is " + std::to_string(text.size()) + " characters long";
  for (const unsigned char c : text) {
    if (c < 0x20 || c == 0x7F) return "holds the control character " + std::to_string(c);
  }
  return "";
}

/// What a reader made of a file: nothing wrong, or its refusal.
using Reader = std::function<Status(const std::string& path)>;

struct DamageFigures {
  int taken = 0, refused = 0;
};

/// Judges one answer: a refusal is one sentence that names the file and says more than that.
inline void judge(const Status& answer, const std::string& path, const std::string& which, DamageFigures* figures) {
  if (answer.ok()) {
    ++figures->taken;
    return;
  }
  ++figures->refused;
  const Error& error = answer.error();
  EXPECT_TRUE(error.code == ErrorCode::kInvalidInput || error.code == ErrorCode::kOutOfLimits ||
              error.code == ErrorCode::kNotFound || error.code == ErrorCode::kDegenerate)
      << which << ": " << toString(error.code) << ": " << error.message;
  EXPECT_EQ(faultOfSentence(error.message), "") << which << ": " << error.message;
  EXPECT_NE(error.message.find(path), std::string::npos) << which << " names the file: " << error.message;
  EXPECT_GT(error.message.size(), path.size() + 15) << which << " says what is wrong: " << error.message;
}

/// Reads the good file and `copies` damaged ones, written under `name`.
inline DamageFigures readDamagedCopies(const ScratchFolder& folder, const std::string& name, const std::string& good,
                                       const Reader& reader, int copies = kCopies) {
  DamageFigures figures;
  const std::string path = folder.write(name, good);
  const Status whole = reader(path);
  EXPECT_TRUE(whole.ok()) << "the undamaged file: " << (whole.ok() ? "" : whole.error().message);
  for (int seed = 0; seed < copies && !testing::Test::HasFailure(); ++seed) {
    folder.write(name, mutate(good, static_cast<std::uint64_t>(seed)));
    const auto start = std::chrono::steady_clock::now();
    judge(reader(path), path, name + " seed " + std::to_string(seed), &figures);
    EXPECT_LT(std::chrono::steady_clock::now() - start, kLongest) << name << " seed " << seed;
  }
  testing::Test::RecordProperty(name + "_refused", figures.refused);
  return figures;
}

}  // namespace longarm::tests
