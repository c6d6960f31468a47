#pragma once

/// @file
/// TemplateController: drops templates onto the sketch and works them step by step with their macros.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <QObject>
#include <QString>

#include "planning/templates/object_template.h"
#include "session/controllers/plan_controller.h"
#include "session/controllers/world_controller.h"
#include "session/robot/gripper_watch.h"

namespace longarm::session {

/// What a template's steps need of the robot.  Every function may be empty: no robot.
struct TemplateHands {
  std::function<std::shared_ptr<const JointState>()> joints;
  std::function<Status(double)> move_gripper;      ///< Joint position [m or rad].
  std::function<bool()> holding;
};

/// An action of a dropped template, as its button shows it.
struct TemplateActionRow {
  QString name, title, description;
  QString why_not;                                 ///< Empty: it can be begun.
};

/// An action is a row of steps: opening and closing the gripper, and motions.  Begun by the operator, it goes on by itself
/// from step to step, but every motion is only planned and shown: Play stays the operator's.  STOP, another plan, or cancel()
/// end it.  Where it begins follows from where the robot is: with the handle in its hand it begins with what comes after.
/// GUI thread only.
class TemplateController final : public QObject {
  Q_OBJECT

 public:
  /// Borrowed; all outlive this.
  TemplateController(Document& document, EditHistory& history, PlanController& plans, WorldController& world,
                     QObject* parent = nullptr);

  void setHands(TemplateHands hands) { m_hands = std::move(hands); }
  /// Reads the built-in templates and those of the workcell anew.  @returns what could not be read.
  std::vector<std::string> reload();
  const std::vector<planning::ObjectTemplate>& templates() const { return m_templates; }
  /// Null where it is not among templates().
  const planning::ObjectTemplate* templateOf(const WorldItem& item) const;

  QString whyNotDrop(const QString& name) const;   ///< Empty: it can be dropped onto what is selected.
  /// One undo step.
  Status drop(const QString& name);
  /// One undo step.  @returns kOutOfLimits: name, value, limits.
  Status setParameter(WorldItemId id, const std::string& parameter, double value);

  std::vector<TemplateActionRow> actions(WorldItemId id) const;
  Status begin(WorldItemId id, const QString& action);
  void cancel();
  bool running() const { return m_run.has_value(); }
  /// "2 of 4: press Play", for people; empty: nothing is under way.
  QString progress() const { return m_progress; }

  /// Called often with the robot's state: a step that is done is followed by the next.
  void refresh(bool moving, bool stopped, bool played_to_the_end);

 Q_SIGNALS:
  void changed();
  void failed(const QString& sentence);

 private:
  enum class Phase { kGripper, kPlanning, kShown, kPlaying };
  struct Run {
    WorldItemId item;
    std::string action;
    std::size_t step = 0;
    Phase phase = Phase::kGripper;
    PlanId plan;
    GripperWatch gripper;
  };

  const planning::ObjectTemplate* found(const std::string& name) const;
  std::optional<planning::TemplateAction> actionOf(const Run& run) const;
  const planning::TemplateStep* stepOf(const planning::TemplateAction& action) const;
  std::size_t firstStep(const WorldItem& item, const planning::TemplateAction& action) const;
  bool handAt(const WorldItem& item, const std::string& feature) const;
  std::optional<double> finger() const;
  Status startStep();
  Status startMotion(const planning::TemplateStep& step);
  Status startGripper(const planning::TemplateStep& step);
  void watchGripper(const planning::TemplateStep& step);
  void watchMotion(bool moving, bool played_to_the_end);
  void finishStep();
  void end(const QString& sentence);
  void tell(const QString& what);

  Document& m_document;
  EditHistory& m_history;
  PlanController& m_plans;
  WorldController& m_world;
  TemplateHands m_hands;
  std::vector<planning::ObjectTemplate> m_templates;
  std::optional<Run> m_run;
  QString m_progress;
};

}  // namespace longarm::session
