#include "session/controllers/reach_controller.h"

#include <algorithm>
#include <utility>

namespace longarm::session {

namespace {

// Contexts of all macros that take this kind; empty while joints or workcell are unknown.
std::vector<std::pair<const planning::Macro*, planning::PlanContext>> lookedAt(const PlanController& plans, const MacroList& macros,
                                                                              vision::FeatureKind kind, double budget_s) {
  std::vector<std::pair<const planning::Macro*, planning::PlanContext>> out;
  for (const auto& macro : macros) {
    const planning::MacroInfo info = macro->info();
    if (info.takes != kind) continue;
    auto context = plans.contextOf(QString::fromStdString(info.name));
    if (!context) return {};
    out.emplace_back(macro.get(), *std::move(context));
  }
  for (auto& [macro, context] : out) context.budget_s = budget_s / static_cast<double>(out.size());
  return out;
}

}  // namespace

ReachController::ReachController(PlanController& plans, JobRunner& jobs, QObject* parent)
    : QObject(parent), m_plans(plans), m_jobs(jobs) {}

ReachController::~ReachController() { m_cancel.cancel(); }

void ReachController::setFeature(std::optional<vision::Feature> feature) {
  m_feature = std::move(feature);
  m_pending = m_feature.has_value();
  if (m_pending) return look();
  m_cancel.cancel();
  if (m_answers.empty()) return;
  m_answers.clear();
  Q_EMIT changed();
}

planning::ReachAnswer ReachController::answer(const QString& macro) const {
  const auto found = m_answers.find(macro.toStdString());
  return found == m_answers.end() ? planning::ReachAnswer() : found->second;
}

void ReachController::look() {
  const auto macros = m_plans.macroList();
  if (m_looking || !m_pending || !macros) return;
  m_pending = false;
  const vision::FeatureKind kind = m_feature->kind;
  auto looks = lookedAt(m_plans, *macros, kind, m_budget_s);
  if (looks.empty()) return;
  m_looking = true;
  m_cancel = CancelToken();
  for (auto& [macro, context] : looks) context.cancel = m_cancel;
  // The job keeps workcell and macros alive: a new workcell may be loaded meanwhile.
  m_jobs.run<Answers>(
      this,
      [macros, workcell = m_plans.workcell(), looks = std::move(looks), feature = *m_feature, before = m_answers]() -> Result<Answers> {
        Answers answers;
        for (const auto& [macro, context] : looks) {
          const std::string name = macro->info().name;
          const auto known = before.find(name);
          answers[name] = macro->reach(context, feature, known == before.end() ? planning::ReachSeed() : known->second.seed);
        }
        return answers;
      },
      [this, kind](Result<Answers> answers) { deliver(kind, std::move(answers)); });
}

void ReachController::deliver(vision::FeatureKind kind, Result<Answers> answers) {
  m_looking = false;
  if (answers && m_feature && m_feature->kind == kind) {
    m_answers = *std::move(answers);
    Q_EMIT changed();
  }
  look();
}

}  // namespace longarm::session
