#pragma once

/// @file
/// Two cameras with known poses and lenses before known points, and a hand that works a ToolHost.

#include <memory>
#include <string>

#include "session/commands/edit_history.h"
#include "session/commands/sketch_commands.h"
#include "session/tools/tool_host.h"
#include "vision/snapshot/view.h"

namespace longarm::tests {

using session::Document;
using session::EditHistory;
using session::ToolHost;
using vision::PaneSide;

constexpr int kWidth = 640, kHeight = 480;

/// A camera at p_W that looks along world +x, its picture's up along +z, turned left by `yaw` [rad].
inline vision::View viewAt(const std::string& name, const Eigen::Vector3d& p_W, double yaw) {
  vision::View view;
  view.name = name;
  view.camera.name = name;
  view.camera.width = kWidth;
  view.camera.height = kHeight;
  view.camera.fx = view.camera.fy = 740;
  view.camera.cx = 322.5;
  view.camera.cy = 237.25;
  view.camera.distortion = {-0.25, 0.08, 0.0007, -0.0004, 0.0};
  Eigen::Matrix3d looking_along_x;
  looking_along_x << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  view.X_WC.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix() * looking_along_x;
  view.X_WC.translation() = p_W;
  return view;
}

inline vision::SnapshotPtr snapshotOf(std::uint64_t id, const vision::View& view) {
  auto snapshot = std::make_shared<vision::Snapshot>();
  snapshot->id = {id};
  snapshot->view = view;
  snapshot->image = cv::Mat(view.camera.height, view.camera.width, CV_8UC1, cv::Scalar(80));
  snapshot->source = "synthetic";
  return snapshot;
}

/// The pair: 0.254 m apart, 1 m above the ground, each turned 1 degree inwards.
struct StereoScene {
  vision::View left = viewAt("head_left", {0, 0.127, 1.0}, -0.0175);
  vision::View right = viewAt("head_right", {0, -0.127, 1.0}, 0.0175);
  Eigen::Vector3d a{1.5, 0.2, 1.05}, b{1.6, -0.15, 0.92};   ///< Ends of the true line [m].

  const vision::View& view(PaneSide side) const { return side == PaneSide::kLeft ? left : right; }
  Eigen::Vector2d pixel(PaneSide side, const Eigen::Vector3d& p_W) const { return view(side).project(p_W).value(); }
};

/// A document that shows the pair, its history and tools.
struct Bench {
  StereoScene scene;
  Document document;
  EditHistory history{document};
  ToolHost tools{document, history};

  explicit Bench(bool with_pictures = true) {
    if (!with_pictures) return;
    history.push(session::addSnapshots(document, {snapshotOf(1, scene.left), snapshotOf(2, scene.right)}));
    history.clear();
  }
  SnapshotId snapshot(PaneSide side) const { return document.paneSnapshotId(side); }
};

/// Sends pointer events as the canvas does: raw pixels, with the zoom that makes the pick radius.
class Hand {
 public:
  explicit Hand(ToolHost& tools, double zoom = 1) : m_tools(tools), m_zoom(zoom) {}
  vision::KeyModifiers modifiers;

  bool send(vision::PointerPhase phase, PaneSide side, const Eigen::Vector2d& pixel) {
    vision::PointerEvent event;
    event.side = side;
    event.phase = phase;
    event.pixel = pixel;
    event.pixels_per_image_px = m_zoom;
    event.left = phase != vision::PointerPhase::kHover;
    event.modifiers = modifiers;
    m_side = side;
    m_at = pixel;
    return m_tools.pointer(event);
  }
  bool press(PaneSide side, const Eigen::Vector2d& pixel) { return send(vision::PointerPhase::kPress, side, pixel); }
  bool moveTo(const Eigen::Vector2d& pixel, int steps = 8) {
    const Eigen::Vector2d from = m_at;
    bool used = false;
    for (int i = 1; i <= steps; ++i) {
      used = send(vision::PointerPhase::kDrag, m_side, from + (pixel - from) * i / steps);
    }
    return used;
  }
  bool release() { return send(vision::PointerPhase::kRelease, m_side, m_at); }
  bool hover(PaneSide side, const Eigen::Vector2d& pixel) { return send(vision::PointerPhase::kHover, side, pixel); }
  bool click(PaneSide side, const Eigen::Vector2d& pixel) {
    press(side, pixel);
    return release();
  }
  void drag(PaneSide side, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    press(side, from);
    moveTo(to);
    release();
  }
  bool key(vision::SketchKey which) { return m_tools.key(which, modifiers); }

 private:
  ToolHost& m_tools;
  double m_zoom;
  PaneSide m_side = PaneSide::kLeft;
  Eigen::Vector2d m_at = Eigen::Vector2d::Zero();
};

/// A line marked at the true ends in both pictures, both picks of the right one slid along the curve.
inline session::SketchItem trueLine(const Bench& bench, std::uint64_t id, const std::string& name = "Line 1") {
  session::SketchItem item;
  item.id = {id};
  item.kind = vision::FeatureKind::kLine;
  item.name = name;
  const Eigen::Vector3d ends[] = {bench.scene.a, bench.scene.b};
  for (int vertex = 0; vertex < 2; ++vertex) {
    item.setPick({1}, vertex, {bench.scene.pixel(PaneSide::kLeft, ends[vertex]), session::PickState::kFree});
    item.setPick({2}, vertex, {bench.scene.pixel(PaneSide::kRight, ends[vertex]), session::PickState::kConstrained});
  }
  return item;
}

}  // namespace longarm::tests
