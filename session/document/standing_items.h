#pragma once

/// @file
/// Where bodies that were measured before the base was driven stand now, as odometry has it.

#include <vector>

#include "session/document/document.h"

namespace longarm::session {

/// The document's bodies for planning and jogging: a stale one does not go with the base, but stands where odometry says, with
/// kOdometryShare of the way and of its distance for each radian turned as more margin.  It is only kept clear of; what may be
/// done with it waits for marks made again (session/commands/reregistration.h).  Pure function.
std::vector<WorldItem> standingItems(const Document& document);

/// Error of odometry, per way and angle gone.
constexpr double kOdometryShare = 0.02;

}  // namespace longarm::session
