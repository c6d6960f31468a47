#pragma once

/// @file
/// Data by others, found by the environment variable LONGARM_DATA; tests skip without it.

#include <cstdlib>
#include <string>

namespace longarm::tests {

/// Folder of the data sets, or empty.
inline std::string dataFolder() {
  const char* folder = std::getenv("LONGARM_DATA");
  return folder != nullptr ? folder : "";
}

}  // namespace longarm::tests

#define LONGARM_SKIP_WITHOUT_DATA() \
  if (::longarm::tests::dataFolder().empty()) GTEST_SKIP() << "skipped: no data (set LONGARM_DATA)"
