#include "session/controllers/held_controller.h"

#include <algorithm>

#include "planning/macros/grip.h"
#include "session/document/standing_items.h"

namespace longarm::session {

namespace {

constexpr double kAtEnd = 0.05;          // of every arm joint from the plan's end [rad or m]
constexpr int kPolls = 4;                // the gripper must say so this often: a finger that slips says both
constexpr double kMoved_m = 1e-3, kTurned = 2e-3;

Pose tipPose(const planning::Workcell& workcell, const Eigen::VectorXd& q) {
  const auto& model = *workcell.model;
  return model.forward(q, model.linkIndex(workcell.arm.tip_link).valueOr(model.rootLink()));
}

const std::string& rootFrame(const planning::Workcell& workcell) {
  return workcell.model->links()[static_cast<std::size_t>(workcell.model->rootLink())].name;
}

HeldBody attached(const planning::Workcell& workcell, planning::WorldObject body, const Eigen::VectorXd& q) {
  HeldBody held;
  held.body = std::move(body);
  held.body.X_WO = tipPose(workcell, q).inverse() * held.body.X_WO;
  held.body.attached_link = workcell.arm.tip_link;
  return held;
}

// Where a template stands when one of its parts is there.  What hangs on a hinge or runs on a slide takes nothing with it.
Pose frameOf(const WorldItem& item, const std::string& body, const Pose& X_WP) {
  for (const auto& part : item.parts) {
    if (item.name + "." + part.name == body && !part.moves) return X_WP * part.X_TP.inverse();
  }
  return item.X_WO;
}

}  // namespace

planning::WorldObject HeldBody::at(const planning::Workcell& workcell, const Eigen::VectorXd& q) const {
  planning::WorldObject out = body;
  out.X_WO = tipPose(workcell, q) * body.X_WO;
  out.attached_link.clear();
  return out;
}

HeldController::HeldController(Document& document, WorldController& world, QObject* parent)
    : QObject(parent), m_document(document), m_world(world) {}

void HeldController::forget() {
  m_holding = false;
  m_different = 0;
  if (!m_held) return;
  m_held.reset();
  Q_EMIT changed();
}

void HeldController::refresh(bool holding, const Eigen::VectorXd& q) {
  const auto& workcell = m_document.workcell();
  if (!workcell || !workcell->model || q.size() != workcell->model->dof()) return;
  m_different = holding == m_holding ? 0 : m_different + 1;
  if (m_different < kPolls) return;
  m_different = 0;
  m_holding = holding;
  if (holding) take(q);
  else putDown(q);
}

void HeldController::take(const Eigen::VectorXd& q) {
  m_held = find(q);
  if (!m_held) {
    Q_EMIT said(tr("The gripper holds something that is not known: mark it and add it to the world before you move it far."));
    return;
  }
  Q_EMIT changed();
  Q_EMIT said(tr("The gripper holds '%1': motions are planned with it.").arg(QString::fromStdString(m_held->body.name)));
}

std::optional<HeldBody> HeldController::find(const Eigen::VectorXd& q) const {
  if (auto planned = fromPlan(q)) return planned;
  return fromFingers(q);
}

std::optional<HeldBody> HeldController::fromPlan(const Eigen::VectorXd& q) const {
  const auto& record = m_document.plan();
  const auto& workcell = *m_document.workcell();
  // The step of a template takes one of its bodies, which the fingers tell.
  if (!record || !record->plan.ok() || !record->plan.grasped || !record->feature.valid()) return std::nullopt;
  const Eigen::VectorXd arm = planning::groupPositions(*workcell.model, workcell.arm, q);
  const Eigen::VectorXd& end = record->plan.trajectory.points.back().positions;
  if (end.size() != arm.size() || (end - arm).cwiseAbs().maxCoeff() > kAtEnd) return std::nullopt;
  HeldBody held = attached(workcell, *record->plan.grasped, q);
  held.feature = record->feature;
  for (const auto& item : m_document.world()) {
    if (item.source == held.feature && item.role == WorldRole::kObstacle) held.item = item.id;
  }
  return held;
}

std::optional<HeldBody> HeldController::fromFingers(const Eigen::VectorXd& q) const {
  const auto& workcell = *m_document.workcell();
  std::vector<planning::WorldObject> bodies = workcell.objects;
  std::vector<const WorldItem*> items(bodies.size(), nullptr);
  const std::vector<WorldItem> standing = standingItems(m_document);
  for (const auto& item : standing) {
    if (item.parent != rootFrame(workcell)) continue;
    for (auto& body : bodiesOf(item, false)) {
      bodies.push_back(std::move(body));
      items.push_back(&item);
    }
  }
  const planning::Grip grip = planning::gripAt(workcell, bodies, q);
  if (grip.held.empty()) return std::nullopt;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].name != grip.held.front()) continue;
    HeldBody held = attached(workcell, bodies[i], q);
    if (items[i] != nullptr) {
      held.item = items[i]->id;
      held.feature = items[i]->source;
    }
    return held;
  }
  return std::nullopt;
}

void HeldController::putDown(const Eigen::VectorXd& q) {
  if (!m_held) return;
  const HeldBody held = *std::exchange(m_held, std::nullopt);
  const QString name = QString::fromStdString(held.body.name);
  const WorldItem* item = held.item.valid() ? m_document.worldItem(held.item) : nullptr;
  if (item != nullptr && item->kind != WorldKind::kPoints) {
    WorldItem after = *item;
    const Pose X_WO = held.at(*m_document.workcell(), q).X_WO;
    after.X_WO = item->kind == WorldKind::kTemplate ? frameOf(*item, held.body.name, X_WO) : X_WO;
    const bool moved = (after.X_WO.translation() - item->X_WO.translation()).norm() > kMoved_m ||
                       angleBetween(after.X_WO.linear(), item->X_WO.linear()) > kTurned;
    const Status done = moved ? m_world.edit(after) : Status();
    Q_EMIT said(done ? tr("'%1' was let go of: the world has it where it is now.").arg(name)
                     : QString::fromStdString(done.error().message));
  } else {
    Q_EMIT said(tr("'%1' was let go of. What was measured of it shows where it stood before: mark it again to use it.").arg(name));
  }
  Q_EMIT changed();
}

std::vector<planning::WorldObject> HeldController::obstacles(FeatureId skip) const {
  const auto& workcell = m_document.workcell();
  if (!workcell || !workcell->model) return {};
  std::vector<WorldItem> items = standingItems(m_document);
  if (m_held && m_held->item.valid()) {
    items.erase(std::remove_if(items.begin(), items.end(), [this](const WorldItem& item) { return item.id == m_held->item; }), items.end());
  }
  return obstaclesOf(items, rootFrame(*workcell), skip);
}

}  // namespace longarm::session
