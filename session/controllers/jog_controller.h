#pragma once

/// @file
/// JogController: a direction that is held is repeated to the robot until it is let go of.

#include <functional>
#include <optional>

#include <QString>

#include "planning/jog/jog_command.h"
#include "session/controllers/dead_man_switch.h"

namespace longarm::session {

/// GUI thread only.
class JogController final : public DeadManSwitch {
  Q_OBJECT

 public:
  using Send = std::function<Status(const planning::JogCommand& command)>;
  explicit JogController(QObject* parent = nullptr);

  /// Where commands go; empty: no robot.
  void setRobot(Send send, Release release);
  void setFrame(planning::JogFrame frame, const QString& camera = {});
  planning::JogFrame frame() const { return m_frame; }
  void setSpeed(double share);                         ///< 0.02 ... 1, clamped; takes effect at once.
  double speed() const { return m_speed; }
  void setThroughContact(bool on) { m_through_contact = on; }

  /// @param axis 0 ... 2 along x, y, z of the frame, 3 ... 5 about them; kJoint: the joint's index.
  /// @param way +1 or -1.
  void hold(int axis, int way);
  bool held() const override { return m_held.has_value(); }

 private:
  Status send() override;
  void forget() override { m_held.reset(); }
  planning::JogCommand commandOf(int axis, int way) const;

  Send m_send;
  planning::JogFrame m_frame = planning::JogFrame::kBase;
  QString m_camera;
  double m_speed = 0.3;
  bool m_through_contact = false;
  std::optional<std::pair<int, int>> m_held;           // axis, way
};

}  // namespace longarm::session
