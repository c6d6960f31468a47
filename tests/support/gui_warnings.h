#pragma once

/// @file
/// Any Qt warning fails a gui test that did not announce it.

namespace longarm::tests {

/// The next Qt warning is expected.
void announceQtWarning();

}  // namespace longarm::tests
