#include "session/document/overlay_builder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text.h"
#include "session/document/feature_rows.h"
#include "session/document/path_sight.h"
#include "vision/sketch/overlay.h"

namespace longarm::session {

using vision::Overlay;
using vision::OverlayRole;
using vision::OverlayShape;

namespace {

constexpr double kCross = 8;               // half the cross of a failure [px]

void addMarker(Overlay& overlay, OverlayRole role, const Eigen::Vector2d& pixel) {
  overlay.shapes.push_back({OverlayShape::Kind::kMarker, role, {pixel}, {}});
}

void addText(Overlay& overlay, OverlayRole role, const Eigen::Vector2d& pixel, std::string text) {
  overlay.shapes.push_back({OverlayShape::Kind::kText, role, {pixel}, std::move(text)});
}

/// Name, and how long or where to within what; then the operator's note.
std::string labelOf(const SketchItem& item, const Measurement& measurement) {
  const std::string note = item.note.empty() ? std::string() : "  \u2013 " + item.note;
  if (!measurement.feature) return item.name + (item.markedTwice() ? "  not measured" : "") + note;
  if (measurement.stale) return item.name + "  stale: the base was driven" + note;
  const FeatureRow row = featureRow(item, measurement);
  if (row.length || row.size) return item.name + "  " + row.length_text + note;
  return item.name + "  \u00b1 " + millimetreText(row.plus_minus) + note;
}

OverlayRole labelRole(const SketchItem& item, const Measurement& measurement) {
  const bool warns = measurement.feature ? !measurement.feature->warnings.empty() : item.markedTwice();
  return warns || measurement.stale ? OverlayRole::kWarning : OverlayRole::kLabel;
}

void addEllipses(Overlay& overlay, const vision::View& view, const vision::Feature& feature) {
  for (const auto& vertex : feature.vertices) {
    auto outline = vision::errorEllipse(view, vertex.xyz, vertex.covariance);
    if (outline.empty()) continue;
    overlay.shapes.push_back({OverlayShape::Kind::kPolyline, OverlayRole::kEllipse, std::move(outline), {}});
  }
}

Eigen::Vector2d labelPlace(const SketchItem& item, SnapshotId snapshot) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (int vertex = 0; vertex < item.vertices(); ++vertex) {
    if (const SketchPick* pick = item.pick(snapshot, vertex)) {
      sum += pick->pixel;
      ++count;
    }
  }
  return count == 0 ? sum : Eigen::Vector2d(sum / count);
}

const SketchItem* draftOf(FeatureId id, const OverlayOptions& options) {
  const auto same = [id](const SketchItem* draft) { return draft->id == id; };
  const auto found = std::find_if(options.drafts.begin(), options.drafts.end(), same);
  return found == options.drafts.end() ? nullptr : *found;
}

struct ItemStyle {
  bool selected = false, with_handles = false;
  OverlayRole role = OverlayRole::kSketch;
};

void addEdges(Overlay& overlay, const SketchItem& item, const vision::Snapshot& snapshot, OverlayRole role) {
  for (const auto& [from, to] : edgesOf(item)) {
    const SketchPick* a = item.pick(snapshot.id, from);
    const SketchPick* b = item.pick(snapshot.id, to);
    if (a == nullptr || b == nullptr) continue;
    const OverlayRole edge = a->placed() && b->placed() ? role : OverlayRole::kUnplaced;
    overlay.shapes.push_back({OverlayShape::Kind::kPolyline, edge,
                              pictureOfEdge(snapshot.view.camera, a->pixel, b->pixel), {}});
  }
}

void addHandles(Overlay& overlay, const SketchItem& item, SnapshotId snapshot, const ItemStyle& style,
                const OverlayOptions& options) {
  for (int vertex = 0; vertex < item.vertices(); ++vertex) {
    const SketchPick* pick = item.pick(snapshot, vertex);
    if (pick == nullptr) continue;
    const bool active = item.id == options.active_item && vertex == options.active_vertex &&
                        snapshot == options.active_snapshot;
    OverlayRole role = style.with_handles ? OverlayRole::kHandle : style.role;
    if (!pick->placed()) role = OverlayRole::kUnplaced;
    if (active) role = OverlayRole::kActiveHandle;
    addMarker(overlay, role, pick->pixel);
  }
}

void addItem(Overlay& overlay, const Document& document, const SketchItem& item, const vision::Snapshot& snapshot,
             const OverlayOptions& options, bool is_draft) {
  const Measurement measured = is_draft ? document.measure(item) : document.measurement(item.id);
  ItemStyle style;
  style.selected = document.selection().contains(item.id) || is_draft;
  style.with_handles = style.selected && !item.locked;
  style.role = style.selected ? OverlayRole::kSelected : OverlayRole::kSketch;
  if (item.picks.count(snapshot.id) == 0) {
    if (measured.feature && measured.feature->parent == snapshot.view.parent) {
      vision::addFeature(*measured.feature, snapshot.view, style.role, &overlay);
    }
    return;
  }
  if (options.ellipses && measured.feature) addEllipses(overlay, snapshot.view, *measured.feature);
  if (measured.feature) vision::addSolid(*measured.feature, snapshot.view, OverlayRole::kSolid, &overlay);
  const std::size_t first = overlay.shapes.size();
  addEdges(overlay, item, snapshot, style.role);
  addHandles(overlay, item, snapshot.id, style, options);
  if (options.labels && item.placedIn(snapshot.id)) {
    addText(overlay, labelRole(item, measured), labelPlace(item, snapshot.id), labelOf(item, measured));
  }
  if (!item.colour) return;
  for (std::size_t i = first; i < overlay.shapes.size(); ++i) {
    overlay.shapes[i].colour_rgb = static_cast<int>(*item.colour & 0xffffffU);
  }
}

// A cross where a plan failed, with its code and stage.
void addFailure(Overlay& overlay, const vision::View& view, const planning::Plan& plan) {
  if (plan.ok() || !plan.failed_pose) return;
  const auto pixel = view.project(plan.failed_pose->translation());
  if (!pixel || !view.camera.containsPixel(*pixel)) return;
  const Eigen::Vector2d down(kCross, kCross), up(kCross, -kCross);
  for (const Eigen::Vector2d& arm : {down, up}) {
    overlay.shapes.push_back({OverlayShape::Kind::kPolyline, OverlayRole::kWarning, {*pixel - arm, *pixel + arm}, {}});
  }
  const std::string stage = plan.failed_stage.empty() ? std::string() : ", " + plan.failed_stage;
  addText(overlay, OverlayRole::kWarning, *pixel + Eigen::Vector2d(1.5 * kCross, 0), planning::toString(plan.status) + stage);
}

OverlayRole roleOf(planning::ClearanceBand band) {
  switch (band) {
    case planning::ClearanceBand::kTight: return OverlayRole::kPathTight;
    case planning::ClearanceBand::kNear: return OverlayRole::kPathNear;
    case planning::ClearanceBand::kFree: break;
  }
  return OverlayRole::kPath;
}

// How each point of planPath() is drawn, and with it the step that leads there.
std::vector<OverlayRole> rolesOf(const planning::Plan& plan, const std::vector<bool>& hidden) {
  std::vector<OverlayRole> roles;
  const double step_s = plan.trajectory.duration() / static_cast<double>(hidden.size() - 1);
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    const auto band = plan.clearance.empty() ? planning::ClearanceBand::kFree
                                             : planning::bandOf(planning::clearanceAt(plan.clearance, step_s * static_cast<double>(i)));
    roles.push_back(hidden[i] ? OverlayRole::kPathOccluded : roleOf(band));
  }
  return roles;
}

