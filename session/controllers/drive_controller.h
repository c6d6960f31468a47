#pragma once

/// @file
/// DriveController: directions that are held are repeated to the base until they are let go of.

#include <functional>
#include <set>

#include "core/base_motion.h"
#include "session/controllers/dead_man_switch.h"

namespace longarm::session {

/// Directions held together add up.  GUI thread only.
class DriveController final : public DeadManSwitch {
  Q_OBJECT

 public:
  enum class Way { kForward, kBack, kLeft, kRight, kTurnLeft, kTurnRight };
  using Send = std::function<Status(const BaseTwist& twist)>;

  explicit DriveController(QObject* parent = nullptr);

  /// Where commands go, and what the base may do; empty: no robot.
  void setRobot(Send send, Release release, const BaseLimits& limits);
  void setSpeed(double share);  ///< 0.05 ... 1 of the limits, clamped; takes effect at once.
  double speed() const { return m_speed; }

  void hold(Way way);
  void release(Way way);
  bool held() const override { return !m_held.empty(); }
  /// What the held directions come to.
  BaseTwist wanted() const;

 private:
  Status send() override;
  void forget() override { m_held.clear(); }

  Send m_send;
  BaseLimits m_limits;
  double m_speed = 0.3;
  std::set<Way> m_held;
};

}  // namespace longarm::session
