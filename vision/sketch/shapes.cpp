#include "vision/sketch/shapes.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "vision/camera/json_fields.h"

namespace longarm::vision {
namespace {

using nlohmann::json;

constexpr double kDegree = 0.017453292519943295;

Error bad(const std::string& where, const std::string& what) { return {ErrorCode::kInvalidInput, where + ": " + what}; }

json listOf(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

template <typename Matrix>
json rowMajor(const Matrix& m) {
  json out = json::array();
  for (Eigen::Index r = 0; r < m.rows(); ++r) {
    for (Eigen::Index c = 0; c < m.cols(); ++c) out.push_back(m(r, c));
  }
  return out;
}

Result<Eigen::Vector3d> vectorAt(const json& object, const char* key, const std::string& where) {
  if (!object.contains(key)) return bad(where, std::string("key \"") + key + "\" is missing");
  const auto numbers = numbersFromJson(object[key], where + "." + key, 3);
  if (!numbers) return numbers.error();
  return Eigen::Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

Status readNumber(const json& object, const char* key, const std::string& where, double* out) {
  if (!object.contains(key)) return {};
  const auto number = numberFromJson(object[key], where + "." + key);
  if (!number) return number.error();
  *out = *number;
  return {};
}

// Reads a square matrix where the key stands; leaves it alone otherwise.
template <typename Matrix>
Status readMatrix(const json& object, const char* key, const std::string& where, Matrix* out) {
  if (!object.contains(key)) return {};
  const int side = static_cast<int>(Matrix::RowsAtCompileTime);
  const auto numbers = numbersFromJson(object[key], where + "." + key, side * side);
  if (!numbers) return numbers.error();
  for (int i = 0; i < side * side; ++i) (*out)(i / side, i % side) = (*numbers)[static_cast<std::size_t>(i)];
  if (out->diagonal().minCoeff() < 0) return bad(where + "." + key, "has a negative variance");
  return {};
}

Status readCorners(const json& feature, PlaneShape* plane) {
  const json& corners = feature["corners"];
  if (!corners.is_array() || corners.size() != 4) {
    return bad("feature.corners", shortText(corners) + "; expected four corners [x, y, z]");
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const auto numbers = numbersFromJson(corners[i], "feature.corners[" + std::to_string(i) + "]", 3);
    if (!numbers) return numbers.error();
    plane->corners[i] = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
  }
  return {};
}

}  // namespace

double PlaneShape::angleError() const { return std::sqrt(std::max(0.0, normal_covariance.trace())); }

Eigen::Vector3d BoxShape::sizeSigma() const { return covariance.diagonal().tail<3>().cwiseMax(0).cwiseSqrt(); }

json toJson(const PlaneShape& plane) {
  json corners = json::array();
  for (const auto& corner : plane.corners) corners.push_back(listOf(corner));
  return {{"center", listOf(plane.center)},
          {"normal", listOf(plane.normal)},
          {"normal_covariance", rowMajor(plane.normal_covariance)},
          {"corners", corners},
          {"angle_error_deg", plane.angleError() / kDegree}};
}

json toJson(const BoxShape& box, const std::string& parent) {
  return {{"box",
           {{"pose", toJson(PoseInParent{parent, box.X_WB})},
            {"size", listOf(box.size)},
            {"size_sigma", listOf(box.sizeSigma())},
            {"covariance", rowMajor(box.covariance)},
            {"chi2", box.chi2},
            {"degrees_of_freedom", box.degrees_of_freedom}}},
          {"shape", box.is_box ? "box" : "parallelepiped"},
          {"orthogonality_error_deg", box.orthogonality_error / kDegree}};
}

Result<PlaneShape> planeFromJson(const json& feature) {
  PlaneShape plane;
  for (const auto& [key, out] : {std::pair<const char*, Eigen::Vector3d*>{"center", &plane.center},
                                 {"normal", &plane.normal}}) {
    const auto vector = vectorAt(feature, key, "feature");
    if (!vector) return vector.error();
    *out = *vector;
  }
  const double length = plane.normal.norm();
  if (!(std::abs(length - 1) <= 0.01)) return bad("feature.normal", shortText(feature["normal"]) + " does not have length 1");
  plane.normal /= length;
  if (auto status = readMatrix(feature, "normal_covariance", "feature", &plane.normal_covariance); !status) return status.error();
  if (!feature.contains("corners")) return bad("feature", "key \"corners\" is missing");
  if (auto status = readCorners(feature, &plane); !status) return status.error();
  return plane;
}

Result<BoxShape> boxFromJson(const json& feature) {
  const json& value = feature["box"];
  if (!value.is_object() || !value.contains("pose")) return bad("feature.box", "is not a map {pose, size}");
  BoxShape box;
  const auto pose = poseFromJson(value["pose"], "feature.box.pose");
  if (!pose) return pose.error();
  box.X_WB = pose->pose;
  const auto size = vectorAt(value, "size", "feature.box");
  if (!size) return size.error();
  if (!(size->minCoeff() > 0)) return bad("feature.box.size", shortText(value["size"]) + "; expected three lengths above 0");
  box.size = *size;
  if (auto status = readMatrix(value, "covariance", "feature.box", &box.covariance); !status) return status.error();
  if (auto status = readNumber(value, "chi2", "feature.box", &box.chi2); !status) return status.error();
  double degrees_of_freedom = 0, error_deg = 0;
  if (auto status = readNumber(value, "degrees_of_freedom", "feature.box", &degrees_of_freedom); !status) return status.error();
  if (auto status = readNumber(feature, "orthogonality_error_deg", "feature", &error_deg); !status) return status.error();
  box.degrees_of_freedom = static_cast<int>(std::clamp(degrees_of_freedom, 0.0, 1e6));
  box.orthogonality_error = error_deg * kDegree;
  box.is_box = !feature.contains("shape") || feature["shape"] != "parallelepiped";
  return box;
}

Result<PipeShape> pipeFromJson(const json& feature) {
  PipeShape pipe;
  for (const auto& [key, out] : {std::pair<const char*, double*>{"radius", &pipe.radius},
                                 {"radius_sigma", &pipe.radius_sigma},
                                 {"radius_spread", &pipe.radius_spread}}) {
    if (auto status = readNumber(feature, key, "feature", out); !status) return status.error();
  }
  if (!(pipe.radius > 0)) return bad("feature.radius", shortText(feature["radius"]) + "; expected a length above 0");
  return pipe;
}

}  // namespace longarm::vision
