#include "planning/motion/clearance.h"

#include <algorithm>

namespace longarm::planning {

ClearanceBand bandOf(double distance) {
  if (distance < kTightClearance) return ClearanceBand::kTight;
  return distance < kNearClearance ? ClearanceBand::kNear : ClearanceBand::kFree;
}

double clearanceAt(const ClearanceProfile& profile, double t_s) {
  const auto after = std::lower_bound(profile.begin(), profile.end(), t_s, [](const ClearanceSample& s, double t) { return s.t_s < t; });
  if (after == profile.end()) return profile.back().distance;
  double least = after == profile.begin() || after->t_s == t_s ? after->distance : std::min(std::prev(after)->distance, after->distance);
  for (auto same = after; same != profile.end() && same->t_s == t_s; ++same) least = std::min(least, same->distance);   // two stages meet
  return least;
}

const ClearanceSample& leastClearance(const ClearanceProfile& profile) {
  return *std::min_element(profile.begin(), profile.end(),
                           [](const ClearanceSample& a, const ClearanceSample& b) { return a.distance < b.distance; });
}

}  // namespace longarm::planning
