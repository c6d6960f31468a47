#pragma once

/// @file
/// Draws measured features with their names and 95 % ellipsoids.

#include <memory>
#include <vector>

#include "vision/sketch/feature.h"
#include "widgets/scene/representation.h"

namespace longarm::scene {

struct SketchItem {
  vision::Feature feature;               ///< Expressed in the world frame.
  bool selected = false;
  bool visible = true;
  bool stale = false;  ///< Drawn grey: the base is no longer where it was measured from.
};

struct SketchLook {
  double ellipsoid_scale = 1;            ///< Enlarges the ellipsoids (1: true size) so that small ones can be seen.
  bool names = true, ellipsoids = true;
  Eigen::Vector3d color{0.2, 0.85, 0.95}, selected_color{1.0, 0.6, 0.1},
      stale_color{0.55, 0.5, 0.55};  ///< RGB 0 ... 1.
};

/// Semi-axes of the ellipsoid that holds 95 % of a 3-D normal: sqrt(chi2_3(0.95) * eigenvalue).
constexpr double kChi2Of95Percent3 = 7.814727903251179;

/// All features of a sketch.  Points are drawn with a constant size on screen, ellipsoids in true size.
class SketchRep final : public Representation {
 public:
  SketchRep();
  ~SketchRep() override;

  void update(const std::vector<SketchItem>& items);
  void setLook(const SketchLook& look);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// Rotation and semi-axes [m] of the 95 % ellipsoid: columns of `axes` scaled.  Not finite or negative parts count as 0.
Eigen::Matrix3d ellipsoidAxes(const Eigen::Matrix3d& covariance);

}  // namespace longarm::scene
