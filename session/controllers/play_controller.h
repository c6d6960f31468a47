#pragma once

/// @file
/// PlayController: from a plan on the table to a motion of the arm, by the operator's Play and by nothing else.

#include <optional>
#include <vector>

#include <QObject>
#include <QString>

#include "planning/macros/correction.h"
#include "session/controllers/plan_controller.h"
#include "session/robot/grip_sequence.h"
#include "session/robot/gripper_watch.h"
#include "session/robot/robot_runtime.h"

namespace longarm::session {

/// What the transport shows; a value.
struct PlayState {
  bool has_plan = false;                   ///< A plan that worked is on the table.
  bool loaded = false;                     ///< The robot holds it; before that everything is preview.
  bool playing = false;                    ///< The arm moves along it, slows down on it, or waits on it for the gripper.
  bool can_play = false, can_back_up = false;
  bool can_scrub = false;
  bool only_held = false;                  ///< Hold to run: the motion pauses when keepRunning() ends.
  bool halted = false;                     ///< A stop or fault ended the motion on its path.
  QString halt_reason;                     ///< Why, where something else than the operator did.
  QString gripper;                         ///< What the gripper does between two stages now; empty: nothing.
  bool correcting = false;                 ///< A correction is planned or carried out.
  bool ask = false;                        ///< The feature is not known as well as the motion needs it: accept it first.
  bool stale = false;                      ///< The robot or the feature is not where the plan was made for: plan again.
  QString why_not_play, why_not_back_up, why_not_correct;   ///< Sentences; empty when it can.
  QString why_not_stage, why_not_stage_back;
  double cursor_s = 0, duration_s = 0;
  double speed = 1, rate = 0;
};

/// GUI thread only.  A plan is only shown until play(): that loads it, which is refused when the robot does not stand
/// at its start, and then moves.  A new plan, or none, unloads the old one as soon as the arm stands.
///
/// Where the gripper has to do something between two stages the arm comes to rest, the gripper is commanded and waited for, and
/// then the motion goes on if it was going on: pause(), STOP, and letting go of a button that must be held end that.  There is no
/// backing up beyond such a place.
class PlayController final : public QObject {
  Q_OBJECT

 public:
  /// Borrowed; outlive this.
  PlayController(Document& document, PlanController& plans, JobRunner& jobs, QObject* parent = nullptr);
  ~PlayController() override;

  void setRuntime(RobotRuntime* runtime);              ///< Borrowed; null: no robot.
  const PlayState& state() const { return m_state; }
  /// Takes in what the runtime says now; call it with every poll.
  void refresh(const RuntimeStatus& status);

  /// The operator goes on with the plan on the table although its feature is known less well than it should be.
  void acceptAccuracy();
  void play();                                         ///< Forwards at |speed|.
  void backUp();                                       ///< Backwards at |speed|.
  /// As play() and backUp(), to the next border between two stages; the arm rests there.
  void playStage();
  void backUpStage();
  /// Hold to run, from the next order on: nothing runs longer than 250 ms after the last keepRunning().
  void setOnlyHeld(bool on);
  bool onlyHeld() const { return m_only_held; }
  void keepRunning();
  void pause();
  void setSpeed(double factor);                        ///< -2 ... 2; takes effect in motion.
  void scrub(double t_s);                              ///< Moves the shown cursor, never the robot.
  /// Moves the tool off the path of the loaded motion by a little, checked for collisions; a moving arm pauses for it
  /// and goes on afterwards, along a way that leads back onto the path.  What was done, corrections too, is backed up
  /// over as it was.  Several wait for one another.
  void nudge(const planning::Nudge& nudge);

 Q_SIGNALS:
  void changed();                                      ///< state() differs.
  void failed(const QString& sentence);

 private:
  const planning::Plan* plan() const;                  ///< Null unless one that worked is on the table.
  Status load();
  QString whyNotCorrect() const;
  void correctNext();
  void takeCorrection(Result<planning::CorrectedPlan> corrected);
  void finishCorrection();
  void dropCorrections();
  void move(double direction, std::optional<double> until_s = {});
  void go(std::optional<double> until_s);
  Status confine(std::optional<double> high_s = {});
  void beginGripper();
  void watchGripper();
  void endGripper(const QString& sentence);
  QString beyondGrip() const;
  std::optional<double> nextBorder(double direction) const;
  void forgetOtherPlan();
  QString whyNotMove() const;
  void rebuild();
  void checkPlan(PlayState& next) const;

  Document& m_document;
  PlanController& m_plans;
  JobRunner& m_jobs;
  RobotRuntime* m_runtime = nullptr;
  RuntimeStatus m_status;
  QString m_off_path;                                  // Why the loaded plan cannot go on from here; empty: it can.
  PlanId m_accepted;                                   // The plan whose accuracy the operator accepted.
  PlanId m_loaded;                                     // The plan the runtime holds; invalid: none of ours.
  double m_cursor = 0, m_speed = 1;
  bool m_only_held = false;
  PlayState m_state;
  std::vector<planning::Nudge> m_nudges;               // To be done one after another.
  bool m_planning_correction = false;                  // A job is at it.
  bool m_resume = false;                               // The arm was moving when the first of them came.
  GripSequence m_grips;                                // Of the plan that the runtime holds.
  std::optional<GripperWatch> m_gripper;               // What the arm waits for.
  bool m_go_on = false;                                // The motion goes on by itself after the gripper's next step ...
  std::optional<double> m_go_until;                    // ... as far as here.
  double m_kept_s = 0;                                 // When keepRunning() was last called, on the runtime's clock.
  std::optional<planning::CorrectedPlan> m_correction; // On the way to its corrected pose.
  int m_observer = 0;
};

}  // namespace longarm::session
