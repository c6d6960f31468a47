#include "session/controllers/template_controller.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/clock.h"
#include "session/commands/world_commands.h"
#include "session/document/template_item.h"

namespace longarm::session {
namespace {

using planning::TemplateAction;
using planning::TemplateStep;
using Kind = planning::TemplateStep::Kind;

constexpr double kAtHand_m = 0.03;       // The tool point so near to a handle has it between its fingers.
constexpr double kFingerThere = GripperWatch::kThere;

// The nearest point of a line's segment, of a box, or a point itself.
Eigen::Vector3d nearestOn(const vision::Feature& feature, const Eigen::Vector3d& p) {
  Eigen::Vector3d out = feature.vertices.front().xyz;
  for (std::size_t i = 1; i < feature.vertices.size(); ++i) {
    const Eigen::Vector3d edge = feature.vertices[i].xyz - feature.vertices.front().xyz;
    const double along = std::clamp((p - feature.vertices.front().xyz).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    out += along * edge;
  }
  return out;
}

// A correction puts the motion with its way off the path and back in place of the plan.
bool isCorrectionOf(const TemplateStep& step, const PlanRecord& record) {
  return record.macro == step.macro && std::any_of(record.plan.stages.begin(), record.plan.stages.end(),
                                                   [](const auto& stage) { return stage.name == "correction"; });
}

QString placeOf(std::size_t step, const TemplateAction& action) {
  return TemplateController::tr("%1 of %2").arg(step + 1).arg(action.steps.size());
}

}  // namespace

TemplateController::TemplateController(Document& document, EditHistory& history, PlanController& plans, WorldController& world,
                                       QObject* parent)
    : QObject(parent), m_document(document), m_history(history), m_plans(plans), m_world(world) {
  connect(&m_world, &WorldController::changed, this, &TemplateController::changed);
  connect(&m_plans, &PlanController::macrosChanged, this, &TemplateController::changed);
  connect(&m_plans, &PlanController::planned, this, [this](bool ok) {
    if (!m_run || m_run->phase != Phase::kPlanning) return;
    if (!ok) return end({});             // why is told already
    m_run->phase = Phase::kShown;
    m_run->plan = m_document.plan()->id;
    const auto action = actionOf(*m_run);
    if (action) tell(tr("%1: look at the motion, then press Play.").arg(placeOf(m_run->step, *action)));
  });
}

std::vector<std::string> TemplateController::reload() {
  std::vector<std::string> warnings;
  const auto& workcell = m_document.workcell();
  m_templates = planning::loadTemplates(workcell ? workcell->templates : std::vector<std::string>{}, &warnings);
  Q_EMIT changed();
  return warnings;
}

const planning::ObjectTemplate* TemplateController::found(const std::string& name) const {
  for (const auto& each : m_templates) {
    if (each.name() == name) return &each;
  }
  return nullptr;
}

const planning::ObjectTemplate* TemplateController::templateOf(const WorldItem& item) const {
  return item.kind == WorldKind::kTemplate ? found(item.template_name) : nullptr;
}

QString TemplateController::whyNotDrop(const QString& name) const {
  const auto* what = found(name.toStdString());
  if (what == nullptr) return tr("There is no template \"%1\".").arg(name);
  const FeatureId id = m_document.selection().primary;
  if (m_document.item(id) == nullptr) return tr("Select the feature that it is to be dropped onto: a plane, box, line or point.");
  const Measurement& measured = m_document.measurement(id);
  if (!measured.feature) return QString::fromStdString(measured.reason);
  const auto item = templateItemFrom(*what, *measured.feature);
  return item ? QString() : QString::fromStdString(item.error().message);
}

Status TemplateController::drop(const QString& name) {
  if (const QString why = whyNotDrop(name); !why.isEmpty()) return {ErrorCode::kRefused, why.toStdString()};
  const FeatureId id = m_document.selection().primary;
  auto item = templateItemFrom(*found(name.toStdString()), *m_document.measurement(id).feature);
  if (!item) return item.error();
  item->source = id;
  item->id = m_document.nextWorldId();
  m_history.seal();
  m_history.push(addWorldItem(std::move(*item)));
  return {};
}

Status TemplateController::setParameter(WorldItemId id, const std::string& parameter, double value) {
  const WorldItem* item = m_document.worldItem(id);
  const auto* what = item != nullptr ? templateOf(*item) : nullptr;
  if (what == nullptr) return {ErrorCode::kNotFound, "That body is of no template that is known here."};
  const auto changed = withParameters(*what, *item, {{parameter, value}});
  return changed ? m_world.edit(*changed) : Status(changed.error());
}

std::vector<TemplateActionRow> TemplateController::actions(WorldItemId id) const {
  const WorldItem* item = m_document.worldItem(id);
  const auto* what = item != nullptr ? templateOf(*item) : nullptr;
  const auto made = what != nullptr ? what->instance(item->parameters)
                                    : Result<planning::TemplateInstance>(ErrorCode::kNotFound, "");
  std::vector<TemplateActionRow> rows;
  if (!made) return rows;
  QString why;
  if (m_run) why = tr("Another action is under way: end it first.");
  else if (!m_hands.joints || !m_hands.joints()) why = tr("The robot's joints are not known yet.");
  for (const auto& action : made->actions) {
    rows.push_back({QString::fromStdString(action.name), QString::fromStdString(action.title),
                    QString::fromStdString(action.description), why});
  }
  return rows;
}

std::optional<TemplateAction> TemplateController::actionOf(const Run& run) const {
  const WorldItem* item = m_document.worldItem(run.item);
  const auto* what = item != nullptr ? templateOf(*item) : nullptr;
  const auto made = what != nullptr ? what->instance(item->parameters)
                                    : Result<planning::TemplateInstance>(ErrorCode::kNotFound, "");
  if (!made) return {};
  for (const auto& action : made->actions) {
    if (action.name == run.action && run.step < action.steps.size()) return action;
  }
  return {};
}

std::optional<double> TemplateController::finger() const {
  const auto& workcell = m_document.workcell();
  const auto joints = m_hands.joints ? m_hands.joints() : nullptr;
  if (!workcell || !workcell->gripper || !joints) return {};
  const auto position = joints->position(workcell->gripper->joint);
  return position ? std::optional<double>(*position) : std::nullopt;
}

bool TemplateController::handAt(const WorldItem& item, const std::string& name) const {
  const auto* what = templateOf(item);
  const auto joints = m_hands.joints ? m_hands.joints() : nullptr;
  if (what == nullptr || !joints) return false;
  const auto feature = featureOf(*what, item, name);
  const auto& cell = *m_document.workcell();
  const auto tip = cell.model->linkIndex(cell.arm.tip_link);
  if (!feature || !tip) return false;
  Eigen::VectorXd q = cell.model->neutral();
  cell.model->assign(*joints, q);
  const Eigen::Vector3d p = cell.model->forward(q, *tip).translation();
  return (nearestOn(*feature, p) - p).norm() < kAtHand_m;
}

// After the last step that is done already.
std::size_t TemplateController::firstStep(const WorldItem& item, const TemplateAction& action) const {
  const auto finger = this->finger();
  const auto& gripper = m_document.workcell()->gripper;
  const bool open = finger && std::abs(*finger - gripper->open) < kFingerThere;
  for (std::size_t i = action.steps.size() - 1; i-- > 0;) {
    const TemplateStep& step = action.steps[i];
    bool done = false;
    if (step.kind == Kind::kOpenGripper) done = open;
    if (step.kind == Kind::kMacro) done = open && handAt(item, step.feature);
    if (step.kind == Kind::kCloseGripper && i == 0) done = finger && std::abs(*finger - gripper->closed) < kFingerThere;
    if (step.kind == Kind::kCloseGripper && i > 0) {
      done = m_hands.holding && m_hands.holding() && handAt(item, action.steps[i - 1].feature);
    }
    if (done) return i + 1;
  }
  return 0;
}

Status TemplateController::begin(WorldItemId id, const QString& name) {
  for (const auto& row : actions(id)) {
    if (row.name != name) continue;
    if (!row.why_not.isEmpty()) return {ErrorCode::kRefused, row.why_not.toStdString()};
    Run run;
    run.item = id;
    run.action = name.toStdString();
    const auto action = actionOf(run);
    run.step = firstStep(*m_document.worldItem(id), *action);
    m_run = run;
    const Status started = startStep();
    if (!started) m_run.reset();
    Q_EMIT changed();
    return started;
  }
  return {ErrorCode::kNotFound, "That body has no action \"" + name.toStdString() + "\"."};
}

Status TemplateController::startStep() {
  const auto action = actionOf(*m_run);
  if (!action) return {ErrorCode::kNotFound, "The template's body is gone."};
  const TemplateStep& step = action->steps[m_run->step];
  return step.kind == Kind::kMacro ? startMotion(step) : startGripper(step);
}

Status TemplateController::startMotion(const TemplateStep& step) {
  const WorldItem& item = *m_document.worldItem(m_run->item);
  const auto feature = featureOf(*templateOf(item), item, step.feature);
  if (!feature) return feature.error();
  m_run->phase = Phase::kPlanning;
  tell(tr("%1: planning.").arg(placeOf(m_run->step, *actionOf(*m_run))));
  return m_plans.planGiven(QString::fromStdString(step.macro),
                           {*feature, step.arguments, step.through ? item.id : WorldItemId{}});
}

Status TemplateController::startGripper(const TemplateStep& step) {
  const auto& gripper = m_document.workcell()->gripper;
  if (!gripper || !m_hands.move_gripper) return {ErrorCode::kNotFound, "This robot has no gripper."};
  const bool open = step.kind == Kind::kOpenGripper;
  m_run->phase = Phase::kGripper;
  const double wanted = open ? gripper->open : gripper->closed;
  m_run->gripper = GripperWatch(wanted, !open && m_run->step > 0, finger().value_or(0), SteadyClock().now_s());   // the first only shuts
  tell((open ? tr("%1: opening the gripper.") : tr("%1: closing the gripper.")).arg(placeOf(m_run->step, *actionOf(*m_run))));
  return m_hands.move_gripper(wanted);
}

void TemplateController::refresh(bool moving, bool stopped, bool played_to_the_end) {
  if (!m_run) return;
  const auto action = actionOf(*m_run);
  if (!action) return end(tr("The template's body is gone: its action ends."));
  if (stopped) return end(tr("STOP ended the action."));
  const TemplateStep& step = action->steps[m_run->step];
  if (m_run->phase == Phase::kGripper) watchGripper(step);
  else watchMotion(moving, played_to_the_end);
}

void TemplateController::watchGripper(const TemplateStep& step) {
  const auto here = finger();
  if (!here) return end(tr("The gripper does not say where it is."));
  const bool open = step.kind == Kind::kOpenGripper;
  const bool holding = !open && m_hands.holding && m_hands.holding();
  const auto outcome = m_run->gripper.look(*here, holding, SteadyClock().now_s());
  if (outcome == GripperWatch::Outcome::kDone || (holding && m_run->step == 0)) return finishStep();
  if (outcome == GripperWatch::Outcome::kMoving) return;
  end(open ? tr("The gripper does not open.") : tr("The gripper closed on nothing. Open it, look at the mark, and begin again."));
}

void TemplateController::watchMotion(bool moving, bool played_to_the_end) {
  if (m_run->phase == Phase::kPlanning) {
    if (m_plans.state() == PlanController::State::kIdle) end(tr("Planning was cancelled: the action ends."));
    return;
  }
  const auto& plan = m_document.plan();
  const auto action = actionOf(*m_run);
  if (plan && plan->id != m_run->plan && isCorrectionOf(action->steps[m_run->step], *plan)) m_run->plan = plan->id;
  if (!plan || plan->id != m_run->plan) return end(tr("Its plan was put away: the action ends."));
  if (moving) m_run->phase = Phase::kPlaying;
  if (m_run->phase == Phase::kPlaying && !moving && played_to_the_end) finishStep();
}

void TemplateController::finishStep() {
  const auto action = actionOf(*m_run);
  const TemplateStep step = action->steps[m_run->step];
  const WorldItem item = *m_document.worldItem(m_run->item);
  std::map<std::string, double> after;
  for (const auto& [name, by] : step.adds) after[name] = item.parameters.at(name) + by;
  if (!after.empty()) {
    const auto moved = withParameters(*templateOf(item), item, after);
    if (const Status edited = moved ? m_world.edit(*moved) : Status(moved.error()); !edited) {
      return end(QString::fromStdString(edited.error().message));
    }
    m_plans.acceptWorld();
  }
  if (++m_run->step >= action->steps.size()) return end(tr("%1: done.").arg(QString::fromStdString(action->title)));
  if (const Status started = startStep(); !started) end(QString::fromStdString(started.error().message));
}

void TemplateController::cancel() {
  if (m_run) end(tr("The action was ended."));
}

void TemplateController::end(const QString& sentence) {
  m_run.reset();
  m_progress.clear();
  if (!sentence.isEmpty()) Q_EMIT failed(sentence);
  Q_EMIT changed();
}

void TemplateController::tell(const QString& what) {
  m_progress = what;
  Q_EMIT changed();
}

}  // namespace longarm::session
