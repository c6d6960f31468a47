#pragma once

/// @file
/// Draws a measured distance or angle in the scene.

#include <string>
#include <vector>

#include "widgets/scene/representation.h"

namespace longarm::scene {

/// A way from place to place with its ends marked, and a text at its middle (two places) or at its corner (three).  Drawn
/// before everything else: what is measured may be inside of a body.
class DimensionRep final : public Representation {
 public:
  DimensionRep();
  ~DimensionRep() override;

  /// @param places World frame [m]; none, or one that is not finite: nothing is drawn.  @param text Empty: none.
  void update(const std::vector<Eigen::Vector3d>& places, const std::string& text);
};

}  // namespace longarm::scene
