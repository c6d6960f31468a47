#include "session/controllers/plan_controller.h"

#include <cmath>
#include <mutex>
#include <utility>

#include "core/text.h"
#include "planning/macros/accuracy.h"
#include "planning/macros/macro_arguments.h"
#include "planning/macros/standing_defaults.h"
#include "session/document/standing_items.h"

namespace longarm::session {

/// Newest progress, written by the planner's thread and polled by the GUI's.
struct PlanController::Progress {
  std::mutex mutex;
  double fraction = 0;
  std::string text;
};

namespace {

const std::string& rootFrame(const planning::Workcell& workcell) {
  return workcell.model->links()[static_cast<std::size_t>(workcell.model->rootLink())].name;
}

// The parameters with the defaults that hold where the robot stands; those that depend on nothing without joints.
std::vector<planning::MacroParameter> parametersNow(const planning::Macro& macro, const planning::Workcell& workcell, const JointState* joints) {
  std::vector<planning::MacroParameter> parameters = macro.info().parameters;
  const auto* standing = dynamic_cast<const planning::StandingDefaults*>(&macro);
  if (standing == nullptr || joints == nullptr) return parameters;
  Eigen::VectorXd q = workcell.model->neutral();
  workcell.model->assign(*joints, q);
  const auto now = standing->defaultsAt(workcell, q);
  for (auto& parameter : parameters) {
    const auto found = now.find(parameter.name);
    if (found != now.end()) parameter.value = found->second;
  }
  return parameters;
}

// "Now: x 0.512 m, ..., yaw 90.0 deg."
QString standsAt(const std::vector<planning::MacroParameter>& parameters) {
  QStringList out;
  for (const auto& p : parameters) {
    const bool turn = p.unit == "rad";
    out << PlanController::tr("%1 %2 %3").arg(QString::fromStdString(p.name), QString::number(turn ? p.value * 180 / M_PI : p.value, 'f', turn ? 1 : 3),
                                              turn ? QStringLiteral("deg") : QString::fromStdString(p.unit));
  }
  return PlanController::tr("Now: %1.").arg(out.join(QStringLiteral(", ")));
}

}  // namespace

PlanController::PlanController(Document& document, JobRunner& jobs, QObject* parent)
    : QObject(parent), m_document(document), m_jobs(jobs) {
  m_timer.setInterval(50);
  connect(&m_timer, &QTimer::timeout, this, &PlanController::pollProgress);
  m_observer = m_document.observe([this](const Change& change) {
    if (change.kind == ChangeKind::kPlanChanged || change.kind == ChangeKind::kPaneChanged) return;
    if (change.kind == ChangeKind::kWorkcellChanged) rebuildMacros();
    Q_EMIT macrosChanged();
  });
  rebuildMacros();
}

PlanController::~PlanController() {
  m_document.unobserve(m_observer);
  m_cancel.cancel();
}

void PlanController::rebuildMacros() {
  cancel();
  m_macros.reset();
  if (!m_document.workcell()) return;
  MacroList all = planning::makeMacros(*m_document.workcell());
  for (const auto& motion : m_recorded) {
    if (planning::findMacro(all, planning::macroName(motion)) == nullptr)
      all.push_back(planning::makeRecordedMotion(motion));
  }
  m_macros = std::make_shared<const MacroList>(std::move(all));
}

void PlanController::setRecorded(std::vector<planning::RecordedMotion> motions) {
  m_recorded = std::move(motions);
  rebuildMacros();
  Q_EMIT macrosChanged();
}

QString PlanController::whyNot(const planning::MacroInfo& info) const {
  const auto workcell = m_document.workcell();
  const FeatureId selected = m_document.selection().primary;
  if (!info.takes && selected.valid()) return tr("Canned motions are there when nothing is selected: press Esc first.");
  if (info.takes) {
    const QString kind = QString::fromLatin1(vision::toString(*info.takes));
    const SketchItem* item = m_document.item(selected);
    if (item == nullptr) return tr("Select a %1 first.").arg(kind);
    if (item->kind != *info.takes) {
      return tr("Takes a %1; a %2 is selected.").arg(kind, QString::fromLatin1(vision::toString(item->kind)));
    }
    const Measurement& measured = m_document.measurement(selected);
    if (!measured.feature) return QString::fromStdString(measured.reason);
    if (measured.stale)
      return tr("'%1' is stale: the base was driven since its pictures were taken. Re-register it, or mark "
                "it in new pictures.")
          .arg(QString::fromStdString(item->name));
    const std::string& root = rootFrame(*workcell);
    if (measured.feature->parent != root) {
      return tr("'%1' is measured in frame %2, the robot stands in %3. Measure it in pictures of the robot's cameras.")
          .arg(QString::fromStdString(item->name), QString::fromStdString(measured.feature->parent),
               QString::fromStdString(root));
    }
  }
  if (!m_joints || !m_joints()) return tr("The robot's joints are not known yet.");
  return {};
}

std::vector<MacroRow> PlanController::macros() const {
  std::vector<MacroRow> rows;
  if (!m_macros) return rows;
  const auto joints = m_joints ? m_joints() : nullptr;
  for (const auto& macro : *m_macros) {
    const planning::MacroInfo info = macro->info();
    MacroRow row;
    row.name = QString::fromStdString(info.name);
    row.title = QString::fromStdString(info.title);
    row.description = QString::fromStdString(info.description);
    row.takes = info.takes;
    row.reason = whyNot(info);
    row.enabled = row.reason.isEmpty();
    row.parameters = parametersNow(*macro, *m_document.workcell(), joints.get());
    if (joints && dynamic_cast<const planning::StandingDefaults*>(macro.get()) != nullptr) row.advice = standsAt(row.parameters);
    if (info.uses_up && !(m_up && m_up())) {
      row.advice = tr("Above means along the base's own z: the robot does not tell which way is up (imu in its workcell file).");
    }
    judge(info, row);
    rows.push_back(std::move(row));
  }
  return rows;
}

void PlanController::judge(const planning::MacroInfo& info, MacroRow& row) const {
  row.accuracy_need_m = info.accuracy_need;
  const vision::Feature* feature = m_document.selectedFeature();
  if (!info.takes || feature == nullptr || feature->kind != *info.takes) return;
  const auto verdict = planning::judgeAccuracy(planning::uncertaintyOf(*feature), info.accuracy_need);
  row.go = QString::fromStdString(verdict.go);
  row.accuracy = QString::fromStdString(verdict.note);
}

const planning::Macro* PlanController::macro(const QString& name) const {
  return m_macros ? planning::findMacro(*m_macros, name.toStdString()) : nullptr;
}

void PlanController::setSettings(MacroSettings settings) {
  m_settings = std::move(settings);
  Q_EMIT argumentsChanged({});
}

std::map<std::string, double> PlanController::arguments(const QString& name) const {
  std::map<std::string, double> values;
  const planning::Macro* found = macro(name);
  if (found == nullptr) return values;
  const planning::MacroInfo info = found->info();
  const auto joints = m_joints ? m_joints() : nullptr;
  for (const auto& parameter : parametersNow(*found, *m_document.workcell(), joints.get())) values[parameter.name] = parameter.value;
  const auto set = m_settings.find(info.name);
  if (set == m_settings.end()) return values;
  for (const auto& [parameter, value] : set->second) {
    if (planning::MacroArguments::from(info, {{parameter, value}})) values[parameter] = value;
  }
  return values;
}

Status PlanController::setArgument(const QString& name, const QString& parameter, double value) {
  const planning::Macro* found = macro(name);
  if (found == nullptr) return {ErrorCode::kNotFound, "There is no macro \"" + name.toStdString() + "\"."};
  const auto good = planning::MacroArguments::from(found->info(), {{parameter.toStdString(), value}});
  if (!good) return good.error();
  m_settings[name.toStdString()][parameter.toStdString()] = value;
  Q_EMIT argumentsChanged(name);
  return {};
}

void PlanController::resetArguments(const QString& name) {
  if (m_settings.erase(name.toStdString()) > 0) Q_EMIT argumentsChanged(name);
}

Status PlanController::plan(const QString& name) { return plan(name, {}); }

Status PlanController::plan(const QString& name, std::vector<Eigen::VectorXd> avoid) {
  const planning::Macro* macro = this->macro(name);
  if (macro == nullptr) {
    return {ErrorCode::kNotFound, m_macros ? "There is no macro \"" + name.toStdString() + "\"."
                                           : std::string("No workcell is loaded: there is nothing to plan for.")};
  }
  const planning::MacroInfo info = macro->info();
  if (const QString reason = whyNot(info); !reason.isEmpty()) return {ErrorCode::kRefused, reason.toStdString()};
  cancel();
  start(*macro, info, std::move(avoid));
  return {};
}

// The feature that the macro acts on: its own body is no obstacle.
FeatureId PlanController::targetOf(const QString& name) const {
  const planning::Macro* found = macro(name);
  return found != nullptr && found->info().takes ? m_document.selection().primary : FeatureId{};
}

std::optional<planning::PlanContext> PlanController::contextOf(const QString& name) const {
  auto context = contextWithout(targetOf(name));
  if (context) context->arguments = arguments(name);
  return context;
}

std::optional<planning::PlanContext> PlanController::contextWithout(FeatureId target) const {
  const auto workcell = m_document.workcell();
  const auto joints = m_joints ? m_joints() : nullptr;
  if (!workcell || !joints) return std::nullopt;
  planning::PlanContext context;
  context.workcell = workcell.get();
  context.start = workcell->model->neutral();
  workcell->model->assign(*joints, context.start);
  if (m_held == nullptr) {
    context.objects = obstaclesOf(standingItems(m_document), rootFrame(*workcell), target);
  } else {
    context.objects = m_held->obstacles(target);
  }
  if (m_held != nullptr && m_held->held()) {
    context.objects.push_back(m_held->held()->at(*workcell, context.start));
    context.held = {m_held->held()->body.name};
  }
  if (m_up) context.up = m_up();
  context.seed = m_seed;
  context.budget_s = m_budget_s;
  return context;
}

void PlanController::start(const planning::Macro& macro, const planning::MacroInfo& info, std::vector<Eigen::VectorXd> avoid) {
  planning::PlanContext context = *contextOf(QString::fromStdString(info.name));
  context.avoid = avoid;
  Request request{++m_generation, info.name, targetOf(QString::fromStdString(info.name)), {}, std::move(avoid), m_document.world(), {}, {}, {}};
  if (info.takes) request.feature = *m_document.selectedFeature();
  run(macro, std::move(context), std::move(request));
}

Status PlanController::planGiven(const QString& name, GivenFeature given) {
  const planning::Macro* macro = this->macro(name);
  if (macro == nullptr) return {ErrorCode::kNotFound, "There is no macro \"" + name.toStdString() + "\" for this robot."};
  const planning::MacroInfo info = macro->info();
  if (info.takes != given.feature.kind) {
    return {ErrorCode::kInvalidInput, "Macro " + info.name + " does not take a " + vision::toString(given.feature.kind) + "."};
  }
  if (const auto good = planning::MacroArguments::from(info, given.arguments); !good) return good.error();
  auto context = contextWithout({});
  if (!context) return {ErrorCode::kRefused, "The robot's joints are not known yet."};
  const std::string& root = rootFrame(*m_document.workcell());
  if (given.feature.parent != root) {
    return {ErrorCode::kRefused, "'" + given.feature.name + "' stands in frame " + given.feature.parent + ", the robot in " + root + "."};
  }
  cancel();
  context->arguments = given.arguments;
  if (given.carried.valid()) {
    context->objects = obstaclesOf(standingItems(m_document), root, {}, given.carried);
    context->held.clear();
  }
  Request request{++m_generation, info.name, {}, given.feature, {}, m_document.world(), std::move(given), {}, {}};
  run(*macro, std::move(*context), std::move(request));
  return {};
}

void PlanController::acceptWorld() {
  if (m_planned) m_planned->world = m_document.world();
}

void PlanController::run(const planning::Macro& macro, planning::PlanContext context, Request request) {
  const auto workcell = m_document.workcell();
  m_cancel = CancelToken();
  context.cancel = m_cancel;
  m_live = std::make_shared<Progress>();
  context.progress = [live = m_live](double fraction, const std::string& text) {
    const std::lock_guard<std::mutex> lock(live->mutex);
    live->fraction = fraction;
    live->text = text;
  };
  request.base = m_document.base();
  request.workcell = workcell;
  m_progress = 0;
  m_progress_text.clear();
  m_planning = QString::fromStdString(request.macro);
  setState(State::kPlanning);
  m_timer.start();
  // The job keeps workcell and macros alive: a new workcell may be loaded meanwhile.
  m_jobs.run<planning::Plan>(
      this,
      [macros = m_macros, workcell, &macro, context, feature = request.feature]() -> Result<planning::Plan> {
        return macro.plan(context, feature ? &*feature : nullptr);
      },
      [this, request](Result<planning::Plan> result) { deliver(request, std::move(result)); });
}

void PlanController::deliver(const Request& request, Result<planning::Plan> result) {
  if (request.generation != m_generation) return;
  m_timer.stop();
  m_planning.clear();
  setState(State::kIdle);
  if (!result) {
    Q_EMIT failed(QString::fromStdString(result.error().message));
    return;
  }
  // All ways were shown: the first one again.
  if (!result->ok() && result->status == planning::PlanStatus::kNoPath && !request.avoid.empty()) {
    if (const Status again = replan(); !again) Q_EMIT failed(QString::fromStdString(again.error().message));
    return;
  }
  m_planned = request;
  PlanRecord record;
  record.macro = request.macro;
  record.feature = request.item;
  record.plan = std::move(*result);
  const bool ok = record.plan.ok();
  const QString reason = QString::fromStdString(record.plan.reason);
  m_document.setPlan(std::move(record));
  Q_EMIT planned(ok);
  if (!ok) Q_EMIT failed(reason);
}

void PlanController::cancel() {
  m_cancel.cancel();
  ++m_generation;
  m_timer.stop();
  m_planning.clear();
  setState(State::kIdle);
}

Status PlanController::replan() {
  if (!m_document.plan()) return {ErrorCode::kRefused, "There is no plan to plan again. Choose a macro."};
  if (m_planned && m_planned->given) return planGiven(QString::fromStdString(m_document.plan()->macro), *m_planned->given);
  if (const Status selected = selectPlanned(); !selected) return selected;
  return plan(QString::fromStdString(m_document.plan()->macro));
}

QString PlanController::whyNotOtherWay() const {
  if (!m_document.plan() || !m_document.plan()->plan.ok() || !m_planned) return tr("There is no plan.");
  if (m_planned->given) return tr("The step of a template has one way: end its action and use the macro itself.");
  if (m_document.plan()->plan.entry.size() == 0) return tr("This motion begins where the arm stands: there is one way.");
  return {};
}

Status PlanController::planOtherWay() {
  if (const QString why = whyNotOtherWay(); !why.isEmpty()) return {ErrorCode::kRefused, why.toStdString()};
  std::vector<Eigen::VectorXd> avoid = m_planned->avoid;
  avoid.push_back(m_document.plan()->plan.entry);
  if (const Status selected = selectPlanned(); !selected) return selected;
  return plan(QString::fromStdString(m_document.plan()->macro), std::move(avoid));
}

// What the plan was made for.
Status PlanController::selectPlanned() {
  const PlanRecord& record = *m_document.plan();
  if (record.feature.valid()) {
    if (m_document.item(record.feature) == nullptr) {
      return {ErrorCode::kRefused, "The feature of the plan was deleted. Undo, or choose a macro for another one."};
    }
    m_document.select(Selection::of(record.feature));
  } else {
    m_document.select({});
  }
  return {};
}

void PlanController::discard() {
  m_planned.reset();
  m_document.clearPlan();
}

Status PlanController::checkFeature() const {
  if (!m_planned || !m_planned->feature || m_planned->given) return {};
  const FeatureId id = m_planned->item;
  const SketchItem* item = m_document.item(id);
  if (item == nullptr) return {ErrorCode::kStale, "The feature the plan was made for was deleted. Plan again."};
  const Measurement& now = m_document.measurement(id);
  bool same = now.feature && now.feature->vertices.size() == m_planned->feature->vertices.size();
  for (std::size_t i = 0; same && i < now.feature->vertices.size(); ++i) {
    same = now.feature->vertices[i].xyz == m_planned->feature->vertices[i].xyz;
  }
  if (same) return {};
  return {ErrorCode::kStale, "'" + item->name + "' was moved since the plan was made. Plan again."};
}

Status PlanController::checkPlace() const {
  if (!m_planned) return {};
  const auto& now = m_document.base();
  if (now && m_planned->base && !samePlace(*now, *m_planned->base)) {
    const BaseShift shift = shiftBetween(*now, *m_planned->base);
    return {ErrorCode::kStale, "The base has moved by " + formatFixed(shift.way * 1000, 0) + " mm and " +
                                   formatFixed(shift.turn * 180 / M_PI, 1) +
                                   " deg since the plan was made (10 mm and 0.5 deg are allowed). Plan again."};
  }
  if (m_planned->workcell != m_document.workcell()) {
    return {ErrorCode::kStale,
            "The calibration or the workcell was changed since the plan was made. Plan again."};
  }
  return {};
}

Status PlanController::checkSurroundings() const {
  if (const Status place = checkPlace(); !place) return place;
  if (!m_planned || !m_planned->item.valid() || m_document.item(m_planned->item) == nullptr) return {};
  if (!m_document.measurement(m_planned->item).stale) return {};
  return {ErrorCode::kStale,
          "The feature of the plan is stale: the base was driven since its pictures were taken."};
}

Status PlanController::checkFresh(const JointState& now, double tolerance) const {
  if (!m_document.plan()) return {ErrorCode::kRefused, "There is no plan. Choose a macro."};
  const planning::Plan& plan = m_document.plan()->plan;
  if (!plan.ok()) return {ErrorCode::kRefused, "The plan failed: " + plan.reason};
  if (const Status around = checkSurroundings(); !around) return around;
  if (const Status feature = checkFeature(); !feature) return feature;
  if (m_planned && m_planned->world != m_document.world()) {
    return {ErrorCode::kStale, "The sketched world was changed since the plan was made. Plan again."};
  }
  if (plan.trajectory.empty()) return {ErrorCode::kRefused, "The plan has no motion."};
  const auto& names = plan.trajectory.joint_names;
  const auto measured = now.positionsOf(names);
  if (!measured) return measured.error();
  const Eigen::VectorXd& start = plan.trajectory.points.front().positions;
  for (Eigen::Index i = 0; i < start.size(); ++i) {
    const double difference = std::abs(start(i) - (*measured)(i));
    if (difference <= tolerance) continue;
    return {ErrorCode::kStale, "The robot is not where the plan starts: " + names[static_cast<std::size_t>(i)] + " is " +
                                   formatFixed(difference, 4) + " away, " + formatFixed(tolerance, 4) +
                                   " is allowed. Plan again from here."};
  }
  return {};
}

void PlanController::pollProgress() {
  if (!m_live) return;
  double fraction = 0;
  QString text;
  {
    const std::lock_guard<std::mutex> lock(m_live->mutex);
    fraction = m_live->fraction;
    text = QString::fromStdString(m_live->text);
  }
  if (fraction == m_progress && text == m_progress_text) return;
  m_progress = fraction;
  m_progress_text = text;
  Q_EMIT progressChanged();
}

void PlanController::setState(State state) {
  if (m_state == state) return;
  m_state = state;
  Q_EMIT stateChanged();
}

}  // namespace longarm::session
