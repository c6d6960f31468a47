#pragma once

/// @file
/// `Result<T>`: the value of an operation that can fail in a correct program, or the sentence that says why.

#include <string>
#include <utility>
#include <variant>

namespace longarm {

/// Stable classes of failure.  The sentence in Error::message is for people, the code for programs.
enum class ErrorCode {
  kInvalidInput,   ///< A file, option or argument does not hold what it must.
  kNotFound,       ///< A named thing does not exist.
  kDegenerate,     ///< Well-formed input that does not determine the answer (parallel rays, ...).
  kOutOfLimits,    ///< A joint, speed, size or count limit would be broken.
  kNoSolution,     ///< Searched, and nothing fits.
  kCollision,      ///< The motion or pose touches something.
  kTimeout,        ///< Took longer than its budget.
  kCancelled,      ///< Somebody asked to stop.
  kStale,          ///< State, plan or picture is too old to act upon.
  kRefused,        ///< Not allowed now (no authority, stopped, wrong mode).
  kDisconnected,   ///< The peer is gone.
  kInternal        ///< A third-party library failed in a way we did not foresee.
};

/// The stable lower-case word of a code ("invalid_input"), as printed under "status" in JSON.
const char* toString(ErrorCode code);

/// Why something failed: what, the value, the limit, what to do.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
};

/// Either a T or an Error.  Thread-compatible value type.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : m_content(std::move(value)) {}                       // NOLINT: implicit on purpose
  Result(Error error) : m_content(std::move(error)) {}                   // NOLINT
  Result(ErrorCode code, std::string message) : m_content(Error{code, std::move(message)}) {}

  bool ok() const { return std::holds_alternative<T>(m_content); }
  explicit operator bool() const { return ok(); }
  /// @pre ok()
  const T& value() const& { return std::get<T>(m_content); }
  T& value() & { return std::get<T>(m_content); }
  T&& value() && { return std::get<T>(std::move(m_content)); }
  const T& operator*() const& { return value(); }
  T& operator*() & { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  const T* operator->() const { return &value(); }
  T* operator->() { return &value(); }
  /// @pre !ok()
  const Error& error() const { return std::get<Error>(m_content); }
  T valueOr(T fallback) const { return ok() ? value() : std::move(fallback); }

 private:
  std::variant<T, Error> m_content;
};

/// Success, or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : m_error(std::move(error)), m_ok(false) {}        // NOLINT
  Result(ErrorCode code, std::string message) : m_error{code, std::move(message)}, m_ok(false) {}
  bool ok() const { return m_ok; }
  explicit operator bool() const { return m_ok; }
  const Error& error() const { return m_error; }

 private:
  Error m_error;
  bool m_ok = true;
};

using Status = Result<void>;

}  // namespace longarm
