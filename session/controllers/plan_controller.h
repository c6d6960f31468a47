#pragma once

/// @file
/// PlanController: which macros the selection allows, and planning them without blocking the window.

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <QObject>
#include <QString>
#include <QTimer>

#include "core/cancel.h"
#include "planning/macros/macro.h"
#include "session/controllers/job_runner.h"
#include "session/document/document.h"

namespace longarm::session {

/// One macro as a button shows it.
struct MacroRow {
  QString name, title, description;
  std::optional<vision::FeatureKind> takes;   ///< Empty: a canned motion.
  bool enabled = false;
  QString reason;                          ///< Why it is disabled: what to do; empty when enabled.
};

/// GUI thread only.  A finished plan, good or bad, becomes Document::plan().
class PlanController final : public QObject {
  Q_OBJECT

 public:
  enum class State { kIdle, kPlanning };

  /// Borrowed; outlive this.
  PlanController(Document& document, JobRunner& jobs, QObject* parent = nullptr);
  ~PlanController() override;                          ///< Cancels.

  /// Newest joints of the robot; null while unknown.  Plans start there.
  void setJointSource(std::function<std::shared_ptr<const JointState>()> source) { m_joints = std::move(source); }
  void setSeed(unsigned seed) { m_seed = seed; }
  void setBudget(double seconds) { m_budget_s = seconds; }

  State state() const { return m_state; }
  double progress() const { return m_progress; }
  QString progressText() const { return m_progress_text; }
  QString planning() const { return m_planning; }      ///< Name of the macro being planned; empty: none.

  /// Canned motions when nothing is selected, those for the primary selection's kind otherwise.
  std::vector<MacroRow> macros() const;
  /// Starts planning; what was under way is cancelled and its result dropped.  @returns kRefused with the reason.
  Status plan(const QString& macro);
  void cancel();
  /// Plans the same macro for the same feature from the joints now.
  Status replan();
  void discard();                                      ///< Clears the plan.

  /// Whether the plan may be played from these joints: there is one, it is ok, its feature is as it was, and its
  /// start lies within `tolerance` [rad or m] of them.  The message names the joint, the difference, the limit.
  Status checkFresh(const JointState& now, double tolerance = 0.01) const;

 Q_SIGNALS:
  void macrosChanged();
  void stateChanged();
  void progressChanged();
  void planned(bool ok);                               ///< Document::plan() is new.
  void failed(const QString& sentence);

 private:
  using Macros = std::vector<std::unique_ptr<planning::Macro>>;
  struct Progress;
  /// What a plan was asked for, as it was then.
  struct Request {
    int generation = 0;
    std::string macro;
    FeatureId item;
    std::optional<vision::Feature> feature;
  };

  void rebuildMacros();
  QString whyNot(const planning::MacroInfo& info) const;
  void start(const planning::Macro& macro, const planning::MacroInfo& info);
  void deliver(const Request& request, Result<planning::Plan> result);
  Status checkFeature() const;
  void pollProgress();
  void setState(State state);

  Document& m_document;
  JobRunner& m_jobs;
  std::shared_ptr<Macros> m_macros;
  std::function<std::shared_ptr<const JointState>()> m_joints;
  State m_state = State::kIdle;
  CancelToken m_cancel;
  int m_generation = 0;
  unsigned m_seed = 1;
  double m_budget_s = 5;
  QTimer m_timer;
  std::shared_ptr<Progress> m_live;
  double m_progress = 0;
  QString m_progress_text, m_planning;
  std::optional<Request> m_planned;        // Of the plan in the document.
  int m_observer = 0;
};

}  // namespace longarm::session
