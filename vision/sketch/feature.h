#pragma once

/// @file
/// Features: what a sketch measures in 3-D, with uncertainty.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "core/result.h"

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
  std::vector<std::string> warnings;

  /// Line only: unit direction from vertex 0 to 1, length [m] and its standard deviation [m].
  Eigen::Vector3d direction() const;
  double length() const;
  double lengthSigma() const;
};

/// cli.md's "feature".
nlohmann::json toJson(const Feature& feature);
/// @returns kInvalidInput naming the key and value.
Result<Feature> featureFromJson(const nlohmann::json& json);

}  // namespace longarm::vision
