#pragma once

/// @file
/// The robot's own links in snapshots: tinted, and told when a pick lands on one.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "planning/robot/link_mask.h"
#include "session/document/document.h"
#include "vision/sketch/pointer_event.h"

namespace longarm::session {

/// Where a picture shows the robot itself, by its model and the joints at the exposure.
struct OwnLinks {
  std::shared_ptr<const planning::RobotModel> model;
  planning::LinkMask mask;
  std::vector<vision::OverlayShape> areas;     ///< To be drawn under everything else.

  /// Name of the link at a raw pixel; empty: none.
  std::string linkAt(const Eigen::Vector2d& pixel) const;
};
using OwnLinksPtr = std::shared_ptr<const OwnLinks>;

/// Computes each picture's once, in some milliseconds.  Thread-compatible.
class OwnLinksCache {
 public:
  /// Null without a robot, or for a picture whose joints are not all known (one from a file).
  OwnLinksPtr of(const vision::SnapshotPtr& picture, const std::shared_ptr<const planning::Workcell>& workcell);
  /// The same for a camera that is not kept: what it would see of the robot now.
  std::shared_ptr<const planning::LinkMask> maskOf(const vision::View& view, const JointState& joints,
                                                   const planning::Workcell& workcell);

 private:
  const planning::LinkSilhouettes* silhouettesOf(const planning::Workcell& workcell);

  struct Entry {
    std::weak_ptr<const vision::Snapshot> picture;
    std::shared_ptr<const planning::RobotModel> model;
    OwnLinksPtr links;
  };
  std::unique_ptr<planning::LinkSilhouettes> m_silhouettes;
  std::map<SnapshotId, Entry> m_entries;
};

/// A placed pick that lies on the robot.
struct PickOnRobot {
  FeatureId item;
  int vertex = 0;
  PaneSide side = PaneSide::kLeft;
  std::string link;
};
/// Of the pictures in the panes; hidden features are left out.
std::vector<PickOnRobot> picksOnRobot(const Document& document, OwnLinksCache& cache);
/// "Line 1 is marked on the robot's own arm_4_link in head_left: ..."
std::string onRobotText(const Document& document, const PickOnRobot& pick);

}  // namespace longarm::session
