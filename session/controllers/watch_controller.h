#pragma once

/// @file
/// WatchController: the pan-tilt heads follow tool and target while the arm moves.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <QObject>

#include "planning/world/workcell.h"
#include "session/controllers/aimed_camera.h"
#include "session/controllers/robot_feed.h"
#include "vision/snapshot/view.h"

namespace longarm::session {

/// Every pan-tilt turns its camera, and the zoom where there is one, so that the tool and what it works on stay within the
/// picture; where both do not fit, the tool.  Slowly, and only when they would leave the middle.  A head that the operator
/// aims is left alone for a while.  GUI thread only.
class WatchController final : public QObject {
  Q_OBJECT

 public:
  explicit WatchController(QObject* parent = nullptr);

  /// Borrowed; null: nothing to turn.
  void setFeed(RobotFeed* feed) { m_feed = feed; }
  void setWorkcell(std::shared_ptr<const planning::Workcell> workcell);
  bool on() const { return m_on; }
  void setOn(bool on);
  /// What the tool works on, in the robot's root frame; may be empty.
  void setTarget(std::vector<Eigen::Vector3d> points_W) { m_target = std::move(points_W); }

  /// Called often; turns the heads at most ten times a second while `moving`, and never while `stopped`.
  void refresh(bool moving, bool stopped);
  /// The operator aims this head or zooms a camera on it.
  void giveWay(const QString& pan_tilt);

 Q_SIGNALS:
  void changed();

 private:
  struct Head {
    PanTiltAngles angles;                  // commanded last
    double zoom = 0;
    double commanded_s = -1e9;
    double left_alone_until_s = -1e9;
    bool following = false;
  };
  void watch(const planning::CameraSpec& camera, Head& head, double now_s);
  std::vector<Eigen::Vector3d> toolPoints(const JointState& joints) const;
  void turn(const planning::CameraSpec& camera, Head& head, const PanTiltAngles& wanted, std::optional<double> zoom,
            double now_s);

  RobotFeed* m_feed = nullptr;
  std::shared_ptr<const planning::Workcell> m_workcell;
  bool m_on = true;
  std::vector<Eigen::Vector3d> m_target;
  std::map<std::string, Head> m_heads;     // by pan-tilt
  double m_last_s = -1e9;
};

}  // namespace longarm::session