// In pieces that are drawn alike: by clearance where they are seen, dashed where a known body hides them.
void addPathPieces(Overlay& overlay, const std::vector<Eigen::Vector3d>& path, const std::vector<OverlayRole>& roles, const vision::View& view) {
  std::vector<Eigen::Vector3d> piece{path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    piece.push_back(path[i]);
    if (i + 1 < path.size() && roles[i + 1] == roles[i]) continue;
    vision::addPath(piece, view, roles[i], &overlay);
    piece = {path[i]};
  }
}

void addPlan(Overlay& overlay, const Document& document, const vision::View& view, const OverlayOptions& options) {
  if (options.path && document.plan()) addFailure(overlay, view, document.plan()->plan);
  if (!options.path || options.path_points == nullptr || options.path_points->size() < 2) return;
  const auto& path = *options.path_points;
  const auto hidden = hiddenBehind(bodiesInSight(document, view.parent), view.X_WC.translation(), path);
  addPathPieces(overlay, path, rolesOf(document.plan() ? document.plan()->plan : planning::Plan(), hidden), view);
}

}  // namespace

std::vector<Eigen::Vector2d> pictureOfEdge(const vision::CameraModel& camera, const Eigen::Vector2d& a,
                                           const Eigen::Vector2d& b) {
  if (!camera.hasDistortion()) return {a, b};
  const auto from = camera.normalisedOfPixel(a), to = camera.normalisedOfPixel(b);
  if (!from || !to) return {a, b};
  // Sag falls with the square of the number of pieces: 16 leave < 0.1 px of what a wide lens bends.
  constexpr int kPieces = 16;
  std::vector<Eigen::Vector2d> points{a};
  for (int i = 1; i < kPieces; ++i) {
    const double s = static_cast<double>(i) / kPieces;
    points.push_back(camera.pixelOfNormalised((1 - s) * *from + s * *to));
  }
  points.push_back(b);
  return points;
}

