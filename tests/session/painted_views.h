#pragma once

/// @file
/// Snapshots of a painted wall, whose matches are known to a fraction of a pixel, and of a checkerboard.

#include "tests/session/synthetic_views.h"
#include "tests/vision/painted_wall.h"

namespace longarm::tests {

/// The pair before a wall; both pictures are rendered through their lenses.
struct PaintedPair {
  explicit PaintedPair(const PaintedWall& painted) : wall(painted) {
    Dice dice(5);
    left.view = rig.left;
    left.image = wall.seenBy(rig.left, &dice, 1, 0.01);
    right.view = rig.right;
    right.image = wall.seenBy(rig.right, &dice, 0.85, 0.01);
    left.id = {1};
    right.id = {2};
  }
  std::vector<vision::SnapshotPtr> snapshots() const {
    return {std::make_shared<vision::Snapshot>(left), std::make_shared<vision::Snapshot>(right)};
  }
  Eigen::Vector2d pixel(PaneSide side, double x, double y) const {
    return (side == PaneSide::kLeft ? rig.left : rig.right).project(wall.at(x, y)).value();
  }

  StereoRig rig;
  PaintedWall wall;
  vision::Snapshot left, right;
};

/// A checkerboard of squares `cell` pixels wide with a corner at `corner`, each pixel the mean of 8 x 8 samples.
inline cv::Mat checkerPicture(const Eigen::Vector2d& corner, double cell = 24) {
  cv::Mat image(kHeight, kWidth, CV_8UC1);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      int bright = 0;
      for (int i = 0; i < 64; ++i) {
        const double u = column - 0.4375 + (i % 8) / 8.0 - corner.x(), v = row - 0.4375 + (i / 8) / 8.0 - corner.y();
        bright += (static_cast<long>(std::floor(u / cell)) + static_cast<long>(std::floor(v / cell))) % 2 == 0 ? 1 : 0;
      }
      image.at<unsigned char>(row, column) = static_cast<unsigned char>(60 + 130 * bright / 64);
    }
  }
  return image;
}

}  // namespace longarm::tests
