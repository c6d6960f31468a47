#pragma once

/// @file
/// A first look at an XML file before any parser builds a tree of it: size, depth, element count, no DTD.

#include <cstddef>
#include <string>
#include <string_view>

#include "core/result.h"

namespace longarm::planning::internal {

struct XmlBounds {
  std::size_t max_bytes = 8u << 20;
  int max_depth = 64;
  int max_elements = 10000;
};

/// Whole text of an XML file that stays within the bounds.  Linear in the size of the file.
/// @returns kNotFound, or kInvalidInput naming file, line, the value met and the limit.  Pure function.
Result<std::string> readBoundedXml(const std::string& path, const XmlBounds& bounds = {});

/// The check alone; `name` stands for the file in messages.
Status checkXmlBounds(std::string_view text, const std::string& name, const XmlBounds& bounds = {});

/// 1-based line of a byte offset.
int lineOfOffset(std::string_view text, std::size_t offset);

}  // namespace longarm::planning::internal
