#pragma once

/// @file
/// Two panes that show a pair at a zoom, and a mouse on their canvases.

#include "session/commands/sketch_commands.h"
#include "tests/session/true_shapes.h"
#include "tests/ui/panel_rig.h"
#include "ui/simulated_hand.h"
#include "ui/snapshot_pane.h"

namespace longarm::tests {

/// Panes so large that the whole picture is seen at any zoom up to 400 %.
struct CanvasRig : PanelRig {
  explicit CanvasRig(double zoom_factor = 1) : zoom(zoom_factor) {}

  /// Shows two pictures, one in each pane.
  void open(const vision::SnapshotPtr& first, const vision::SnapshotPtr& second) {
    bench.history().push(session::addSnapshots(bench.document(), {first, second}));
    bench.history().clear();
    for (auto* pane : {&left, &right}) {
      pane->resize(std::max(700, static_cast<int>(kWidth * zoom) + 60), std::max(600, static_cast<int>(kHeight * zoom) + 160));
      pane->show();
      ui::SimulatedHand::pump(1);
      pane->canvas()->fit();
      pane->canvas()->zoomAbout(QRectF(pane->canvas()->rect()).center(), zoom / pane->canvas()->scale());
    }
  }
  void openPair() { open(snapshotOf(1, scene.left), snapshotOf(2, scene.right)); }

  ui::SnapshotPane& pane(PaneSide side) { return side == PaneSide::kLeft ? left : right; }
  widgets::ImageCanvas* canvas(PaneSide side) { return pane(side).canvas(); }
  QPointF on(PaneSide side, const Eigen::Vector2d& pixel) { return *canvas(side)->widgetOfPixel(pixel); }
  /// Where the pane's picture shows a point of the world.
  Eigen::Vector2d seen(PaneSide side, const Eigen::Vector3d& p_W) const { return scene.pixel(side, p_W); }

  void click(PaneSide side, const Eigen::Vector2d& pixel, Qt::KeyboardModifiers modifiers = {}) {
    hand.click(canvas(side), on(side, pixel), Qt::LeftButton, modifiers);
  }
  void drag(PaneSide side, const Eigen::Vector2d& from, const Eigen::Vector2d& to, Qt::KeyboardModifiers modifiers = {}) {
    hand.drag(canvas(side), on(side, from), on(side, to), modifiers);
  }
  void key(PaneSide side, int code, Qt::KeyboardModifiers modifiers = {}) { hand.key(canvas(side), code, modifiers); }

  session::TargetingController& targeting() { return bench.targeting(); }
  const session::Document& document() { return bench.document(); }
  const session::SketchItem& only() { return document().items().at(0); }
  const session::Measurement& measured() { return document().measurement(only().id); }
  Eigen::Vector2d pick(PaneSide side, int vertex = 0) { return only().pick(document().paneSnapshotId(side), vertex)->pixel; }

  double zoom;
  ui::SnapshotPane left{PaneSide::kLeft, bench, appearance}, right{PaneSide::kRight, bench, appearance};
  ui::SimulatedHand hand;
};

constexpr double kZooms[] = {0.25, 1.0, 4.0};

}  // namespace longarm::tests
