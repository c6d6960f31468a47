#pragma once

/// @file
/// LONGARM_REQUIRE: a broken precondition or invariant, which is our own bug, in every build.

#include <string>

namespace longarm {

/// Called once with "file:line: message" when a requirement is broken; must not return normally to the
/// caller's code (it aborts, or in tests throws).  The default prints to standard error and aborts.
using RequireHandler = void (*)(const std::string& what);

/// Installs a handler and returns the former one.  Thread-safe.
RequireHandler setRequireHandler(RequireHandler handler);

[[noreturn]] void requireFailed(const char* file, int line, const std::string& message);

}  // namespace longarm

#define LONGARM_REQUIRE(condition, message)                                  \
  do {                                                                       \
    if (!(condition)) ::longarm::requireFailed(__FILE__, __LINE__, message); \
  } while (false)
