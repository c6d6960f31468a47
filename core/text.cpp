#include "core/text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include <unistd.h>

namespace longarm {
namespace {

template <typename T>
std::optional<T> parseWhole(std::string_view text) {
  text = trimmed(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  T value{};
  const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (ec != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return value;
}

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v'; }

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return text;
}

std::optional<double> parseNumber(std::string_view text) { return parseWhole<double>(text); }

std::optional<long long> parseInteger(std::string_view text) { return parseWhole<long long>(text); }

Result<std::vector<double>> parseNumbers(std::string_view text) {
  std::vector<double> numbers;
  std::size_t begin = 0;
  while (begin < text.size()) {
    while (begin < text.size() && (isBlank(text[begin]) || text[begin] == ',')) ++begin;
    std::size_t end = begin;
    while (end < text.size() && !isBlank(text[end]) && text[end] != ',') ++end;
    if (end == begin) break;
    const auto word = text.substr(begin, end - begin);
    const auto number = parseNumber(word);
    if (!number) {
      return Error{ErrorCode::kInvalidInput,
                   "\"" + std::string(word.substr(0, 40)) + "\" is not a number (write 1.5, not 1,5)"};
    }
    numbers.push_back(*number);
    begin = end;
  }
  return numbers;
}

std::string formatNumber(double value) {
  std::array<char, 64> buffer{};
  const auto [end, ec] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return ec == std::errc() ? std::string(buffer.data(), end) : std::string("nan");
}

std::string formatFixed(double value, int decimals) {
  std::array<char, 400> buffer{};
  const auto [end, ec] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                       std::chars_format::fixed, decimals);
  return ec == std::errc() ? std::string(buffer.data(), end) : std::string("nan");
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (;;) {
    const auto end = text.find(separator, begin);
    parts.emplace_back(text.substr(begin, end == std::string_view::npos ? end : end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

Result<std::string> readTextFile(const std::string& path, std::size_t max_bytes) {
  std::error_code ec;
  const auto status = std::filesystem::status(path, ec);
  if (ec || !std::filesystem::exists(status)) {
    return Error{ErrorCode::kNotFound, path + ": there is no such file"};
  }
  if (!std::filesystem::is_regular_file(status)) {
    return Error{ErrorCode::kInvalidInput, path + ": is not a regular file"};
  }
  const auto size = std::filesystem::file_size(path, ec);
  if (ec || size > max_bytes) {
    return Error{ErrorCode::kInvalidInput, path + ": is " + std::to_string(size) +
                                               " bytes; at most " + std::to_string(max_bytes) +
                                               " are read"};
  }
  std::ifstream in(path, std::ios::binary);
  std::string content(static_cast<std::size_t>(size), '\0');
  if (!in.read(content.data(), static_cast<std::streamsize>(size))) {
    return Error{ErrorCode::kInvalidInput, path + ": cannot be read"};
  }
  return content;
}

Status writeFileAtomically(const std::string& path, std::string_view content) {
  const std::string beside = path + ".tmp" + std::to_string(::getpid());
  {
    std::ofstream out(beside, std::ios::binary | std::ios::trunc);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.flush();
    if (!out) {
      std::remove(beside.c_str());
      return Error{ErrorCode::kInvalidInput,
                   path + ": cannot be written; check that the folder exists and has room"};
    }
  }
  std::error_code ec;
  std::filesystem::rename(beside, path, ec);
  if (ec) {
    std::remove(beside.c_str());
    return Error{ErrorCode::kInvalidInput, path + ": cannot be replaced: " + ec.message()};
  }
  return {};
}

}  // namespace longarm
