#pragma once

/// @file
/// Features: what a sketch measures in 3-D, with uncertainty.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "core/result.h"
#include "vision/sketch/shapes.h"

namespace longarm::vision {

enum class FeatureKind { kPoint, kLine, kPlane, kTriad };
const char* toString(FeatureKind kind);                         ///< "point", "line", "plane", "triad"
std::optional<FeatureKind> featureKindFrom(const std::string& word);
int vertexCount(FeatureKind kind);                              ///< 1, 2, 3, 4

struct FeatureVertex {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();                ///< [m]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();         ///< [m^2]
  double miss_m = 0;
  double reprojection_rms_px = 0;
  std::vector<std::string> views;
};

/// A measured primitive, expressed in `parent`.  Vertices: line 0-1; plane 0-1-2 with 1 shared; triad 0 common.
struct Feature {
  std::string name;
  FeatureKind kind = FeatureKind::kPoint;
  std::string parent = "base_link";
  std::vector<FeatureVertex> vertices;
  /// Covariance between vertices 0 and 1 from the calibration (and edge picks) they share; zero when unknown [m^2].
  Eigen::Matrix3d cross_covariance = Eigen::Matrix3d::Zero();
  std::optional<PlaneShape> plane;                              ///< Measured planes.
  std::optional<BoxShape> box;                                  ///< Measured triads.
  std::optional<PipeShape> pipe;                                ///< Lines measured by the outlines of a pipe.
  std::vector<std::string> warnings;

  /// Line only: unit direction from vertex 0 to 1, length [m] and its standard deviation [m].
  Eigen::Vector3d direction() const;
  double length() const;
  double lengthSigma() const;
};

/// Middle of a pipe, z along its axis.  @pre feature.pipe, two vertices
Pose pipePose(const Feature& feature);

/// The feature as the headless verbs print and read it; a line adds direction, length and
/// length_sigma (a pipe radius, radius_sigma, radius_spread), a plane and a triad what toJson of their shapes holds.
nlohmann::json toJson(const Feature& feature);
/// Only name, kind and the vertices' xyz are required; a shape is read where its keys stand.  An object with "features" (what the verb `target`
/// prints) is taken when exactly one of them was measured.
/// @returns kInvalidInput naming the key and value.
Result<Feature> featureFromJson(const nlohmann::json& json);

}  // namespace longarm::vision
