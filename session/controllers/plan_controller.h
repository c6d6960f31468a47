#pragma once

/// @file
/// PlanController: which macros the selection allows, and planning them without blocking the window.

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <QObject>
#include <QString>
#include <QTimer>

#include "core/cancel.h"
#include "planning/macros/macro.h"
#include "planning/macros/recorded_motion.h"
#include "session/controllers/held_controller.h"
#include "session/controllers/job_runner.h"
#include "session/document/document.h"

namespace longarm::session {

/// One macro as a button shows it.
struct MacroRow {
  QString name, title, description;
  std::optional<vision::FeatureKind> takes;   ///< Empty: a canned motion.
  bool enabled = false;
  QString reason;                          ///< Why it is disabled: what to do; empty when enabled.
  double accuracy_need_m = 0;              ///< Of the feature, 95 %; 0: takes none.
  QString go;                              ///< "go", "ask", "no_go" for the selected feature; empty when it is not measured.
  QString accuracy;                        ///< Why it is not "go".
  QString advice;                          ///< Something to know before it is planned; empty: nothing.
  std::vector<planning::MacroParameter> parameters;
};

/// Values of macros' parameters, by macro and parameter, where they differ from the defaults.
using MacroSettings = std::map<std::string, std::map<std::string, double>>;

/// What a template hands to its macro.
struct GivenFeature {
  vision::Feature feature;
  std::map<std::string, double> arguments;
  WorldItemId carried;                     ///< Its moving parts go with the tool; may be invalid.
};
using MacroList = std::vector<std::unique_ptr<planning::Macro>>;

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
  /// Which way is up in the root frame, where the robot tells it.
  void setUpSource(std::function<std::optional<Eigen::Vector3d>()> source) { m_up = std::move(source); }
  /// What is held is planned with; borrowed, null: nothing is known of it.
  void setHeld(const HeldController* held) { m_held = held; }
  void setSeed(unsigned seed) { m_seed = seed; }
  void setBudget(double seconds) { m_budget_s = seconds; }

  /// Motions to list beside the canned ones.
  void setRecorded(std::vector<planning::RecordedMotion> motions);

  /// What the operator has set, for whatever workcell; what does not fit this one's macros is not used.
  const MacroSettings& settings() const { return m_settings; }
  void setSettings(MacroSettings settings);
  /// All parameters of a macro with the values it is planned with; empty for an unknown one.
  std::map<std::string, double> arguments(const QString& macro) const;
  /// @returns kNotFound, kOutOfLimits: nothing changes then.
  Status setArgument(const QString& macro, const QString& parameter, double value);
  void resetArguments(const QString& macro);

  State state() const { return m_state; }
  double progress() const { return m_progress; }
  QString progressText() const { return m_progress_text; }
  QString planning() const { return m_planning; }      ///< Name of the macro being planned; empty: none.

  /// The workcell's macros; null without one.  They refer to nothing but themselves.
  std::shared_ptr<const MacroList> macroList() const { return m_macros; }
  std::shared_ptr<const planning::Workcell> workcell() const { return m_document.workcell(); }
  /// What a macro would be planned with now; nothing while workcell or joints are unknown.  The workcell must be kept.
  std::optional<planning::PlanContext> contextOf(const QString& macro) const;

  /// Canned motions when nothing is selected, those for the primary selection's kind otherwise.
  std::vector<MacroRow> macros() const;
  /// Starts planning; what was under way is cancelled and its result dropped.  @returns kRefused with the reason.
  Status plan(const QString& macro);
  /// Plans a macro for a feature that is not of the sketch, with these arguments and no others, whatever is selected.
  Status planGiven(const QString& macro, GivenFeature given);
  /// The sketched world was changed as the motion of the plan changes the real one: the plan stays fresh.
  void acceptWorld();
  void cancel();
  /// Plans the same macro for the same feature from the joints now.
  Status replan();
  /// Plans the same once more, another way than those shown so far: other joints, another side.  After the last one
  /// the first comes again.
  Status planOtherWay();
  QString whyNotOtherWay() const;                      ///< Empty when there is a plan to find another way than.
  void discard();                                      ///< Clears the plan.

  /// Whether the plan may be played from these joints: there is one, it is ok, its feature, the sketched
  /// world and the calibration are as they were, the base stands where it stood (10 mm, 0.5 deg), and its
  /// start lies within `tolerance` [rad or m] of them.  The message names what changed, by how much, the
  /// limit.
  Status checkFresh(const JointState& now, double tolerance = 0.01) const;
  /// The part of checkFresh() that also holds for a motion under way.
  Status checkSurroundings() const;

 Q_SIGNALS:
  void macrosChanged();
  void stateChanged();
  void progressChanged();
  void planned(bool ok);                               ///< Document::plan() is new.
  void argumentsChanged(const QString& macro);         ///< Empty: of many.
  void failed(const QString& sentence);

 private:
  struct Progress;
  /// What a plan was asked for, as it was then.
  struct Request {
    int generation = 0;
    std::string macro;
    FeatureId item;
    std::optional<vision::Feature> feature;
    std::vector<Eigen::VectorXd> avoid;
    std::vector<WorldItem> world;
    std::optional<GivenFeature> given;     ///< Instead of a feature of the sketch.
    std::optional<BaseState> base;
    std::shared_ptr<const planning::Workcell> workcell;
  };

  void rebuildMacros();
  QString whyNot(const planning::MacroInfo& info) const;
  Status plan(const QString& macro, std::vector<Eigen::VectorXd> avoid);
  FeatureId targetOf(const QString& macro) const;
  void start(const planning::Macro& macro, const planning::MacroInfo& info, std::vector<Eigen::VectorXd> avoid);
  std::optional<planning::PlanContext> contextWithout(FeatureId target) const;
  void run(const planning::Macro& macro, planning::PlanContext context, Request request);
  Status selectPlanned();
  void judge(const planning::MacroInfo& info, MacroRow& row) const;
  const planning::Macro* macro(const QString& name) const;
  void deliver(const Request& request, Result<planning::Plan> result);
  Status checkFeature() const;
  Status checkPlace() const;
  void pollProgress();
  void setState(State state);

  Document& m_document;
  JobRunner& m_jobs;
  std::shared_ptr<const MacroList> m_macros;
  std::vector<planning::RecordedMotion> m_recorded;
  std::function<std::shared_ptr<const JointState>()> m_joints;
  std::function<std::optional<Eigen::Vector3d>()> m_up;
  const HeldController* m_held = nullptr;
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
  MacroSettings m_settings;
  int m_observer = 0;
};

}  // namespace longarm::session
