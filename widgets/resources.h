#pragma once

/// @file
/// Icons and styles compiled into the static library.

namespace longarm::widgets {

/// Registers them; call once before the first widget.  Harmless when called again.
void initResources();

}  // namespace longarm::widgets
