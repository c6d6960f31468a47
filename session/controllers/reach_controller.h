#pragma once

/// @file
/// ReachController: what can be reached now, while a feature is dragged and when it rests.

#include <map>
#include <optional>

#include <QObject>
#include <QString>

#include "session/controllers/plan_controller.h"

namespace longarm::session {

/// Looks in the job pool, one look at a time, always at the newest feature: while one look is under way the features in
/// between are skipped.  GUI thread only.
class ReachController final : public QObject {
  Q_OBJECT

 public:
  /// Borrowed; outlive this.
  ReachController(PlanController& plans, JobRunner& jobs, QObject* parent = nullptr);
  ~ReachController() override;

  /// Time for one look at all macros that take the feature.
  void setBudget(double seconds) { m_budget_s = seconds; }
  /// What to look at; nothing: nothing, and all answers are forgotten.
  void setFeature(std::optional<vision::Feature> feature);
  /// kUnknown for macros that were not looked at.
  planning::ReachAnswer answer(const QString& macro) const;

 Q_SIGNALS:
  void changed();

 private:
  using Answers = std::map<std::string, planning::ReachAnswer>;
  void look();
  void deliver(vision::FeatureKind kind, Result<Answers> answers);

  PlanController& m_plans;
  JobRunner& m_jobs;
  CancelToken m_cancel;
  double m_budget_s = 0.04;
  bool m_looking = false;
  std::optional<vision::Feature> m_feature;            // The newest.
  bool m_pending = false;                              // It was not looked at yet.
  Answers m_answers;
};

}  // namespace longarm::session
