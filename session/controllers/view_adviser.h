#pragma once

/// @file
/// ViewAdviser: proposes the picture, or the camera, that sees best what is marked.

#include <memory>
#include <string>

#include "core/result.h"
#include "session/controllers/robot_feed.h"
#include "session/controllers/targeting_controller.h"
#include "session/tools/clearest_view.h"

namespace longarm::session {

struct ViewAdvice {
  PaneSide side = PaneSide::kLeft;         ///< Where it should be shown.
  SnapshotId snapshot;                     ///< Invalid: a picture of `camera` is to be taken.
  std::string camera;
  bool already_shown = false;              ///< Nothing is clearer than what is there.
  std::string text;                        ///< A sentence that says so, with the figures of both.
};

/// GUI thread only.
class ViewAdviser {
 public:
  /// Borrowed; both outlive this.
  ViewAdviser(const Document& document, TargetingController& targeting) : m_document(document), m_targeting(targeting) {}

  /// The connected robot, whose cameras could take another picture; null: only pictures that are there are proposed.
  void setFeed(const RobotFeed* feed) { m_feed = feed; }

  /// @param feature Invalid: that of the handle that is worked on, else the selected one.
  /// @returns kRefused: nothing is marked, there is no pair, or no picture sees the place well; the sentence says what to do.
  Result<ViewAdvice> advise(FeatureId feature = {}) const;

 private:
  /// Where what is meant lies, and in which pane it is hidden more.
  struct Question {
    std::string name;
    Eigen::Vector3d place;
    PaneSide side;
  };
  Result<Question> question(FeatureId feature) const;
  std::vector<ViewCandidate> candidates(PaneSide side) const;

  const Document& m_document;
  TargetingController& m_targeting;
  const RobotFeed* m_feed = nullptr;
};

}  // namespace longarm::session
