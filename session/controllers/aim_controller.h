#pragma once

/// @file
/// AimController: aims a pan-tilt by stick, keys, or a click in the live picture.

#include <memory>
#include <string>
#include <vector>

#include <QObject>
#include <QString>
#include <QTimer>

#include "planning/world/workcell.h"
#include "session/controllers/aimed_camera.h"
#include "session/controllers/robot_feed.h"
#include "vision/camera/camera_model.h"
#include "vision/snapshot/view.h"

namespace longarm::session {

/// Angles that bring a pixel of a camera to the middle of its picture, from the joints now.
/// @returns kNotFound (no such camera or no pan-tilt aims it), kDegenerate (the pixel has no ray), kOutOfLimits
///   (joint, angle wanted and limit; `clamped`, when given, then holds the nearest angles).  Pure function.
Result<PanTiltAngles> anglesToCentre(const planning::Workcell& workcell, const vision::CameraModel& camera_model,
                                     const std::string& camera, const Eigen::Vector2d& pixel,
                                     const JointState& now, PanTiltAngles* clamped = nullptr);

/// GUI thread only.  Commands are absolute angles within the joints' limits, at most 20 a second.
class AimController final : public QObject {
  Q_OBJECT

 public:
  explicit AimController(QObject* parent = nullptr);

  /// Borrowed; null: nothing to aim.
  void setFeed(RobotFeed* feed) { m_feed = feed; }
  void setWorkcell(std::shared_ptr<const planning::Workcell> workcell);
  /// The pan-tilt that stick and keys move; empty: the workcell's first.
  void setPanTilt(const QString& name);
  QString panTilt() const { return QString::fromStdString(m_pan_tilt); }
  /// Empty when aiming is possible; else why not.
  QString whyNot() const;

  /// Stick deflection, -1 ... 1 each: right and up are positive.  Moves until zero is set.
  void setStick(double right, double up);
  /// One key step: right and up positive [rad].
  void step(double right, double up);
  /// Brings this raw pixel of a live picture to its middle; goes as far as the limits allow and says so.
  void aimAt(const QString& camera, const Eigen::Vector2d& pixel);
  /// Chooses pan, tilt and, where the camera has it, zoom so that what this rectangle of the live picture shows fills the
  /// picture; raw pixels of two opposite corners.  Without a zoom it is brought to the middle.
  void frameRegion(const QString& camera, const Eigen::Vector2d& corner, const Eigen::Vector2d& opposite);
  /// The same for points of the robot's root frame.
  void framePoints(const QString& camera, const std::vector<Eigen::Vector3d>& points_W);
  void setMaxRate(double rate) { m_max_rate = rate; }  ///< At full deflection [rad/s].

 Q_SIGNALS:
  void aimed(const QString& pan_tilt);                 ///< A command went out.
  void failed(const QString& sentence);

 private:
  void tick();
  double fineness() const;
  Result<vision::View> viewNow(const std::string& camera) const;
  Status turnBy(double right, double up);
  Status send(const PanTiltAngles& wanted);
  const planning::CameraSpec* cameraOfPanTilt() const;

  RobotFeed* m_feed = nullptr;
  std::shared_ptr<const planning::Workcell> m_workcell;
  std::string m_pan_tilt;
  QTimer m_timer;
  double m_right = 0, m_up = 0, m_max_rate = 0.6;
  double m_last_tick_s = 0, m_sent_s = 0;
  PanTiltAngles m_target;                  // Last command.
  bool m_has_target = false;
};

}  // namespace longarm::session
