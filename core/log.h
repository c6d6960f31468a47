#pragma once

/// @file
/// Log lines by category.  Where they go is decided once by the program (`setLogSink`); the default is
/// standard error from `kWarning` up.

#include <functional>
#include <string>

namespace longarm {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

using LogSink = std::function<void(LogLevel level, const std::string& category, const std::string& text)>;

/// Thread-safe.  An empty sink restores the default.
void setLogSink(LogSink sink);
/// Thread-safe, never throws.  `category` is dotted, e.g. "hardware.rosbridge".
void logLine(LogLevel level, const std::string& category, const std::string& text) noexcept;

}  // namespace longarm
