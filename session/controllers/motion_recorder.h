#pragma once

/// @file
/// MotionRecorder: motions of the arm that the operator records, names, edits and keeps.

#include <memory>
#include <optional>
#include <vector>

#include <QObject>
#include <QString>

#include "core/motion.h"
#include "planning/macros/recorded_motion.h"

namespace longarm::session {

/// Way-points are taken while the arm moves, by jogging or playing, and thinned to 0.5 mrad when the
/// recording ends.  Each change is written at once, one file per motion.  GUI thread only.
class MotionRecorder final : public QObject {
  Q_OBJECT

 public:
  explicit MotionRecorder(QObject* parent = nullptr);

  /// Reads what was recorded with an arm of these joints; what cannot be read is told by failed() and left
  /// alone.
  void open(const QString& folder, const std::vector<std::string>& joints);
  const std::vector<planning::RecordedMotion>& motions() const { return m_motions; }
  const planning::RecordedMotion* motion(const QString& name) const;  ///< Null if there is none.

  bool recording() const { return m_recording; }
  int samples() const { return static_cast<int>(m_samples.size()); }
  /// @returns kRefused when no arm is known or a recording is under way.
  Status start();
  /// What the robot says now; call it with every poll.  Ends the recording by itself when it has got too
  /// long.
  void take(const JointState& state);
  /// Ends it.  @returns the name given to it; kRefused when nothing was recorded or the arm has not moved.
  Result<QString> finish();
  void cancel();

  /// @returns kNotFound, kInvalidInput, kRefused: a name that another bears, the last way-point.  Nothing
  /// changes then.
  Status rename(const QString& motion, const QString& name);
  Status remove(const QString& motion);
  Status renameWaypoint(const QString& motion, int index, const QString& name);
  Status removeWaypoint(const QString& motion, int index);
  /// Inserts where the arm is now, before `index` (at the end for the number of way-points).
  Status insertWaypoint(const QString& motion, int index, const JointState& state);

 Q_SIGNALS:
  void changed();  ///< The list, or one of it.
  void recordingChanged();
  void failed(const QString& sentence);

 private:
  Result<Eigen::VectorXd> jointsOf(const JointState& state) const;
  int indexOf(const QString& name) const;
  bool taken(const planning::RecordedMotion& motion, int except) const;
  QString fileOf(const planning::RecordedMotion& motion) const;
  Status replace(int index, planning::RecordedMotion after);

  QString m_folder;
  std::vector<std::string> m_joints;
  std::vector<planning::RecordedMotion> m_motions;
  bool m_recording = false;
  std::vector<Eigen::VectorXd> m_samples;
};

}  // namespace longarm::session
