#pragma once

/// @file
/// Workbench: everything of a session that is not a widget, built in one place and wired together.

#include <array>
#include <memory>

#include <QObject>
#include <QString>

#include "session/calibration/calibration_controller.h"
#include "session/calibration/fixture_controller.h"
#include "session/calibration/health_controller.h"
#include "session/calibration/lens_controller.h"
#include "session/calibration/pose_controller.h"
#include "session/calibration/stereo_controller.h"
#include "session/calibration/zoom_controller.h"
#include "session/controllers/aim_controller.h"
#include "session/controllers/autosave.h"
#include "session/controllers/drive_controller.h"
#include "session/controllers/held_controller.h"
#include "session/controllers/jog_controller.h"
#include "session/controllers/match_controller.h"
#include "session/controllers/motion_recorder.h"
#include "session/controllers/plan_controller.h"
#include "session/controllers/play_controller.h"
#include "session/controllers/play_hand.h"
#include "session/controllers/reach_controller.h"
#include "session/controllers/snapshot_controller.h"
#include "session/controllers/targeting_controller.h"
#include "session/controllers/template_controller.h"
#include "session/controllers/watch_controller.h"
#include "session/controllers/view_adviser.h"
#include "session/controllers/world_controller.h"
#include "session/controllers/zoom_drive.h"
#include "ui/live_pictures.h"
#include "ui/robot_session.h"

namespace longarm::ui {

/// Where the robot comes from.
struct RobotChoice {
  QString workcell;                        ///< File; empty: the built-in robot.
  QString variant;                         ///< Of the built-in robot: empty or "ptz".
  QString scenario = QStringLiteral("grab_pipe");
};

/// Panels get a reference to this and bind the parts they need; they never know each other.  GUI thread only.
class Workbench final : public QObject {
  Q_OBJECT

 public:
  /// @param autosave_folder Empty: the program's own.
  explicit Workbench(const QString& autosave_folder = {}, QObject* parent = nullptr);
  ~Workbench() override;

  session::Document& document() { return m_document; }
  session::EditHistory& history() { return m_history; }
  session::JobRunner& jobs() { return m_jobs; }
  RobotSession& robot() { return m_robot; }
  LivePictures& live() { return m_live; }
  session::TargetingController& targeting() { return m_targeting; }
  session::WorldController& world() { return m_world; }
  session::HeldController& held() { return m_held; }
  session::MatchController& matches() { return m_matches; }
  session::ViewAdviser& adviser() { return m_adviser; }
  session::SnapshotController& snapshots() { return m_snapshots; }
  session::PlanController& plans() { return m_plans; }
  session::PlayController& play() { return m_play; }
  session::PlayHand& hand() { return m_hand; }
  session::ReachController& reach() { return m_reach; }
  session::AimController& aim() { return m_aim; }
  session::ZoomDrive& zoomDrive() { return m_zoom_drive; }
  session::WatchController& watch() { return m_watch; }
  session::TemplateController& templates() { return m_templates; }
  session::JogController& jog() { return m_jog; }
  session::DriveController& drive() { return m_drive; }
  session::MotionRecorder& recorder() { return m_recorder; }
  session::Autosave& autosave() { return m_autosave; }
  session::CalibrationController& calibration() { return m_calibration; }
  session::PoseController& pose() { return m_pose; }
  session::LensController& lens() { return m_lens; }
  session::StereoController& stereo() { return m_stereo; }
  session::FixtureController& fixture() { return m_fixture; }
  session::ZoomController& zoom() { return m_zoom; }
  session::HealthController& health() { return m_health; }

  /// Reads the workcell and starts its robot, both off the GUI thread.
  void openRobot(const RobotChoice& choice);
  void setWorkcell(std::shared_ptr<const planning::Workcell> workcell);

  /// Why no calibration can be put to use now; empty: it can.
  QString whyNotCalibrate() const;

  /// The camera a pane shows when it is live, and that takePair() takes for it; the stereo head's at first.
  QString paneCamera(vision::PaneSide side) const { return m_pane_cameras[static_cast<int>(side)]; }
  void setPaneCamera(vision::PaneSide side, const QString& camera);
  QString whyNotTakePair() const;
  void takePair();

  /// Finds the clearest view of what is marked, says so, and shows it: a picture of the library, or one that is taken now.
  /// @param feature Invalid: the one that is worked on or selected.
  void showClearestView(FeatureId feature = {});

  /// Why the base cannot be driven now; empty: it can.
  QString whyNotDrive() const;
  /// Why no motion can be planned now beyond what the controller knows; empty: it can.
  QString whyNotPlan() const;
  void plan(const QString& macro);
  /// A motion asked for by plan() is played as soon as it is found, where nothing speaks against it and
  /// nothing must be held.  Off at first, and off again whenever a live robot is connected.
  void setAutoPlay(bool on);
  /// Why what is stale cannot be moved by marks made again; empty: it can.
  QString whyNotReregister() const;
  void reregister();
  bool autoPlay() const { return m_auto_play; }
  void replan();
  void planOtherWay();
  /// Corrects the motion under way; the camera is the one of the left pane.  @param way [m]  @param turn [rad]
  void nudge(planning::JogFrame frame, const Eigen::Vector3d& way, const Eigen::Vector3d& turn);
  Status beginTemplate(WorldItemId item, const QString& action);
  /// Turns and zooms the panes' cameras so that the selected features fill their pictures.
  void frameSelection();
  /// A sentence for the operator.
  void say(const QString& sentence);

 Q_SIGNALS:
  void said(const QString& sentence);
  void paneCameraChanged(longarm::vision::PaneSide side);
  void autoPlayChanged();
  void baseRested();                       ///< Elsewhere than before: what stands in the room is elsewhere to the robot.

 private:
  void connectParts();
  void tellObstacles();
  void lookAtGripper();
  void chooseCameras();
  void favourCameras();
  void connectCalibration();
  void useCalibrations();
  void followBase(const BaseState& base);
  QString whyNotTrust(const QString& macro) const;
  void lookAtReach();
  void connectCameras();
  void watchMotion();
  void connectTemplates();
  void playAtOnce(bool planned);

  session::Document m_document;
  session::EditHistory m_history;
  session::JobRunner m_jobs;
  RobotSession m_robot;
  LivePictures m_live;
  session::TargetingController m_targeting;
  session::ViewAdviser m_adviser;
  session::MatchController m_matches;
  session::WorldController m_world;
  session::HeldController m_held;
  session::SnapshotController m_snapshots;
  session::PlanController m_plans;
  session::PlayController m_play;
  session::PlayHand m_hand;
  session::ReachController m_reach;
  session::AimController m_aim;
  session::ZoomDrive m_zoom_drive;
  session::WatchController m_watch;
  session::TemplateController m_templates;
  session::JogController m_jog;
  session::DriveController m_drive;
  session::MotionRecorder m_recorder;
  QString m_motion_folder;
  BaseState m_stands_at;                   // What the document's workcell and the obstacles told are for.
  session::Autosave m_autosave;
  session::CalibrationController m_calibration;
  session::PoseController m_pose;
  session::LensController m_lens;
  session::StereoController m_stereo;
  session::FixtureController m_fixture;
  session::ZoomController m_zoom;
  session::HealthController m_health;
  std::array<QString, 2> m_pane_cameras;
  bool m_auto_play = false, m_play_when_planned = false;
};

}  // namespace longarm::ui
