#pragma once

/// @file
/// What planes, triads and pipes measure beyond their vertices.

#include <array>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "core/pose.h"
#include "core/result.h"

namespace longarm::vision {

/// A plane through three vertices, 1 shared.
struct PlaneShape {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();         ///< Of the parallelogram [m].
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();        ///< Unit, towards the cameras.
  /// The parallelogram in ring order: vertices 0, 1, 2 and the one opposite to 1 [m].
  std::array<Eigen::Vector3d, 4> corners{};
  Eigen::Matrix3d normal_covariance = Eigen::Matrix3d::Zero();   ///< [rad^2]; singular along the normal.

  /// Root mean square angle between the stated and the true normal [rad].
  double angleError() const;
};

/// A box whose edges are a triad's.  Axes x, y, z of the box frame B are the edges 1, 2, 3, or 1, 3, 2 where these were
/// marked left-handed.
struct BoxShape {
  Pose X_WB = Pose::Identity();                             ///< Origin in the middle of the box.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();           ///< Along B's axes [m].
  /// Of (centre [m], rotvec [rad] as a left perturbation of the rotation alone, size [m]).
  Eigen::Matrix<double, 9, 9> covariance = Eigen::Matrix<double, 9, 9>::Zero();
  double orthogonality_error = 0;       ///< Largest deviation from 90 degrees between two edges measured freely [rad].
  double chi2 = 0;                      ///< Of the picks under the box; about degrees_of_freedom when it is one.
  int degrees_of_freedom = 0;
  bool is_box = true;                   ///< False: the picks reject right angles (95 %); the vertices are then free points.

  Eigen::Vector3d sizeSigma() const;    ///< [m]
};

/// A round pipe measured by its outlines.
struct PipeShape {
  double radius = 0, radius_sigma = 0;  ///< [m]
  double radius_spread = 0;             ///< Largest minus smallest distance of the axis from an outline [m].
};

/// The keys a feature carries for its shape, as the headless verbs print and read them.
nlohmann::json toJson(const PlaneShape& plane);
nlohmann::json toJson(const BoxShape& box, const std::string& parent);
/// @returns kInvalidInput naming the key and value.
Result<PlaneShape> planeFromJson(const nlohmann::json& feature);
Result<BoxShape> boxFromJson(const nlohmann::json& feature);
Result<PipeShape> pipeFromJson(const nlohmann::json& feature);

}  // namespace longarm::vision
