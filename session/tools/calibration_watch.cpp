#include "session/tools/calibration_watch.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "session/tools/pick_editor.h"

namespace longarm::session {

namespace {

PairMisses& pairOf(CalibrationConcern& concern, const std::string& a, const std::string& b) {
  const auto found = std::find_if(concern.pairs.begin(), concern.pairs.end(),
                                  [&](const PairMisses& pair) { return pair.first == a && pair.second == b; });
  if (found != concern.pairs.end()) return *found;
  concern.pairs.push_back({a, b, vision::MissStatistic()});
  return concern.pairs.back();
}

// The sign of a miss depends on which camera comes first.
void addMiss(CalibrationConcern& concern, const vision::Snapshot& from, const Eigen::Vector2d& from_pixel,
             const vision::Snapshot& to, const Eigen::Vector2d& to_pixel) {
  const bool swap = to.view.name < from.view.name;
  const auto miss = swap ? vision::epipolarMiss(to.view, to_pixel, from.view, from_pixel)
                         : vision::epipolarMiss(from.view, from_pixel, to.view, to_pixel);
  if (!miss) return;
  pairOf(concern, swap ? to.view.name : from.view.name, swap ? from.view.name : to.view.name).statistic.add(*miss);
}

void addIfOff(CalibrationConcern& concern, const OffBandPick& where, const vision::Snapshot& from, const SketchPick& from_pick,
              const vision::Snapshot& to, const SketchPick& to_pick) {
  const auto curve = vision::epipolarCurve(from.view, from_pick.pixel, to.view);
  if (!curve || curve->points.empty()) return;
  const auto band = vision::epipolarBand(from.view, from_pick.pixel, to.view, *curve);
  const auto nearest = curve->nearest(to_pick.pixel);
  if (!band || !nearest) return;
  std::size_t at = 0;
  for (std::size_t i = 1; i < curve->points.size(); ++i) {
    if ((curve->points[i].pixel - nearest->pixel).norm() < (curve->points[at].pixel - nearest->pixel).norm()) at = i;
  }
  const double pick_sigma = to_pick.sigma_px > 0 ? to_pick.sigma_px : to.view.sigma_px;
  OffBandPick off = where;
  off.off_px = (to_pick.pixel - nearest->pixel).norm();
  off.limit_px = 3 * std::hypot((*band)[at], pick_sigma);
  if (off.off_px > off.limit_px) concern.off.push_back(off);
}

// Of two free picks only one judges the other, or every miss would count twice.
bool judges(const SketchPick& from, SnapshotId from_id, const SketchPick& to, SnapshotId to_id) {
  if (to.state == PickState::kReleased || to.state == PickState::kMatched) return true;
  return to.state == PickState::kFree && from.state == PickState::kFree && from_id.value < to_id.value;
}

void addVertex(CalibrationConcern& concern, const Document& document, const SketchItem& item, int vertex) {
  for (const auto& [id, list] : item.picks) {
    const SketchPick* to_pick = item.pick(id, vertex);
    const SnapshotPtr to = document.snapshot(id);
    if (!to || to_pick == nullptr || !to_pick->placed()) continue;
    const SnapshotPtr from = document.snapshot(constrainingSnapshot(document, item, id, vertex));
    if (!from) continue;
    const SketchPick* from_pick = item.pick(from->id, vertex);
    if (!judges(*from_pick, from->id, *to_pick, id)) continue;
    addMiss(concern, *from, from_pick->pixel, *to, to_pick->pixel);
    addIfOff(concern, {item.id, vertex, from->id, id}, *from, *from_pick, *to, *to_pick);
  }
}

std::string pairText(const PairMisses& pair) {
  return pair.first + " and " + pair.second + ": " + std::to_string(pair.statistic.count()) +
         (pair.statistic.count() == 1 ? " pick misses by " : " picks miss by ") + formatFixed(pair.statistic.rmsPx(), 1) +
         " px RMS, " + formatFixed(pair.statistic.meanPx(), 1) + " px mean.";
}

}  // namespace

const PairMisses* CalibrationConcern::pair(const std::string& a, const std::string& b) const {
  for (const auto& each : pairs) {
    if ((each.first == a && each.second == b) || (each.first == b && each.second == a)) return &each;
  }
  return nullptr;
}

CalibrationConcern calibrationConcern(const Document& document) {
  CalibrationConcern concern;
  for (const auto& item : document.items()) {
    for (int vertex = 0; vertex < item.vertices(); ++vertex) addVertex(concern, document, item, vertex);
  }
  return concern;
}

std::string calibrationWarning(const Document& document, const CalibrationConcern& concern) {
  if (!concern.off.empty()) {
    const OffBandPick& worst = *std::max_element(concern.off.begin(), concern.off.end(), [](const auto& a, const auto& b) {
      return a.off_px / a.limit_px < b.off_px / b.limit_px;
    });
    const SnapshotPtr from = document.snapshot(worst.from), to = document.snapshot(worst.to);
    std::string text = "'" + document.item(worst.item)->name + "' lies " + formatFixed(worst.off_px, 1) + " px off its curve in " +
                       to->view.name + ", beyond the band (3 sigma are " + formatFixed(worst.limit_px, 1) + " px). ";
    if (const PairMisses* pair = concern.pair(from->view.name, to->view.name)) text += pairText(*pair) + " ";
    return text + "Correct the pick; if it is right, a camera was moved: check the calibration.";
  }
  for (const auto& pair : concern.pairs) {
    const std::string warning = pair.statistic.warning();
    if (!warning.empty()) return pair.first + " and " + pair.second + ": " + warning;
  }
  return {};
}

}  // namespace longarm::session
