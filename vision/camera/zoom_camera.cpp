#include "vision/camera/zoom_camera.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace longarm::vision {
namespace {

Error bad(const std::string& where, const std::string& what) { return {ErrorCode::kInvalidInput, where + ": " + what}; }

Eigen::Vector3d rotvecOf(const ZoomNode& node) { return {node.exterior[3], node.exterior[4], node.exterior[5]}; }

// Slope of a three-point end of the monotone cubic.
double endSlope(double h0, double h1, double d0, double d1) {
  const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (slope * d0 <= 0) return 0;
  return d0 * d1 <= 0 && std::abs(slope) > 3 * std::abs(d0) ? 3 * d0 : slope;
}

std::vector<ZoomNode> sorted(std::vector<ZoomNode> nodes) {
  std::sort(nodes.begin(), nodes.end(), [](const ZoomNode& a, const ZoomNode& b) { return a.zoom < b.zoom; });
  return nodes;
}

ZoomNode interpolate(const std::vector<ZoomNode>& nodes, double zoom) {
  std::vector<double> zooms;
  for (const auto& node : nodes) zooms.push_back(node.zoom);
  const auto over = [&](const auto& value) {
    std::vector<double> y;
    for (const auto& node : nodes) y.push_back(value(node));
    return monotoneCubic(zooms, y, zoom);
  };
  ZoomNode out;
  out.zoom = zoom;
  out.interior[0] = std::exp(over([](const ZoomNode& n) { return std::log(n.interior[0]); }));
  out.interior[1] = out.interior[0] * over([](const ZoomNode& n) { return n.interior[1] / n.interior[0]; });
  out.interior[2] = out.interior[0] * over([](const ZoomNode& n) { return n.interior[2] / n.interior[0]; });
  for (std::size_t i = 5; i < 9; ++i) out.interior[i] = over([i](const ZoomNode& n) { return n.interior[i]; });
  for (std::size_t i = 0; i < 6; ++i) out.exterior[i] = over([i](const ZoomNode& n) { return n.exterior[i]; });
  const double u = over([](const ZoomNode& n) { return boresightOf(n).x(); });
  const double v = over([](const ZoomNode& n) { return boresightOf(n).y(); });
  const Eigen::Vector2d offset = boresightOf(out);  // with u0 = v0 = 0
  out.interior[3] = u - offset.x();
  out.interior[4] = v - offset.y();
  return out;
}

}  // namespace

double monotoneCubic(const std::vector<double>& x, const std::vector<double>& y, double at) {
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

bool isNominal(const ZoomNode& node) {
  const auto& i = node.interior;
  const bool ideal = std::all_of(i.begin() + 5, i.end(), [](double k) { return k == 0; }) && i[2] == 0;
  return ideal && i[0] == i[1] && i[3] == std::floor(i[3]) && i[4] == std::floor(i[4]);
}

Eigen::Vector2d boresightOf(const ZoomNode& node) {
  const Eigen::Vector3d axis = expSO3(rotvecOf(node)).col(2);
  const auto& i = node.interior;
  return {(i[0] * axis.x() + i[2] * axis.y()) / axis.z() + i[3], i[1] * axis.y() / axis.z() + i[4]};
}

Result<ZoomNode> zoomAt(const ZoomCamera& camera, double zoom) {
  const auto nodes = sorted(camera.nodes);
  if (nodes.empty()) return bad("SR_cam", "has no <SR_zoom> setting");
  if (!(zoom >= nodes.front().zoom && zoom <= nodes.back().zoom)) {
    return bad("zoom", formatNumber(zoom) + " is outside the calibrated settings " + formatNumber(nodes.front().zoom) + " to " +
                           formatNumber(nodes.back().zoom));
  }
  for (const auto& node : nodes) {
    if (node.zoom == zoom) return node;
  }
  return interpolate(nodes, zoom);
}

namespace {

// The mount in the camera's optical frame.
Pose exteriorOf(const ZoomNode& node) {
  Pose X_CM = Pose::Identity();
  X_CM.linear() = expSO3(rotvecOf(node));
  X_CM.translation() << node.exterior[0], node.exterior[1], node.exterior[2];
  return X_CM;
}

}  // namespace

void moveMount(const Pose& X_MM, ZoomCamera* camera) {
  for (auto& node : camera->nodes) {
    const Pose X_CM = exteriorOf(node) * X_MM.inverse();
    const Eigen::Vector3d turn = logSO3(X_CM.linear());
    for (int i = 0; i < 3; ++i) {
      node.exterior[static_cast<std::size_t>(i)] = X_CM.translation()[i];
      node.exterior[static_cast<std::size_t>(3 + i)] = turn[i];
    }
  }
}

Result<CameraFile> cameraFileOf(const ZoomCamera& camera, const ZoomNode& node) {
  CameraFile out;
  CameraModel& c = out.camera;
  c.name = camera.name;
  c.fx = node.interior[0];
  c.fy = node.interior[1];
  c.skew = node.interior[2];
  c.cx = node.interior[3];
  c.cy = node.interior[4];
  c.distortion = {node.interior[5], node.interior[6], node.interior[7], node.interior[8], 0};
  if (auto status = validate(c); !status) return status.error();
  out.pose = PoseInParent{(c.name.empty() ? std::string("camera") : c.name) + "_mount", exteriorOf(node).inverse()};
  return out;
}

}  // namespace longarm::vision
