#pragma once

/// @file
/// RobotSession: the robot as the window knows it: starting, there, lost, started again.

#include <memory>

#include <QObject>
#include <QString>

#include "session/controllers/job_runner.h"
#include "session/controllers/runtime_feed.h"
#include "session/robot/robot_link.h"

namespace longarm::ui {

/// Starts the robot off the GUI thread, so that the window stands first, and passes its signals on.  There is always a
/// status(), robot or not.  GUI thread only.
class RobotSession final : public QObject {
  Q_OBJECT

 public:
  explicit RobotSession(session::JobRunner& jobs, QObject* parent = nullptr);
  ~RobotSession() override;

  /// Starts this robot; attached() or linkChanged() with the reason follow.  Call once.
  void start(std::shared_ptr<const planning::Workcell> workcell, const session::RuntimeOptions& options);
  /// Says why there will be no robot, e.g. that its workcell cannot be read.
  void giveUp(const QString& sentence);
  /// Starts the robot anew, also when the first start failed.
  void restart();
  bool busy() const { return m_starting || m_restarting; }

  session::RobotRuntime* runtime() const { return m_runtime.get(); }   ///< Null until attached().
  session::RobotFeed* feed() const { return m_feed.get(); }            ///< Null until attached().
  const session::RuntimeStatus& status() const { return m_status; }
  bool linkUp() const { return m_status.link == session::LinkState::kUp; }
  /// Whether anything but a STOP stands between the operator and a motion.
  bool armed() const { return linkUp() && !m_status.gate.stopped; }
  /// Empty when the robot takes commands; else why not.
  QString whyNotReady() const;
  QString whyNotRestart() const;

  void stop(const char* source, const char* reason);
  void resetStop();
  void setGripper(double position);

 Q_SIGNALS:
  void attached();                                 ///< runtime() and feed() are there.
  void polled();                                   ///< 30 times a second.
  void polledSlowly();                             ///< 10 times a second: ages and other numbers to read.
  void linkChanged();
  void playerChanged();
  void stopChanged();
  void jointStateChanged();
  void frameArrived(const QString& camera);
  void noticed(const QString& text);

 private:
  void attach(std::shared_ptr<session::RobotRuntime> runtime);
  void setStatus(session::LinkState link, const QString& text);

  session::JobRunner& m_jobs;
  std::shared_ptr<const planning::Workcell> m_workcell;
  session::RuntimeOptions m_options;
  session::RuntimeStatus m_status;
  bool m_starting = false, m_restarting = false;
  unsigned m_polls = 0;
  std::shared_ptr<session::RobotRuntime> m_runtime;
  std::unique_ptr<session::RuntimeFeed> m_feed;
  std::unique_ptr<session::RobotLink> m_link;      // Last: it polls the runtime.
};

}  // namespace longarm::ui
