#include "ui/scene_contents.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "session/document/standing_items.h"

namespace longarm::ui {

namespace {

constexpr double kGhost = 0.35;
constexpr double kSeparate = 0.05;         // A ghost nearer to the robot than this is not drawn [rad or m].
constexpr double kVisible = 5e-4;          // Smaller joint changes are encoder noise [rad or m].
constexpr double kAroundSelection_m = 0.25;

const Eigen::Vector3d kLeftColor{0.95, 0.75, 0.2}, kRightColor{0.3, 0.75, 0.95};

}  // namespace

SceneContents::SceneContents(vtkRenderer* renderer) : m_renderer(renderer) {
  m_grid.update(3, 0.25);
  m_axes.update(Pose::Identity(), 0.25);
  m_grid.addTo(renderer);
  m_axes.addTo(renderer);
  m_sketch.addTo(renderer);
  m_dimension.addTo(renderer);
  m_sketched_world.addTo(renderer);
  for (auto& frustum : m_frustums) frustum.addTo(renderer);
  setOpacity(m_opacity);
}

SceneContents::~SceneContents() = default;

void SceneContents::setWorkcell(std::shared_ptr<const planning::Workcell> workcell) {
  m_robot.reset();
  m_plan.reset();
  m_world.reset();
  m_workcell = std::move(workcell);
  m_drawn.resize(0);
  m_ghost = false;
  if (!m_workcell || !m_workcell->model) return;
  m_robot = std::make_unique<scene::RobotRep>(m_workcell->model);
  m_robot->addTo(m_renderer);
  m_plan = std::make_unique<scene::PlanRep>(m_workcell->model, m_workcell->arm.tip_link);
  m_plan->addTo(m_renderer);
  m_world = std::make_unique<scene::WorldRep>();
  m_world->addTo(m_renderer);
  setJoints(nullptr);
}

bool SceneContents::setJoints(const JointState* joints) {
  if (!m_robot) return false;
  const auto& model = *m_workcell->model;
  Eigen::VectorXd q = model.neutral();
  if (joints != nullptr) model.assign(*joints, q);
  const bool ghost = joints == nullptr;
  const bool same = m_drawn.size() == q.size() && (q - m_drawn).cwiseAbs().maxCoeff() < kVisible;
  if (same && ghost == m_ghost) return false;
  m_drawn = q;
  std::vector<Pose> X_WL;
  model.forward(q, X_WL);
  m_robot->update(X_WL);
  if (ghost != m_ghost) {
    m_ghost = ghost;
    scene::RobotLook look;
    look.opacity = ghost ? kGhost : 1;
    m_robot->setLook(look);
  }
  for (std::size_t i = 0; i < model.links().size(); ++i) m_link_poses[model.links()[i].name] = X_WL[i];
  placeBodies();
  refreshGhost();
  return true;
}

void SceneContents::setSketch(const session::Document& document) {
  std::vector<scene::SketchItem> items;
  for (const auto& item : document.items()) {
    const auto& measured = document.measurement(item.id).feature;
    if (!measured) continue;
    scene::SketchItem drawn;
    drawn.feature = *measured;
    drawn.selected = document.selection().contains(item.id);
    drawn.visible = !item.hidden;
    drawn.stale = document.measurement(item.id).stale;
    items.push_back(std::move(drawn));
  }
  m_sketch.update(items);
}

void SceneContents::setWorld(const session::Document& document, const std::optional<session::HeldBody>& held) {
  m_bodies.clear();
  for (const auto& item : session::standingItems(document)) {
    if (item.hidden || (held && held->item == item.id)) continue;
    for (auto& body : session::bodiesOf(item, false)) m_bodies.push_back(std::move(body));
  }
  if (held) m_bodies.push_back(held->body);
  m_held = held ? held->body.name : std::string();
  placeBodies();
}

void SceneContents::placeBodies() {
  m_sketched_world.update(m_bodies, m_link_poses);
  if (!m_world) return;
  std::vector<planning::WorldObject> fixed;
  for (const auto& object : m_workcell->objects) {
    if (m_held.empty() || object.name != m_held) fixed.push_back(object);
  }
  m_world->update(fixed, m_link_poses);
}

bool SceneContents::setDimension(const std::optional<session::SceneDimension>& dimension) {
  if (dimension == m_measured) return false;
  m_measured = dimension;
  m_dimension.update(dimension ? dimension->points : std::vector<Eigen::Vector3d>(), dimension ? dimension->text : std::string());
  return true;
}

void SceneContents::setPlan(const session::Document& document) {
  if (!m_plan) return;
  m_trajectory = {};
  if (document.plan()) {
    m_plan->update(document.plan()->plan);
    m_trajectory = document.plan()->plan.trajectory;
  } else {
    m_plan->clear();
  }
  refreshGhost();
}

void SceneContents::setCursor(double t_s) {
  m_cursor_s = t_s;
  if (!m_plan) return;
  m_plan->scrub(t_s);
  refreshGhost();
}

// Two robots in one place would flicker through each other.
void SceneContents::refreshGhost() {
  if (!m_plan || m_trajectory.empty()) return;
  const auto& names = m_workcell->model->actuatedNames();
  const Eigen::VectorXd there = m_trajectory.sample(m_cursor_s).positions;
  double apart = 0;
  for (std::size_t i = 0; i < m_trajectory.joint_names.size(); ++i) {
    const auto found = std::find(names.begin(), names.end(), m_trajectory.joint_names[i]);
    if (found == names.end() || m_drawn.size() == 0) continue;
    apart = std::max(apart, std::abs(there(static_cast<Eigen::Index>(i)) - m_drawn(found - names.begin())));
  }
  m_plan->setGhostVisible(apart > kSeparate);
}

void SceneContents::setPicture(vision::PaneSide side, const std::optional<vision::View>& view, const cv::Mat& picture) {
  auto& frustum = m_frustums[static_cast<std::size_t>(side)];
  frustum.setVisible(view.has_value());
  if (view) frustum.update(*view, picture);
}

void SceneContents::setOpacity(double opacity) {
  m_opacity = opacity;
  for (std::size_t i = 0; i < m_frustums.size(); ++i) {
    scene::FrustumLook look;
    look.opacity = opacity;
    look.color = i == 0 ? kLeftColor : kRightColor;
    m_frustums[i].setLook(look);
  }
}

Eigen::AlignedBox3d SceneContents::everything() const {
  Eigen::AlignedBox3d box;
  const auto add = [&box](const scene::Representation& part) {
    const auto around = part.bounds();
    if (!around.isEmpty()) box.extend(around);
  };
  if (m_robot) add(*m_robot);
  if (m_world) add(*m_world);
  if (m_plan) add(*m_plan);
  add(m_sketch);
  add(m_sketched_world);
  for (const auto& frustum : m_frustums) add(frustum);
  return box;
}

Eigen::AlignedBox3d SceneContents::selection(const session::Document& document) const {
  Eigen::AlignedBox3d box;
  for (const auto id : document.selection().items) {
    const auto& measured = document.measurement(id).feature;
    if (!measured) continue;
    for (const auto& vertex : measured->vertices) box.extend(vertex.xyz);
  }
  if (box.isEmpty()) return box;
  return {box.min().array() - kAroundSelection_m, box.max().array() + kAroundSelection_m};
}

std::vector<widgets::Pickable> SceneContents::pickables(const session::Document& document) const {
  std::vector<widgets::Pickable> found;
  for (const auto& item : document.items()) {
    const auto& measured = document.measurement(item.id).feature;
    if (!measured || item.hidden) continue;
    widgets::Pickable pickable;
    pickable.id = item.id.value;
    for (const auto& vertex : measured->vertices) pickable.points.push_back(vertex.xyz);
    found.push_back(std::move(pickable));
  }
  return found;
}

}  // namespace longarm::ui
