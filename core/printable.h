#pragma once

/// @file
/// Text from files and networks made fit to be shown: one line, valid UTF-8, no control characters, not endless.

#include <string>
#include <string_view>
#include <utility>

#include "core/result.h"

namespace longarm {

/// `text` with line ends and tabs as blanks, other control characters and broken UTF-8 as '?', cut to about
/// `most` bytes.  Messages that quote a file must pass here, or a damaged file writes to the terminal what it
/// likes.  Pure function.
std::string printable(std::string_view text, std::size_t most = 1000);

/// The same done to the message.
Error printable(Error error);

/// A value as it is, an error with its message made printable: the last step of every reader of files.
template <typename T>
Result<T> printable(Result<T> result) {
  if (result.ok()) return result;
  return printable(result.error());
}

}  // namespace longarm
