#include "session/controllers/view_adviser.h"

#include <utility>

#include "core/text.h"
#include "session/controllers/snapshot_maker.h"
#include "session/tools/baseline_watch.h"

namespace longarm::session {

using Eigen::Vector3d;

namespace {

/// A vertex of the item that lies on the robot in one of the panes; else its first that is placed at all.
struct Mark {
  int vertex = -1;
  std::optional<PaneSide> on_robot;
};

Mark markOf(const SketchItem& item, const std::vector<PickOnRobot>& on_robot) {
  for (const auto& pick : on_robot) {
    if (pick.item == item.id) return {pick.vertex, pick.side};
  }
  for (int vertex = 0; vertex < item.vertices(); ++vertex) {
    if (item.placedCount(vertex) > 0) return {vertex, {}};
  }
  return {};
}

const SketchPick* placedPick(const SketchItem& item, const SnapshotPtr& picture, int vertex) {
  const SketchPick* pick = picture ? item.pick(picture->id, vertex) : nullptr;
  return pick != nullptr && pick->placed() ? pick : nullptr;
}

}  // namespace

Result<ViewAdviser::Question> ViewAdviser::question(FeatureId feature) const {
  const Handle active = m_targeting.activeHandle();
  if (!feature.valid()) feature = active.valid() ? active.item : m_document.selection().primary;
  const SketchItem* item = m_document.item(feature);
  const SnapshotPtr panes[] = {m_document.paneSnapshot(PaneSide::kLeft), m_document.paneSnapshot(PaneSide::kRight)};
  if (item == nullptr) return Error{ErrorCode::kRefused, "Mark or select a feature first: the clearest view is looked for around it."};
  if (!panes[0] || !panes[1] || panes[0] == panes[1]) return Error{ErrorCode::kRefused, "Show two pictures first: the clearest partner of one of them is looked for."};
  const Mark mark = markOf(*item, picksOnRobot(m_document, m_targeting.ownLinks()));
  if (mark.vertex < 0) return Error{ErrorCode::kRefused, "Nothing of '" + item->name + "' is marked yet."};
  // The pick that is not on the robot says where the thing is; one on the robot at least in which direction it was looked for.
  const PaneSide doubtful = mark.on_robot.value_or(placedPick(*item, panes[0], mark.vertex) != nullptr ? PaneSide::kRight : PaneSide::kLeft);
  PaneSide from = otherSide(doubtful);
  if (placedPick(*item, panes[static_cast<int>(from)], mark.vertex) == nullptr) from = doubtful;
  const SketchPick* pick = placedPick(*item, panes[static_cast<int>(from)], mark.vertex);
  if (pick == nullptr) return Error{ErrorCode::kRefused, "'" + item->name + "' is not marked in the pictures that are shown."};
  const vision::View& view = panes[static_cast<int>(from)]->view;
  const auto ray = view.camera.rayOfPixel(pick->pixel);
  if (!ray) return ray.error();
  const Measurement& measured = m_document.measurement(item->id);
  double depth = baselineOf(panes[0]->view, panes[1]->view).depth_m;
  if (measured.feature && !item->pipe) {
    depth = (view.X_WC.inverse() * measured.feature->vertices[static_cast<std::size_t>(mark.vertex)].xyz).z();
  }
  Question question{item->name, view.X_WC * Vector3d(*ray * (depth / ray->z())), doubtful};
  if (mark.on_robot) return question;
  const auto share = [&](PaneSide side) {
    const auto links = m_targeting.ownLinks().of(panes[static_cast<int>(side)], m_document.workcell());
    ViewCandidate shown{panes[static_cast<int>(side)]->id, panes[static_cast<int>(side)]->view, nullptr};
    if (links) shown.mask = {links, &links->mask};
    return hiddenShare(shown, question.place);
  };
  question.side = share(PaneSide::kLeft) > share(PaneSide::kRight) ? PaneSide::kLeft : PaneSide::kRight;
  return question;
}

std::vector<ViewCandidate> ViewAdviser::candidates(PaneSide side) const {
  std::vector<ViewCandidate> all;
  const SnapshotId kept = m_document.paneSnapshotId(otherSide(side));
  for (const auto& snapshot : m_document.snapshots()) {
    if (snapshot->id == kept) continue;
    const auto links = m_targeting.ownLinks().of(snapshot, m_document.workcell());
    ViewCandidate candidate{snapshot->id, snapshot->view, nullptr};
    if (links) candidate.mask = {links, &links->mask};
    all.push_back(std::move(candidate));
  }
  const auto joints = m_feed != nullptr ? m_feed->jointState() : nullptr;
  if (!joints || !m_document.workcell()) return all;
  for (const auto& camera : m_document.workcell()->cameras) {
    auto view = cameraView(*m_document.workcell(), camera.name, *joints);
    if (!view) continue;
    auto mask = m_targeting.ownLinks().maskOf(*view, *joints, *m_document.workcell());
    all.push_back({SnapshotId{}, std::move(*view), std::move(mask)});
  }
  return all;
}

Result<ViewAdvice> ViewAdviser::advise(FeatureId feature) const {
  const auto asked = question(feature);
  if (!asked) return asked.error();
  const SnapshotPtr kept = m_document.paneSnapshot(otherSide(asked->side)), shown = m_document.paneSnapshot(asked->side);
  const auto all = candidates(asked->side);
  const auto ranks = rankViews(asked->place, kept->view, all);
  if (ranks.empty()) {
    return Error{ErrorCode::kRefused, "No picture and no camera sees the place of '" + asked->name + "' beside " + kept->view.name +
                                          ": turn the head or move the arm, and take another."};
  }
  const ViewRank& best = ranks.front();
  const ViewCandidate& chosen = all[best.candidate];
  ViewAdvice advice{asked->side, chosen.snapshot, chosen.view.name, chosen.snapshot == shown->id, {}};
  const std::string pane = asked->side == PaneSide::kLeft ? "left" : "right";
  if (advice.already_shown) {
    advice.text = "The " + pane + " pane has the clearest view of '" + asked->name + "' that there is (" + rankText(best) + ").";
    return advice;
  }
  advice.text = "The clearest view of '" + asked->name + "' for the " + pane + " pane is " + chosen.view.name +
                (chosen.snapshot.valid() ? ", in the library (" : ", as it stands now (") + rankText(best) + ").";
  return advice;
}

}  // namespace longarm::session
