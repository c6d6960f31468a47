#pragma once

/// @file
/// DriveController: directions that are held are repeated to the base until they are let go of.

#include <functional>
#include <set>

#include <QObject>
#include <QString>
#include <QTimer>

#include "core/base_motion.h"
#include "core/result.h"

namespace longarm::session {

/// A dead man's switch: stops repeating on release(), on any refusal, and when whoever holds it says that the
/// window was left.  Directions held together add up.  GUI thread only.
class DriveController final : public QObject {
  Q_OBJECT

 public:
  enum class Way { kForward, kBack, kLeft, kRight, kTurnLeft, kTurnRight };
  using Send = std::function<Status(const BaseTwist& twist)>;
  using Release = std::function<void()>;

  explicit DriveController(QObject* parent = nullptr);

  /// Where commands go, and what the base may do; empty: no robot.
  void setRobot(Send send, Release release, const BaseLimits& limits);
  void setSpeed(double share);  ///< 0.05 ... 1 of the limits, clamped; takes effect at once.
  double speed() const { return m_speed; }

  void hold(Way way);
  void release(Way way);
  void releaseAll();
  bool held() const { return !m_held.empty(); }
  /// What the held directions come to.
  BaseTwist wanted() const;

 Q_SIGNALS:
  void refused(const QString& sentence);
  void changed();  ///< Held or let go of.

 private:
  void send();

  Send m_send;
  Release m_release;
  BaseLimits m_limits;
  double m_speed = 0.3;
  std::set<Way> m_held;
  QTimer m_timer;
};

}  // namespace longarm::session
