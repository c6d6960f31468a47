#pragma once

/// @file
/// Which picture sees a place best: not past the robot's own links, and from a side that measures well.

#include <memory>
#include <string>
#include <vector>

#include "planning/robot/link_mask.h"
#include "vision/snapshot/view.h"

namespace longarm::session {

/// A picture that is there, or that a camera could take now.
struct ViewCandidate {
  SnapshotId snapshot;                     ///< Invalid: it would be taken.
  vision::View view;
  std::shared_ptr<const planning::LinkMask> mask;   ///< Null: nothing is known of the robot there.
};

struct ViewRank {
  std::size_t candidate = 0;               ///< Its index.
  double covered = 0;                      ///< Share of the surroundings of the place that nearer links hide.
  double parallax = 0;                     ///< Angle between its line of sight and that of the picture that stays [rad].
  double sigma_m = 0;                      ///< Of a point marked there in both, along the worst axis.
};

/// Best first: less hidden before more (in steps of a tenth), then the more exact.  Left out are views that do not see the
/// place, and those that together with `kept` cannot measure it.  Pure function.
/// @param place In the views' common parent [m].  @param kept The picture that stays in the other pane.
std::vector<ViewRank> rankViews(const Eigen::Vector3d& place, const vision::View& kept, const std::vector<ViewCandidate>& candidates);
/// Share of the surroundings of `place` that the robot hides in one view, 0 ... 1.
double hiddenShare(const ViewCandidate& candidate, const Eigen::Vector3d& place);
/// "0 % hidden, 14.2 degrees of parallax, +- 3.1 mm"
std::string rankText(const ViewRank& rank);

}  // namespace longarm::session
