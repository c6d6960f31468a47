#include "vision/sketch/feature.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "vision/camera/json_fields.h"

namespace longarm::vision {
namespace {

using nlohmann::json;

constexpr FeatureKind kKinds[] = {FeatureKind::kPoint, FeatureKind::kLine, FeatureKind::kPlane, FeatureKind::kTriad};

Error bad(const std::string& where, const std::string& what) { return {ErrorCode::kInvalidInput, where + ": " + what}; }

json rowMajor(const Eigen::Matrix3d& m) {
  json out = json::array();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out.push_back(m(r, c));
  }
  return out;
}

json listOf(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Result<Eigen::Matrix3d> matrixFromJson(const json& value, const std::string& where) {
  const auto numbers = numbersFromJson(value, where, 9);
  if (!numbers) return numbers.error();
  Eigen::Matrix3d out;
  for (int i = 0; i < 9; ++i) out(i / 3, i % 3) = (*numbers)[static_cast<std::size_t>(i)];
  return out;
}

json vertexJson(const FeatureVertex& vertex) {
  const Eigen::Vector3d sigma = vertex.covariance.diagonal().cwiseMax(0).cwiseSqrt();
  return {{"xyz", listOf(vertex.xyz)},
          {"covariance", rowMajor(vertex.covariance)},
          {"sigma", listOf(sigma)},
          {"miss_m", vertex.miss_m},
          {"reprojection_rms_px", vertex.reprojection_rms_px},
          {"views", vertex.views}};
}

Status readOptional(const json& object, const char* key, const std::string& where, double* out) {
  if (!object.contains(key)) return {};
  const auto number = numberFromJson(object[key], where + "." + key);
  if (!number) return number.error();
  *out = *number;
  return {};
}

Result<FeatureVertex> vertexFromJson(const json& value, const std::string& where) {
  if (!value.is_object() || !value.contains("xyz")) return bad(where, "key \"xyz\" is missing");
  FeatureVertex vertex;
  const auto xyz = numbersFromJson(value["xyz"], where + ".xyz", 3);
  if (!xyz) return xyz.error();
  vertex.xyz = {(*xyz)[0], (*xyz)[1], (*xyz)[2]};
  if (value.contains("covariance") && !value["covariance"].is_null()) {
    const auto covariance = matrixFromJson(value["covariance"], where + ".covariance");
    if (!covariance) return covariance.error();
    if (covariance->diagonal().minCoeff() < 0) return bad(where + ".covariance", "has a negative variance");
    vertex.covariance = *covariance;
  }
  if (auto status = readOptional(value, "miss_m", where, &vertex.miss_m); !status) return status.error();
  if (auto status = readOptional(value, "reprojection_rms_px", where, &vertex.reprojection_rms_px); !status) {
    return status.error();
  }
  if (value.contains("views") && value["views"].is_array()) {
    for (const auto& view : value["views"]) {
      if (view.is_string()) vertex.views.push_back(view.get<std::string>());
    }
  }
  return vertex;
}

Result<Feature> oneMeasured(const json& list) {
  const json* found = nullptr;
  std::size_t count = 0;
  for (const auto& entry : list) {
    if (!entry.is_object() || !entry.contains("vertices")) continue;
    found = &entry;
    ++count;
  }
  if (count == 1) return featureFromJson(*found);
  return bad("features", "holds " + std::to_string(count) + " measured features; expected exactly one");
}

// The shape that the feature's kind can have, where its first key stands.
Status readShape(const json& object, Feature* feature) {
  const auto keep = [](auto read, auto* out) -> Status {
    if (!read) return read.error();
    *out = std::move(*read);
    return {};
  };
  if (feature->kind == FeatureKind::kPlane && object.contains("normal")) return keep(planeFromJson(object), &feature->plane);
  if (feature->kind == FeatureKind::kTriad && object.contains("box")) return keep(boxFromJson(object), &feature->box);
  if (feature->kind == FeatureKind::kLine && object.contains("radius")) return keep(pipeFromJson(object), &feature->pipe);
  return {};
}

Status readHeader(const json& object, Feature* feature) {
  for (const char* key : {"kind", "vertices"}) {
    if (!object.contains(key)) return bad("feature", std::string("key \"") + key + "\" is missing");
  }
  for (const auto& [key, text] : {std::pair<const char*, std::string*>{"name", &feature->name},
                                  {"parent", &feature->parent}}) {
    if (!object.contains(key)) continue;
    if (!object[key].is_string()) return bad(std::string("feature.") + key, shortText(object[key]) + " is not a name");
    *text = object[key].get<std::string>();
  }
  const json& kind = object["kind"];
  const auto known = kind.is_string() ? featureKindFrom(kind.get<std::string>()) : std::nullopt;
  if (!known) return bad("feature.kind", shortText(kind) + " is none of point, line, plane, triad");
  feature->kind = *known;
  return {};
}

}  // namespace

const char* toString(FeatureKind kind) {
  switch (kind) {
    case FeatureKind::kPoint: return "point";
    case FeatureKind::kLine: return "line";
    case FeatureKind::kPlane: return "plane";
    case FeatureKind::kTriad: return "triad";
  }
  return "point";
}

std::optional<FeatureKind> featureKindFrom(const std::string& word) {
  for (const auto kind : kKinds) {
    if (word == toString(kind)) return kind;
  }
  return std::nullopt;
}

int vertexCount(FeatureKind kind) { return static_cast<int>(kind) + 1; }

Eigen::Vector3d Feature::direction() const {
  if (vertices.size() < 2) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d along = vertices[1].xyz - vertices[0].xyz;
  const double size = along.norm();
  return size > 0 ? Eigen::Vector3d(along / size) : Eigen::Vector3d::Zero();
}

double Feature::length() const { return vertices.size() < 2 ? 0 : (vertices[1].xyz - vertices[0].xyz).norm(); }

Pose pipePose(const Feature& feature) {
  Pose X = Pose::Identity();
  X.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), feature.direction()).toRotationMatrix();
  X.translation() = (feature.vertices[0].xyz + feature.vertices[1].xyz) / 2;
  return X;
}

