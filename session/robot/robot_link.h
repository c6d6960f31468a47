#pragma once

/// @file
/// RobotLink: RobotRuntime for Qt.  Polls at 30 Hz and signals what changed.

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include <QObject>
#include <QString>
#include <QTimer>

#include "session/robot/robot_runtime.h"

namespace longarm::session {

/// GUI thread only.  Also tells the runtime, with every poll, that the window is alive.
class RobotLink : public QObject {
  Q_OBJECT

 public:
  /// Borrows the runtime, which must outlive this.
  explicit RobotLink(RobotRuntime& runtime, QObject* parent = nullptr);
  ~RobotLink() override;                           ///< Waits for a restart that is under way.

  RobotRuntime& runtime() { return m_runtime; }
  /// The status of the last poll.
  const RuntimeStatus& status() const { return m_status; }
  /// RobotRuntime::restart() on a thread of its own; restarted() tells the outcome.  No effect while one runs.
  void restart();

 Q_SIGNALS:
  void polled();                                   ///< Every poll, after the others.
  void linkChanged();                              ///< Link state or the list of faults.
  void playerChanged();                            ///< Player state, cursor, rate, speed or duration.
  void stopChanged();                              ///< STOP latched, confirmed or released.
  void jointStateChanged();
  void frameArrived(const QString& camera);
  void noticed(const QString& text);               ///< A new sentence for the operator.
  void restarted(bool ok, const QString& text);    ///< The end of restart(), with the reason when it failed.

 private:
  void poll();
  void pollFrames();

  RobotRuntime& m_runtime;
  QTimer m_timer;
  RuntimeStatus m_status;
  std::shared_ptr<const JointState> m_joints;
  std::map<std::string, std::uint64_t> m_frames;
  std::thread m_restart;
  bool m_restarting = false;
};

}  // namespace longarm::session
