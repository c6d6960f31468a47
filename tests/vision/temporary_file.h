#pragma once

/// @file
/// A file that goes away with its test, and a decimal comma that goes away with its scope.

#include <clocale>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <unistd.h>

namespace longarm::tests {

/// A path of this process; the file is written when content is given, and removed at the end.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name)
      : m_path((std::filesystem::temp_directory_path() /
                ("longarm_" + std::to_string(::getpid()) + "_" + std::to_string(counter()++) + "_" + name))
                   .string()) {}
  TemporaryFile(const std::string& name, const std::string& content) : TemporaryFile(name) { write(content); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(m_path, ignored);
  }
  const std::string& path() const { return m_path; }
  void write(const std::string& content) const { std::ofstream(m_path, std::ios::binary) << content; }
  std::string content() const {
    std::ostringstream out;
    out << std::ifstream(m_path, std::ios::binary).rdbuf();
    return out.str();
  }

 private:
  static int& counter() {
    static int count = 0;
    return count;
  }
  std::string m_path;
};

/// Numbers of the C library have a decimal comma while this lives, where such a locale is installed.
class DecimalComma {
 public:
  DecimalComma() : m_before(std::setlocale(LC_ALL, nullptr)) {
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "nl_NL.UTF-8"}) {
      if (std::setlocale(LC_ALL, name) != nullptr) {
        m_active = *std::localeconv()->decimal_point == ',';
        if (m_active) return;
      }
    }
  }
  DecimalComma(const DecimalComma&) = delete;
  DecimalComma& operator=(const DecimalComma&) = delete;
  ~DecimalComma() { std::setlocale(LC_ALL, m_before.c_str()); }
  bool active() const { return m_active; }

 private:
  std::string m_before;
  bool m_active = false;
};

}  // namespace longarm::tests
