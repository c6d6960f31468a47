#pragma once

/// @file
/// What a third picture says of a vertex that is marked in two others.

#include <optional>
#include <string>
#include <vector>

#include "session/document/document.h"
#include "vision/sketch/pointer_event.h"
#include "vision/stereo/epipolar.h"

namespace longarm::session {

/// A pick further than this from where the others see it is flagged [sigma].
constexpr double kThirdViewSigmas = 3;

struct ThirdView {
  std::vector<vision::EpipolarCurve> curves;               ///< One per other picture that has a pick of the vertex.
  std::optional<Eigen::Vector2d> predicted;                ///< Where the others put it [raw px].
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();    ///< Of a pick about it: theirs and its own noise [px^2].
  std::optional<double> off_sigmas;                        ///< How far this picture's pick is from it; empty: no pick here.

  bool flagged() const { return off_sigmas && *off_sigmas > kThirdViewSigmas; }
};

/// Pure function.  Outlines of pipes are no points and give nothing.
ThirdView thirdView(const Document& document, const SketchItem& item, int vertex, SnapshotId picture);

/// Curves and predicted place of one vertex; and a flag at every pick of any item in this picture that is off.
/// @param vertex < 0: no curves.
void addThirdView(const Document& document, const SketchItem* item, int vertex, SnapshotId picture, vision::Overlay* overlay);
/// The worst flagged pick of the picture as a sentence; empty: none.
std::string thirdViewWarning(const Document& document, SnapshotId picture);

/// The vertex whose predicted place is nearest to the pixel; -1 when none is predicted.
int nearestPredicted(const Document& document, const SketchItem& item, SnapshotId picture, const Eigen::Vector2d& pixel);

}  // namespace longarm::session
