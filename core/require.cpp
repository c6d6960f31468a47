#include "core/require.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace longarm {
namespace {

void printAndAbort(const std::string& what) {
  std::fprintf(stderr, "longarm: internal error: %s\n", what.c_str());
  std::abort();
}

std::atomic<RequireHandler> g_handler{&printAndAbort};

}  // namespace

RequireHandler setRequireHandler(RequireHandler handler) {
  return g_handler.exchange(handler != nullptr ? handler : &printAndAbort);
}

void requireFailed(const char* file, int line, const std::string& message) {
  g_handler.load()(std::string(file) + ":" + std::to_string(line) + ": " + message);
  std::abort();
}

}  // namespace longarm
