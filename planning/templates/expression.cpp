#include "planning/templates/expression.h"

#include <cctype>
#include <cmath>
#include <string_view>

#include "core/text.h"

namespace longarm::planning {
namespace {

constexpr std::size_t kLongest = 200;
constexpr int kDeepest = 20;

/// Recursive descent: sum, product, sign, value.  After the first error everything is 0.
class Reader {
 public:
  Reader(const std::string& text, const std::map<std::string, double>& variables) : m_text(text), m_variables(variables) {}

  Result<double> run() {
    const double value = sum();
    skip();
    if (m_at < m_text.size()) fail("\"" + m_text.substr(m_at, 20) + "\" is not understood");
    if (m_error.empty() && !std::isfinite(value)) fail("has no finite value");
    if (!m_error.empty()) return Error{ErrorCode::kInvalidInput, "\"" + m_text.substr(0, 60) + "\": " + m_error};
    return value;
  }

 private:
  void fail(const std::string& what) {
    if (m_error.empty()) m_error = what;
  }
  void skip() {
    while (m_at < m_text.size() && std::isspace(static_cast<unsigned char>(m_text[m_at])) != 0) ++m_at;
  }
  bool take(char wanted) {
    skip();
    if (!m_error.empty() || m_at >= m_text.size() || m_text[m_at] != wanted) return false;
    ++m_at;
    return true;
  }

  double sum() {
    double value = product();
    for (;;) {
      if (take('+')) value += product();
      else if (take('-')) value -= product();
      else return value;
    }
  }

  double product() {
    double value = signedValue();
    for (;;) {
      if (take('*')) {
        value *= signedValue();
      } else if (take('/')) {
        const double by = signedValue();
        if (m_error.empty() && by == 0) fail("is divided by zero");
        value = by == 0 ? 0 : value / by;
      } else {
        return value;
      }
    }
  }

  double signedValue() {
    bool negative = false;
    for (;;) {
      if (take('-')) negative = !negative;
      else if (!take('+')) break;
    }
    const double value = plainValue();
    return negative ? -value : value;
  }

  double bracket() {
    if (++m_depth > kDeepest) fail("has too many brackets");
    const double value = m_error.empty() ? sum() : 0;
    --m_depth;
    if (!take(')')) fail("a bracket is not closed");
    return value;
  }

  double plainValue() {
    if (take('(')) return bracket();
    skip();
    const std::size_t begin = m_at;
    while (m_at < m_text.size() && isPart(m_text[m_at])) ++m_at;
    const std::string word = m_text.substr(begin, m_at - begin);
    if (word.empty()) {
      fail("a value is missing");
      return 0;
    }
    if ((word == "sin" || word == "cos") && take('(')) {
      const double angle = bracket();
      return word == "sin" ? std::sin(angle) : std::cos(angle);
    }
    const auto named = m_variables.find(word);
    if (named != m_variables.end()) return named->second;
    const auto number = parseNumber(word);
    if (!number) fail("\"" + word.substr(0, 30) + "\" is neither a number nor a parameter");
    return number.value_or(0);
  }

  static bool isPart(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; }

  const std::string& m_text;
  const std::map<std::string, double>& m_variables;
  std::size_t m_at = 0;
  int m_depth = 0;
  std::string m_error;
};

}  // namespace

Result<double> evaluate(const std::string& text, const std::map<std::string, double>& variables) {
  if (text.size() > kLongest) {
    return Error{ErrorCode::kInvalidInput, "\"" + text.substr(0, 60) + "...\": longer than " + std::to_string(kLongest) + " characters"};
  }
  return Reader(text, variables).run();
}

}  // namespace longarm::planning
