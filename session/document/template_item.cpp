#include "session/document/template_item.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "session/document/face_frame.h"

namespace longarm::session {
namespace {

constexpr double kNormal95 = 1.959963984540054;
constexpr double kLeastMargin_m = 0.001;

}  // namespace

Result<WorldItem> templateItemFrom(const planning::ObjectTemplate& what, const vision::Feature& feature) {
  if (!what.takes(feature.kind)) {
    return Error{ErrorCode::kInvalidInput, what.title() + " cannot be dropped onto a " + vision::toString(feature.kind) + "."};
  }
  const auto face = faceFrameOf(feature);
  if (!face) return face.error();
  WorldItem item;
  item.kind = WorldKind::kTemplate;
  item.name = what.name();
  item.template_name = what.name();
  item.parent = feature.parent;
  item.X_WO = face->X_WT;
  item.margin_m = std::max(kLeastMargin_m, marginOf(feature));
  std::map<std::string, double> sizes;
  for (const auto& parameter : what.parameters()) {
    if (parameter.from == 0) continue;
    const auto& extent = face->extent[static_cast<std::size_t>(parameter.from - 'u')];
    if (extent) sizes[parameter.name] = std::clamp(*extent, parameter.lower, parameter.upper);
  }
  return withParameters(what, item, sizes);
}

Result<WorldItem> withParameters(const planning::ObjectTemplate& what, const WorldItem& item,
                                 const std::map<std::string, double>& parameters) {
  WorldItem out = item;
  for (const auto& [name, value] : parameters) out.parameters[name] = value;
  auto made = what.instance(out.parameters);
  if (!made) return made.error();
  for (const auto& parameter : what.parameters()) out.parameters.emplace(parameter.name, parameter.value);
  out.parts = std::move(made->parts);
  return out;
}

Result<vision::Feature> featureOf(const planning::ObjectTemplate& what, const WorldItem& item, const std::string& name) {
  const auto made = what.instance(item.parameters);
  if (!made) return made.error();
  const auto found = made->features.find(name);
  if (found == made->features.end()) return Error{ErrorCode::kNotFound, "Template " + what.name() + " has no feature \"" + name + "\"."};
  vision::Feature out = found->second;
  out.name = item.name + " " + name;
  out.parent = item.parent;
  for (auto& vertex : out.vertices) {
    vertex.xyz = item.X_WO * vertex.xyz;
    vertex.covariance = std::pow(item.margin_m / kNormal95, 2) * Eigen::Matrix3d::Identity();
  }
  return out;
}

}  // namespace longarm::session
