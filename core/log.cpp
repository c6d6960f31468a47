#include "core/log.h"

#include <cstdio>
#include <mutex>

namespace longarm {
namespace {

std::mutex g_mutex;
LogSink g_sink;

void printLine(LogLevel level, const std::string& category, const std::string& text) {
  if (level < LogLevel::kWarning) return;
  std::fprintf(stderr, "%s: %s: %s\n", level == LogLevel::kError ? "error" : "warning",
               category.c_str(), text.c_str());
}

}  // namespace

void setLogSink(LogSink sink) {
  std::lock_guard<std::mutex> lock(g_mutex);
  g_sink = std::move(sink);
}

void logLine(LogLevel level, const std::string& category, const std::string& text) noexcept {
  try {
    std::lock_guard<std::mutex> lock(g_mutex);
    if (g_sink) {
      g_sink(level, category, text);
    } else {
      printLine(level, category, text);
    }
  } catch (...) {  // a log line is never worth a crash
  }
}

}  // namespace longarm