double Feature::lengthSigma() const {
  if (vertices.size() < 2) return 0;
  const Eigen::Vector3d d = direction();
  const Eigen::Matrix3d difference = vertices[0].covariance + vertices[1].covariance - cross_covariance -
                                     cross_covariance.transpose();
  return std::sqrt(std::max(0.0, d.dot(difference * d)));
}

json toJson(const Feature& feature) {
  json out = {{"name", feature.name}, {"kind", toString(feature.kind)}, {"parent", feature.parent}};
  out["vertices"] = json::array();
  for (const auto& vertex : feature.vertices) out["vertices"].push_back(vertexJson(vertex));
  if (feature.kind == FeatureKind::kLine) {
    out["direction"] = listOf(feature.direction());
    out["length"] = feature.length();
    out["length_sigma"] = feature.lengthSigma();
  }
  if (feature.plane) out.update(toJson(*feature.plane));
  if (feature.box) out.update(toJson(*feature.box, feature.parent));
  if (feature.pipe) {
    out["radius"] = feature.pipe->radius;
    out["radius_sigma"] = feature.pipe->radius_sigma;
    out["radius_spread"] = feature.pipe->radius_spread;
  }
  if (!feature.cross_covariance.isZero(0)) out["cross_covariance"] = rowMajor(feature.cross_covariance);
  if (!feature.warnings.empty()) out["warnings"] = feature.warnings;
  return out;
}

Result<Feature> featureFromJson(const json& object) {
  if (object.is_array()) return oneMeasured(object);
  if (!object.is_object()) return bad("feature", shortText(object) + " is not a map {name, kind, vertices}");
  if (object.contains("features") && object["features"].is_array()) return oneMeasured(object["features"]);
  Feature feature;
  if (auto status = readHeader(object, &feature); !status) return status.error();
  const json& vertices = object["vertices"];
  const auto wanted = static_cast<std::size_t>(vertexCount(feature.kind));
  if (!vertices.is_array() || vertices.size() != wanted) {
    return bad("feature.vertices", shortText(vertices) + "; a " + toString(feature.kind) + " has " +
                                       std::to_string(wanted));
  }
  for (std::size_t i = 0; i < wanted; ++i) {
    const auto vertex = vertexFromJson(vertices[i], "feature.vertices[" + std::to_string(i) + "]");
    if (!vertex) return vertex.error();
    feature.vertices.push_back(*vertex);
  }
  if (auto status = readShape(object, &feature); !status) return status.error();
  if (object.contains("cross_covariance")) {
    const auto cross = matrixFromJson(object["cross_covariance"], "feature.cross_covariance");
    if (!cross) return cross.error();
    feature.cross_covariance = *cross;
  }
  if (object.contains("warnings") && object["warnings"].is_array()) {
    for (const auto& warning : object["warnings"]) {
      if (warning.is_string()) feature.warnings.push_back(warning.get<std::string>());
    }
  }
  return feature;
}

}  // namespace longarm::vision
