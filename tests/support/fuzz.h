#pragma once

/// @file
/// Seeded damage to good files: bits, bytes, lines, numbers, lengths.  The same seed gives the same bytes.

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace longarm::tests {

/// One to four random injuries to `good`, chosen by `seed`.  The result is at most 4 kB longer.
inline std::string mutate(const std::string& good, std::uint64_t seed) {
  std::mt19937_64 rng(seed * 0x9E3779B97F4A7C15ull + 1);
  const auto below = [&rng](std::size_t n) { return n == 0 ? std::size_t{0} : rng() % n; };
  static const std::vector<std::string> kTokens = {
      "-1", "0", "1e308", "-1e308", "1e-320", "nan", ".nan", ".inf", "-inf", "1,5", "4294967296", "9223372036854775808",
      "99999999999999999999999", "\"", "'", "{", "}", "[", "]", "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[", ":", "- ", "&a", "*a", "!!", "%", "<", ">",
      "</", "<!--", "<![CDATA[", "&lt;", "\n", "\r", "\t", std::string(1, '\0'), "\xff\xfe", "\xef\xbb\xbf", "#", "---\n", "...", "~", "null", "true",
      "0x10", "1.5.5", "|\n", ">\n", "? ", ", ,"};
  std::string out = good;
  const std::size_t injuries = 1 + below(4);
  for (std::size_t i = 0; i < injuries; ++i) {
    const std::size_t at = below(out.size() + 1);
    const std::size_t length = std::min(out.size() - at, 1 + below(1 + below(64)));
    switch (below(8)) {
      case 0:  // flip a bit
        if (at < out.size()) out[at] = static_cast<char>(out[at] ^ (1 << below(8)));
        break;
      case 1:  // overwrite bytes
        for (std::size_t k = 0; k < length; ++k) out[at + k] = static_cast<char>(rng());
        break;
      case 2: out.erase(at, length); break;
      case 3: out.insert(at, out.substr(at, length)); break;
      case 4: out.resize(at); break;
      case 5: out.insert(at, kTokens[below(kTokens.size())]); break;
      case 6: {  // replace a run of digits by a token
        const std::size_t digit = out.find_first_of("0123456789", at);
        if (digit == std::string::npos) break;
        const std::size_t end = std::min(out.find_first_not_of("0123456789.eE+-", digit), out.size());
        out.replace(digit, end - digit, kTokens[below(kTokens.size())]);
        break;
      }
      default: {  // swap two lines, or insert a long run of one character
        if (below(2) == 0) {
          out.insert(at, std::string(1 + below(512), static_cast<char>(rng())));
        } else {
          const std::size_t line = out.rfind('\n', at);
          const std::size_t next = line == std::string::npos ? line : out.find('\n', line + 1);
          if (next != std::string::npos) out.append(out.substr(line, next - line));
        }
      }
    }
    if (out.size() > good.size() + 4096) out.resize(good.size() + 4096);
  }
  return out;
}

}  // namespace longarm::tests
