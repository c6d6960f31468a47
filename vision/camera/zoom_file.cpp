// The zoom camera file of SAND2004-6198, Appendix D: reading one setting.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <pugixml.hpp>

#include "core/text.h"
#include "vision/camera/camera_file_internal.h"

namespace longarm::vision::internal {
namespace {

constexpr std::size_t kMaxNodes = 1000;

// One calibrated setting: fx fy fxy u0 v0 k1 k2 p1 p2, then dx dy dz and the rotation vector, mount to camera.
struct ZoomNode {
  double zoom = 0;
  std::array<double, 9> interior{};
  std::array<double, 6> exterior{};
};

Error bad(const std::string& where, const std::string& what) { return {ErrorCode::kInvalidInput, where + ": " + what}; }

std::string ownText(const pugi::xml_node& node) {
  for (const auto& child : node.children()) {
    if (child.type() == pugi::node_pcdata && !trimmed(child.value()).empty()) return std::string(trimmed(child.value()));
  }
  return {};
}

Result<std::vector<double>> bracedNumbers(const pugi::xml_node& zoom, const char* name, const std::string& where) {
  const pugi::xml_node node = zoom.child(name);
  if (!node) return bad(where, std::string("<") + name + "> is missing");
  std::string text = ownText(node);
  std::replace_if(text.begin(), text.end(), [](char c) { return c == '{' || c == '}'; }, ' ');
  auto numbers = parseNumbers(text);
  if (!numbers) return bad(where + " " + name, numbers.error().message);
  for (const double number : *numbers) {
    if (!std::isfinite(number)) return bad(where + " " + name, "holds a number that is not finite");
  }
  return numbers;
}

Result<ZoomNode> readNode(const pugi::xml_node& zoom) {
  ZoomNode node;
  const std::string text = ownText(zoom);
  const auto value = parseNumber(text);
  if (!value || !(*value >= 0 && *value <= 1)) {
    return bad("SR_zoom", "\"" + text.substr(0, 40) + "\" is not a zoom from 0 to 1");
  }
  node.zoom = *value;
  const std::string where = "SR_zoom " + formatNumber(node.zoom);
  const auto interior = bracedNumbers(zoom, "SR_cam_int", where);
  if (!interior) return interior.error();
  if (interior->size() != 9 && interior->size() != 7) {
    return bad(where + " SR_cam_int", "holds " + std::to_string(interior->size()) +
                                          " numbers; expected 9 (fx fy fxy u0 v0 k1 k2 p1 p2)");
  }
  std::copy(interior->begin(), interior->end(), node.interior.begin());
  if (!(node.interior[0] > 0 && node.interior[1] > 0)) {
    return bad(where + " SR_cam_int", "focal lengths " + formatNumber(node.interior[0]) + ", " +
                                          formatNumber(node.interior[1]) + " are not positive");
  }
  const auto exterior = bracedNumbers(zoom, "SR_cam_ext", where);
  if (!exterior) return exterior.error();
  if (exterior->size() != 6) {
    return bad(where + " SR_cam_ext", "holds " + std::to_string(exterior->size()) + " numbers; expected 6");
  }
  std::copy(exterior->begin(), exterior->end(), node.exterior.begin());
  return node;
}

Result<std::vector<ZoomNode>> readNodes(const pugi::xml_node& camera) {
  std::vector<ZoomNode> nodes;
  for (const auto& zoom : camera.children("SR_zoom")) {
    if (nodes.size() >= kMaxNodes) return bad("SR_cam", "has more than " + std::to_string(kMaxNodes) + " settings");
    const auto node = readNode(zoom);
    if (!node) return node.error();
    nodes.push_back(*node);
  }
  if (nodes.empty()) return bad("SR_cam", "has no <SR_zoom> setting");
  std::sort(nodes.begin(), nodes.end(), [](const ZoomNode& a, const ZoomNode& b) { return a.zoom < b.zoom; });
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    if (nodes[i].zoom == nodes[i - 1].zoom) return bad("SR_zoom " + formatNumber(nodes[i].zoom), "is given twice");
  }
  return nodes;
}

// Slope of a three-point end of the monotone cubic (Fritsch & Carlson, SIAM J. Numer. Anal. 17, 1980).
double endSlope(double h0, double h1, double d0, double d1) {
  const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (slope * d0 <= 0) return 0;
  return d0 * d1 <= 0 && std::abs(slope) > 3 * std::abs(d0) ? 3 * d0 : slope;
}

// Monotone cubic through (x, y), clamped to its ends.
double pchip(const std::vector<double>& x, const std::vector<double>& y, double at) {
  const std::size_t n = x.size();
  if (at <= x.front()) return y.front();
  if (at >= x.back()) return y.back();
  std::vector<double> h(n - 1), d(n - 1), m(n);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    h[i] = x[i + 1] - x[i];
    d[i] = (y[i + 1] - y[i]) / h[i];
  }
  if (n == 2) return y[0] + d[0] * (at - x[0]);
  m[0] = endSlope(h[0], h[1], d[0], d[1]);
  m[n - 1] = endSlope(h[n - 2], h[n - 3], d[n - 2], d[n - 3]);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (d[i - 1] * d[i] <= 0) continue;
    const double w1 = 2 * h[i] + h[i - 1], w2 = h[i] + 2 * h[i - 1];
    m[i] = (w1 + w2) / (w1 / d[i - 1] + w2 / d[i]);
  }
  const std::size_t k = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin()) - 1;
  const double t = (at - x[k]) / h[k], t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * y[k] + (t3 - 2 * t2 + t) * h[k] * m[k] + (3 * t2 - 2 * t3) * y[k + 1] +
         (t3 - t2) * h[k] * m[k + 1];
}

