#pragma once

/// @file
/// Shapes of known size before the synthetic pair, and where its pictures see them.

#include <array>
#include <cmath>
#include <vector>

#include "tests/session/synthetic_views.h"

namespace longarm::tests {

/// A pipe between two points and its outlines as a camera sees them.
struct TruePipe {
  Eigen::Vector3d a{1.5, 0.12, 1.25}, b{1.55, 0.02, 0.85};   // Across the baseline.
  double radius = 0.04;

  Pose pose() const {
    Pose X = Pose::Identity();
    X.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), b - a).toRotationMatrix();
    X.translation() = (a + b) / 2;
    return X;
  }
  /// Ends of both outlines: where the surface turns away from the camera.
  std::array<Eigen::Vector2d, 4> outlines(const vision::View& view) const {
    const Pose X = pose();
    const Eigen::Vector3d eye = X.inverse() * view.X_WC.translation();
    const double towards = std::atan2(eye.y(), eye.x()), turn = std::acos(radius / eye.head<2>().norm()), half = (b - a).norm() / 2;
    std::array<Eigen::Vector2d, 4> ends;
    for (int i = 0; i < 4; ++i) {
      const double angle = towards + (i < 2 ? turn : -turn);
      ends[static_cast<std::size_t>(i)] =
          view.project(X * Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), i % 2 == 0 ? -half : half)).value();
    }
    return ends;
  }
};

/// How the plane and the box are turned.
inline Eigen::Matrix3d shapeTurn() { return expSO3({0, 0.5, 0.6}); }

/// Corners of the true plane or box in vertex order [m].
inline std::vector<Eigen::Vector3d> trueCorners(session::ToolKind kind) {
  const Eigen::Matrix3d R = shapeTurn();
  const Eigen::Vector3d o(1.3, 0, 1.02);
  if (kind == session::ToolKind::kPlane) return {o + 0.25 * R.col(1), o, o + 0.2 * R.col(2)};
  return {o, o + 0.25 * R.col(0), o + 0.2 * R.col(1), o + 0.15 * R.col(2)};
}

}  // namespace longarm::tests
