#pragma once

/// @file
/// PlayOrder: how a loaded motion is to be played.

#include <optional>

namespace longarm::session {

/// A value.
struct PlayOrder {
  std::optional<double> until_s;  ///< Rest there, at the end of a stage; empty: to the end.
  bool only_held = false;         ///< Hold to run: pauses by itself unless keepRunning() is repeated.
};

}  // namespace longarm::session
