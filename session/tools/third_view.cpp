#include "session/tools/third_view.h"

#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "core/text.h"
#include "vision/sketch/overlay.h"
#include "vision/stereo/triangulate.h"

namespace longarm::session {

namespace {

std::vector<vision::Sighting> othersOf(const Document& document, const SketchItem& item, int vertex, SnapshotId picture) {
  std::vector<vision::Sighting> others;
  for (const auto& [id, list] : item.picks) {
    const SketchPick* pick = item.pick(id, vertex);
    const SnapshotPtr snapshot = document.snapshot(id);
    if (id == picture || pick == nullptr || !pick->placed() || !snapshot) continue;
    others.push_back({&snapshot->view, pick->pixel, pick->sigma_px});
  }
  return others;
}

void predict(ThirdView& out, const std::vector<vision::Sighting>& others, const vision::View& view, double pick_sigma_px) {
  const auto point = vision::triangulate(others);
  if (!point) return;
  const Eigen::Matrix3d R = view.X_WC.linear();
  const auto projection = view.camera.projectWithJacobian(R.transpose() * (point->xyz - view.X_WC.translation()));
  if (!projection) return;
  const Eigen::Matrix<double, 2, 3> J = projection->d_point * R.transpose();
  out.predicted = projection->pixel;
  out.covariance = J * point->covariance * J.transpose() + pick_sigma_px * pick_sigma_px * Eigen::Matrix2d::Identity();
}

}  // namespace

ThirdView thirdView(const Document& document, const SketchItem& item, int vertex, SnapshotId picture) {
  ThirdView out;
  const SnapshotPtr here = document.snapshot(picture);
  if (!here || item.pipe || item.edge) return out;
  const auto others = othersOf(document, item, vertex, picture);
  for (const auto& other : others) {
    auto curve = vision::epipolarCurve(*other.view, other.pixel, here->view);
    if (curve && !curve->points.empty()) out.curves.push_back(std::move(*curve));
  }
  const SketchPick* pick = item.pick(picture, vertex);
  const bool placed = pick != nullptr && pick->placed();
  if (others.size() < 2) return out;
  predict(out, others, here->view, placed && pick->sigma_px > 0 ? pick->sigma_px : here->view.sigma_px);
  if (!out.predicted || !placed) return out;
  const Eigen::Vector2d off = pick->pixel - *out.predicted;
  out.off_sigmas = std::sqrt(std::max(0.0, off.dot(out.covariance.ldlt().solve(off))));
  return out;
}

void addThirdView(const Document& document, const SketchItem* item, int vertex, SnapshotId picture, vision::Overlay* overlay) {
  using Shape = vision::OverlayShape;
  if (item != nullptr && vertex >= 0 && vertex < item->vertices()) {
    const ThirdView view = thirdView(document, *item, vertex, picture);
    for (const auto& curve : view.curves) vision::addEpipolarCurve(curve, overlay);
    if (view.predicted) overlay->shapes.push_back({Shape::Kind::kMarker, vision::OverlayRole::kMatch, {*view.predicted}, {}});
  }
  for (const auto& each : document.items()) {
    for (int i = 0; i < each.vertices() && !each.hidden; ++i) {
      const ThirdView view = thirdView(document, each, i, picture);
      if (!view.flagged()) continue;
      const Eigen::Vector2d& at = each.pick(picture, i)->pixel;
      overlay->shapes.push_back({Shape::Kind::kPolyline, vision::OverlayRole::kWarning, {at, *view.predicted}, {}});
      overlay->shapes.push_back({Shape::Kind::kText, vision::OverlayRole::kWarning, {at}, formatFixed(*view.off_sigmas, 1) + " \u03c3 off"});
    }
  }
}

std::string thirdViewWarning(const Document& document, SnapshotId picture) {
  const SnapshotPtr snapshot = document.snapshot(picture);
  double worst = 0;
  std::string text;
  for (const auto& item : document.items()) {
    for (int vertex = 0; snapshot && vertex < item.vertices(); ++vertex) {
      const ThirdView view = thirdView(document, item, vertex, picture);
      if (!view.flagged() || *view.off_sigmas <= worst) continue;
      worst = *view.off_sigmas;
      text = "'" + item.name + "' is marked " + formatFixed((item.pick(picture, vertex)->pixel - *view.predicted).norm(), 1) + " px (" +
             formatFixed(worst, 1) + " sigma) from where the other pictures see it in " + snapshot->view.name +
             ". One of the picks is on another spot, or a camera was moved.";
    }
  }
  return text;
}

int nearestPredicted(const Document& document, const SketchItem& item, SnapshotId picture, const Eigen::Vector2d& pixel) {
  int best = -1;
  double nearest = std::numeric_limits<double>::infinity();
  for (int vertex = 0; vertex < item.vertices(); ++vertex) {
    const ThirdView view = thirdView(document, item, vertex, picture);
    if (!view.predicted || (*view.predicted - pixel).norm() >= nearest) continue;
    nearest = (*view.predicted - pixel).norm();
    best = vertex;
  }
  return best;
}

}  // namespace longarm::session