Eigen::Vector3d rotvecOf(const ZoomNode& node) { return {node.exterior[3], node.exterior[4], node.exterior[5]}; }

// Where the mount's z axis meets the picture.  Principal point and rotation trade off at narrow fields; this
// pixel is what stays smooth over zoom.
Eigen::Vector2d boresight(const ZoomNode& node) {
  const Eigen::Vector3d axis = expSO3(rotvecOf(node)).col(2);
  const auto& i = node.interior;
  return {(i[0] * axis.x() + i[2] * axis.y()) / axis.z() + i[3], i[1] * axis.y() / axis.z() + i[4]};
}

ZoomNode interpolate(const std::vector<ZoomNode>& nodes, double zoom) {
  std::vector<double> zooms, log_focal;
  for (const auto& node : nodes) {
    if (node.zoom == zoom) return node;
    zooms.push_back(node.zoom);
    log_focal.push_back(std::log(node.interior[0]));
  }
  const auto over = [&](const auto& value) {
    std::vector<double> y;
    for (const auto& node : nodes) y.push_back(value(node));
    return pchip(zooms, y, zoom);
  };
  ZoomNode out;
  out.zoom = zoom;
  out.interior[0] = std::exp(pchip(zooms, log_focal, zoom));
  out.interior[1] = out.interior[0] * over([](const ZoomNode& n) { return n.interior[1] / n.interior[0]; });
  out.interior[2] = out.interior[0] * over([](const ZoomNode& n) { return n.interior[2] / n.interior[0]; });
  for (std::size_t i = 5; i < 9; ++i) out.interior[i] = over([i](const ZoomNode& n) { return n.interior[i]; });
  for (std::size_t i = 0; i < 6; ++i) out.exterior[i] = over([i](const ZoomNode& n) { return n.exterior[i]; });
  const double u = over([](const ZoomNode& n) { return boresight(n).x(); });
  const double v = over([](const ZoomNode& n) { return boresight(n).y(); });
  const Eigen::Vector2d offset = boresight(out);  // with u0 = v0 = 0
  out.interior[3] = u - offset.x();
  out.interior[4] = v - offset.y();
  return out;
}

}  // namespace

Result<CameraFile> cameraFromZoomXml(std::string_view text, double zoom) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!parsed) return Error{ErrorCode::kInvalidInput, std::string("broken XML: ") + parsed.description()};
  const pugi::xml_node camera = document.document_element().child("SR_cam");
  if (!camera) return bad("SR_world", "has no <SR_cam>");
  const auto nodes = readNodes(camera);
  if (!nodes) return nodes.error();
  if (!(zoom >= nodes->front().zoom && zoom <= nodes->back().zoom)) {
    return bad("zoom", formatNumber(zoom) + " is outside the calibrated settings " + formatNumber(nodes->front().zoom) +
                           " to " + formatNumber(nodes->back().zoom));
  }
  const ZoomNode at = interpolate(*nodes, zoom);
  CameraFile out;
  CameraModel& c = out.camera;
  c.name = ownText(camera);
  c.fx = at.interior[0];
  c.fy = at.interior[1];
  c.skew = at.interior[2];
  c.cx = at.interior[3];
  c.cy = at.interior[4];
  c.distortion = {at.interior[5], at.interior[6], at.interior[7], at.interior[8], 0};
  if (auto status = validate(c); !status) return status.error();
  Pose X_camera_mount = Pose::Identity();
  X_camera_mount.linear() = expSO3(rotvecOf(at));
  X_camera_mount.translation() << at.exterior[0], at.exterior[1], at.exterior[2];
  out.pose = PoseInParent{(c.name.empty() ? std::string("camera") : c.name) + "_mount", X_camera_mount.inverse()};
  return out;
}

}  // namespace longarm::vision::internal