Overlay buildOverlay(const Document& document, SnapshotId id, const OverlayOptions& options) {
  Overlay overlay;
  const SnapshotPtr snapshot = document.snapshot(id);
  if (!snapshot) return overlay;
  addPlan(overlay, document, snapshot->view, options);
  for (const auto& body : document.world()) addWorldItem(body, snapshot->view, &overlay);
  for (const auto& item : document.items()) {
    if (draftOf(item.id, options) != nullptr) continue;
    if (!item.hidden) addItem(overlay, document, item, *snapshot, options, false);
  }
  // Last, so that what is being worked on lies on top.
  for (const SketchItem* draft : options.drafts) addItem(overlay, document, *draft, *snapshot, options, true);
  return overlay;
}

Overlay buildOverlay(const Document& document, const vision::View& view, const OverlayOptions& options) {
  Overlay overlay;
  addPlan(overlay, document, view, options);
  for (const auto& body : document.world()) addWorldItem(body, view, &overlay);
  for (const auto& item : document.items()) {
    const SketchItem* draft = draftOf(item.id, options);
    const Measurement measured = draft != nullptr ? document.measure(*draft) : document.measurement(item.id);
    if (item.hidden || !measured.feature || measured.feature->parent != view.parent) continue;
    const bool selected = document.selection().contains(item.id);
    vision::addFeature(*measured.feature, view, selected ? OverlayRole::kSelected : OverlayRole::kSketch, &overlay);
    if (!options.labels) continue;
    const auto pixel = view.project(measured.feature->vertices.front().xyz);
    if (pixel && view.camera.containsPixel(*pixel)) {
      addText(overlay, labelRole(item, measured), *pixel, labelOf(item, measured));
    }
  }
  return overlay;
}

std::vector<Eigen::Vector3d> planPath(const planning::Workcell& workcell, const planning::Plan& plan, double step_s) {
  std::vector<Eigen::Vector3d> path;
  if (!plan.ok() || plan.trajectory.empty() || !workcell.model) return path;
  const auto tip = workcell.model->linkIndex(workcell.arm.tip_link);
  if (!tip || plan.start_configuration.size() != workcell.model->dof()) return path;
  Eigen::VectorXd q = plan.start_configuration;
  const double duration = plan.trajectory.duration();
  const int steps = std::clamp(static_cast<int>(std::ceil(duration / step_s)), 1, 20000);
  JointState state;
  state.names = plan.trajectory.joint_names;
  for (int i = 0; i <= steps; ++i) {
    state.positions = plan.trajectory.sample(duration * i / steps).positions;
    workcell.model->assign(state, q);
    path.push_back(workcell.model->forward(q, *tip).translation());
  }
  return path;
}

}  // namespace longarm::session
