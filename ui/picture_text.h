#pragma once

/// @file
/// How pictures are named to the operator.

#include <QString>

namespace longarm::ui {

/// "14:03:27" of a wall time [s since 1970]; empty when it is unknown.
QString pictureTime(double wall_s);

}  // namespace longarm::ui
