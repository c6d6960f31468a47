#include "session/tools/own_links.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace longarm::session {

using Eigen::Vector2d;

namespace {

constexpr double kSimplify_cells = 0.7;    // An outline need not show every step of the cells.

bool knowsEveryJoint(const JointState& state, const planning::RobotModel& model) {
  const auto& names = model.actuatedNames();
  return !names.empty() && std::all_of(names.begin(), names.end(), [&](const auto& name) { return state.position(name).ok(); });
}

// Edge of the area in raw pixels; cells are counted by their middles, so that the line runs half a cell inside.
std::vector<Vector2d> outlineOf(const std::vector<cv::Point>& contour, int cell_px) {
  std::vector<cv::Point> simple;
  cv::approxPolyDP(contour, simple, kSimplify_cells, true);
  std::vector<Vector2d> points;
  for (const auto& p : simple) points.push_back(Vector2d(p.x, p.y) * cell_px + Vector2d::Constant((cell_px - 1) / 2.0));
  return points;
}

// One shape per connected area.  Holes are reached by a cut that is filled from both sides, and so not seen.
std::vector<vision::OverlayShape> areasOf(const planning::LinkMask& mask) {
  cv::Mat covered(mask.rows, mask.columns, CV_8UC1);
  for (std::size_t i = 0; i < mask.links.size(); ++i) covered.data[i] = mask.links[i] >= 0 ? 255 : 0;
  std::vector<std::vector<cv::Point>> contours;
  std::vector<cv::Vec4i> tree;               // next, previous, first hole, parent
  cv::findContours(covered, contours, tree, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  std::vector<vision::OverlayShape> areas;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (tree[i][3] >= 0) continue;
    vision::OverlayShape area{vision::OverlayShape::Kind::kArea, vision::OverlayRole::kOwnLink, outlineOf(contours[i], mask.cell_px), {}};
    if (area.points.size() < 3) continue;
    const Vector2d start = area.points.front();
    for (int hole = tree[i][2]; hole >= 0; hole = tree[static_cast<std::size_t>(hole)][0]) {
      const auto around = outlineOf(contours[static_cast<std::size_t>(hole)], mask.cell_px);
      if (around.size() < 3) continue;
      area.points.push_back(start);
      area.points.insert(area.points.end(), around.begin(), around.end());
      area.points.push_back(around.front());
    }
    areas.push_back(std::move(area));
  }
  return areas;
}

}  // namespace

std::string OwnLinks::linkAt(const Vector2d& pixel) const {
  const int link = mask.linkAt(pixel);
  return link < 0 ? std::string() : model->links()[static_cast<std::size_t>(link)].name;
}

const planning::LinkSilhouettes* OwnLinksCache::silhouettesOf(const planning::Workcell& workcell) {
  if (!workcell.model) return nullptr;
  if (!m_silhouettes || &m_silhouettes->model() != workcell.model.get()) {
    m_silhouettes = std::make_unique<planning::LinkSilhouettes>(workcell.model);
  }
  return m_silhouettes.get();
}

std::shared_ptr<const planning::LinkMask> OwnLinksCache::maskOf(const vision::View& view, const JointState& joints,
                                                                const planning::Workcell& workcell) {
  const auto* silhouettes = silhouettesOf(workcell);
  if (silhouettes == nullptr || !knowsEveryJoint(joints, *workcell.model)) return nullptr;
  Eigen::VectorXd q = workcell.model->neutral();
  workcell.model->assign(joints, q);
  auto mask = silhouettes->maskOf(q, view);
  return mask ? std::make_shared<const planning::LinkMask>(std::move(*mask)) : nullptr;
}

OwnLinksPtr OwnLinksCache::of(const vision::SnapshotPtr& picture, const std::shared_ptr<const planning::Workcell>& workcell) {
  if (!picture || !workcell) return nullptr;
  Entry& entry = m_entries[picture->id];
  if (entry.picture.lock() == picture && entry.model == workcell->model) return entry.links;
  entry = {picture, workcell->model, nullptr};
  const auto mask = maskOf(picture->view, picture->robot_state, *workcell);
  if (mask) entry.links = std::make_shared<const OwnLinks>(OwnLinks{workcell->model, *mask, areasOf(*mask)});
  const OwnLinksPtr found = entry.links;
  for (auto it = m_entries.begin(); it != m_entries.end();) it = it->second.picture.expired() ? m_entries.erase(it) : std::next(it);
  return found;
}

std::vector<PickOnRobot> picksOnRobot(const Document& document, OwnLinksCache& cache) {
  std::vector<PickOnRobot> found;
  for (const PaneSide side : {PaneSide::kLeft, PaneSide::kRight}) {
    const SnapshotPtr picture = document.paneSnapshot(side);
    const auto links = cache.of(picture, document.workcell());
    if (!links) continue;
    for (const auto& item : document.items()) {
      for (int vertex = 0; vertex < item.vertices() && !item.hidden; ++vertex) {
        const SketchPick* pick = item.pick(picture->id, vertex);
        const std::string link = pick != nullptr && pick->placed() ? links->linkAt(pick->pixel) : std::string();
        if (!link.empty()) found.push_back({item.id, vertex, side, link});
      }
    }
  }
  return found;
}

std::string onRobotText(const Document& document, const PickOnRobot& pick) {
  const SketchItem* item = document.item(pick.item);
  const SnapshotPtr picture = document.paneSnapshot(pick.side);
  if (item == nullptr || !picture) return {};
  return "'" + item->name + "' is marked on the robot's own " + pick.link + " in " + picture->view.name +
         ": it hides what lies behind it, and moves with the robot.";
}

}  // namespace longarm::session
