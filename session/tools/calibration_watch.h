#pragma once

/// @file
/// What picks that are not held to their curve say about the calibration.

#include <string>
#include <vector>

#include "session/document/document.h"
#include "vision/stereo/epipolar_band.h"

namespace longarm::session {

/// All picks of two cameras, in whatever snapshots of theirs.
struct PairMisses {
  std::string first, second;               ///< Names of the views.
  vision::MissStatistic statistic;
};

/// A pick further off its curve than calibration and pick noise explain.
struct OffBandPick {
  FeatureId item;
  int vertex = 0;
  SnapshotId from, to;                     ///< The curve is that of the pick in `from`.
  double off_px = 0, limit_px = 0;         ///< Distance from the curve, and three sigma of it.
};

struct CalibrationConcern {
  std::vector<PairMisses> pairs;
  std::vector<OffBandPick> off;

  const PairMisses* pair(const std::string& a, const std::string& b) const;
};

/// Only picks count that were placed freely, released from the curve or matched: one that was slid along its curve cannot
/// miss it.  Pure function of the document.
CalibrationConcern calibrationConcern(const Document& document);

/// A sentence for the operator; empty when all is as it should be.
std::string calibrationWarning(const Document& document, const CalibrationConcern& concern);

}  // namespace longarm::session
