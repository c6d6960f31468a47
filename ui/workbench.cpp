#include "ui/workbench.h"

#include <utility>

#include <cmath>

#include <QDir>
#include <QStandardPaths>

#include "planning/world/room.h"
#include "planning/world/scenario.h"
#include "planning/world/workcell.h"
#include "session/document/feature_rows.h"
#include "session/commands/reregistration.h"

namespace longarm::ui {

using vision::PaneSide;

namespace {

// Beside the autosave where that has a place of its own.
QString libraryFolder(const QString& autosave_folder, const QString& name) {
  return autosave_folder.isEmpty() ? QString()
                                   : QDir::cleanPath(autosave_folder + QStringLiteral("/../") + name);
}

// A scenario is for a robot; what the operator names goes first.
Result<planning::Workcell> chosenWorkcell(const RobotChoice& choice) {
  if (!choice.workcell.isEmpty()) return planning::loadWorkcell(choice.workcell.toStdString());
  if (!choice.variant.isEmpty() || choice.scenario.isEmpty()) return planning::loadBuiltInWorkcell(choice.variant.toStdString());
  const auto scenario = planning::loadScenario(choice.scenario.toStdString());
  return scenario ? planning::workcellOf(*scenario) : Result<planning::Workcell>(scenario.error());
}

}  // namespace

Workbench::Workbench(const QString& autosave_folder, QObject* parent)
    : QObject(parent), m_history(m_document), m_robot(m_jobs), m_live(m_robot, m_jobs),
      m_targeting(m_document, m_history), m_adviser(m_document, m_targeting), m_matches(m_targeting, m_jobs),
      m_world(m_document, m_history), m_held(m_document, m_world), m_snapshots(m_document, m_history, m_jobs), m_plans(m_document, m_jobs),
      m_play(m_document, m_plans, m_jobs), m_hand(m_play), m_reach(m_plans, m_jobs), m_templates(m_document, m_history, m_plans, m_world),
      m_autosave(m_document, m_jobs, autosave_folder),
      m_calibration(m_document, m_jobs, libraryFolder(autosave_folder, QStringLiteral("calibrations"))), m_pose(m_document, m_calibration, m_jobs),
      m_lens(m_calibration, m_jobs), m_stereo(m_document, m_calibration, m_jobs), m_fixture(m_jobs), m_zoom(m_calibration, m_jobs),
      m_health(m_document, m_calibration, m_pose) {
  // A robot that renders its pictures beside a compiler, or sends them over a poor radio, needs seconds for one.
  session::SnapshotTiming timing;
  timing.timeout_s = 10;
  m_motion_folder = autosave_folder.isEmpty()
                        ? QStandardPaths::writableLocation(QStandardPaths::AppLocalDataLocation) +
                              QStringLiteral("/motions")
                        : libraryFolder(autosave_folder, QStringLiteral("motions"));
  m_snapshots.setTiming(timing);
  m_plans.setHeld(&m_held);
  connectParts();
}

Workbench::~Workbench() = default;

void Workbench::connectParts() {
  connect(&m_robot, &RobotSession::attached, this, [this] {
    session::RobotRuntime* runtime = m_robot.runtime();
    m_snapshots.setFeed(m_robot.feed());
    m_aim.setFeed(m_robot.feed());
    m_zoom_drive.setFeed(m_robot.feed());
    m_watch.setFeed(m_robot.feed());
    m_adviser.setFeed(m_robot.feed());
    m_plans.setJointSource([runtime] { return runtime->jointState(); });
    m_plans.setUpSource([this] { return m_robot.status().up; });
    m_play.setRuntime(runtime);
    m_hand.setLive(runtime->mode() == session::RobotMode::kLive);
    if (m_auto_play && runtime->mode() == session::RobotMode::kLive) {
      setAutoPlay(false);
      say(tr("Auto-play is off: this robot is live. Switch it on again if it is meant for it."));
    }
    m_jog.setRobot([runtime](const planning::JogCommand& command) { return runtime->jog(command); },
                   [runtime] { runtime->releaseJog(); });
    const auto& base = runtime->workcell().base;
    m_drive.setRobot([runtime](const BaseTwist& twist) { return runtime->drive(twist); },
                     [runtime] { runtime->releaseDrive(); }, base ? *base : BaseLimits());
    tellObstacles();
  });
  connect(&m_world, &session::WorldController::changed, this, &Workbench::tellObstacles);
  connect(&m_robot, &RobotSession::linkChanged, this, &Workbench::tellObstacles);   // a robot started anew knows none
  connect(&m_robot, &RobotSession::polled, this, [this] {
    if (m_robot.status().base) followBase(*m_robot.status().base);
    m_play.refresh(m_robot.status());
    lookAtGripper();
    if (m_recorder.recording() && m_robot.runtime() != nullptr) {
      if (const auto joints = m_robot.runtime()->jointState()) m_recorder.take(*joints);
    }
  });
  connect(&m_recorder, &session::MotionRecorder::changed, this,
          [this] { m_plans.setRecorded(m_recorder.motions()); });
  connect(&m_recorder, &session::MotionRecorder::failed, this, &Workbench::said);
  connect(&m_held, &session::HeldController::changed, this, &Workbench::tellObstacles);
  connect(&m_held, &session::HeldController::said, this, &Workbench::said);
  connect(&m_robot, &RobotSession::noticed, this, &Workbench::said);
  connect(&m_snapshots, &session::SnapshotController::failed, this, &Workbench::said);
  connect(&m_snapshots, &session::SnapshotController::stateChanged, this, &Workbench::favourCameras);
  connect(&m_live, &LivePictures::watchedChanged, this, &Workbench::favourCameras);
  connect(&m_robot, &RobotSession::linkChanged, this, &Workbench::favourCameras);
  connect(&m_plans, &session::PlanController::failed, this, &Workbench::said);
  connect(&m_targeting, &session::TargetingController::liveMeasureChanged, this, &Workbench::lookAtReach);
  connect(&m_targeting, &session::TargetingController::featuresChanged, this, &Workbench::lookAtReach);
  connect(&m_plans, &session::PlanController::argumentsChanged, this, &Workbench::lookAtReach);
  connect(&m_robot, &RobotSession::playerChanged, this, &Workbench::lookAtReach);
  connect(&m_play, &session::PlayController::failed, this, &Workbench::said);
  connect(&m_hand, &session::PlayHand::said, this, &Workbench::said);
  connect(&m_plans, &session::PlanController::planned, this, &Workbench::playAtOnce);
  connect(&m_aim, &session::AimController::failed, this, &Workbench::said);
  connect(&m_jog, &session::JogController::refused, this, &Workbench::said);
  connect(&m_drive, &session::DriveController::refused, this, &Workbench::said);
  connect(&m_autosave, &session::Autosave::failed, this, &Workbench::said);
  connectCameras();
  connectTemplates();
  connectCalibration();
}

void Workbench::connectTemplates() {
  session::TemplateHands hands;
  hands.joints = [this] { return m_robot.runtime() != nullptr ? m_robot.runtime()->jointState() : nullptr; };
  hands.holding = [this] { return m_robot.runtime() != nullptr && m_robot.runtime()->holding(); };
  hands.move_gripper = [this](double position) -> Status {
    if (m_robot.runtime() == nullptr) return {ErrorCode::kDisconnected, "No robot is connected."};
    return m_robot.runtime()->setGripper(position);
  };
  m_templates.setHands(std::move(hands));
  connect(&m_templates, &session::TemplateController::failed, this, &Workbench::said);
  connect(&m_robot, &RobotSession::polledSlowly, this, [this] {
    const auto& status = m_robot.status();
    // A correction plays a motion of its own to its end; the whole has more to come then.
    const auto& play = m_play.state();
    const bool whole = !play.correcting && play.cursor_s >= play.duration_s - 1e-6;
    m_templates.refresh(status.moving, status.gate.stopped, whole && status.player == planning::PlayerState::kDone);
  });
}

Status Workbench::beginTemplate(WorldItemId item, const QString& action) {
  if (const QString why = whyNotPlan(); !why.isEmpty()) return {ErrorCode::kRefused, why.toStdString()};
  if (m_robot.status().gate.stopped) return {ErrorCode::kRefused, "STOP is latched: hold Reset first."};
  return m_templates.begin(item, action);
}

void Workbench::connectCameras() {
  connect(&m_zoom_drive, &session::ZoomDrive::failed, this, &Workbench::said);
  connect(&m_robot, &RobotSession::stopChanged, this, [this] { if (m_robot.status().gate.stopped) m_zoom_drive.release(); });
  connect(&m_robot, &RobotSession::polled, this, &Workbench::watchMotion);
  connect(&m_aim, &session::AimController::aimed, &m_watch, &session::WatchController::giveWay);
  connect(&m_zoom_drive, &session::ZoomDrive::commanded, this, [this](const QString& camera) {
    const auto& workcell = m_document.workcell();
    const auto* spec = workcell ? workcell->camera(camera.toStdString()) : nullptr;
    if (spec != nullptr) m_watch.giveWay(QString::fromStdString(spec->pan_tilt));
  });
}

// What the plan is for is what the tool works on.
void Workbench::watchMotion() {
  const auto& status = m_robot.status();
  std::vector<Eigen::Vector3d> target;
  const auto& plan = m_document.plan();
  if (plan && plan->feature.valid() && m_document.item(plan->feature) != nullptr) {
    const auto& feature = m_document.measurement(plan->feature).feature;
    if (feature) for (const auto& vertex : feature->vertices) target.push_back(vertex.xyz);
  }
  m_watch.setTarget(std::move(target));
  m_watch.refresh(status.moving, status.gate.stopped);
}

void Workbench::frameSelection() {
  std::vector<Eigen::Vector3d> points;
  for (const auto id : m_document.selection().items) {
    const auto& feature = m_document.measurement(id).feature;
    if (feature) for (const auto& vertex : feature->vertices) points.push_back(vertex.xyz);
  }
  if (points.empty()) return say(tr("Select a measured feature first, or drag a frame in a live picture."));
  if (const QString why = m_robot.whyNotReady(); !why.isEmpty()) return say(why);
  QString done;                            // Two cameras of one head cannot look at different places.
  for (const QString& camera : m_pane_cameras) {
    const auto* spec = m_document.workcell()->camera(camera.toStdString());
    if (spec == nullptr || spec->pan_tilt.empty() || QString::fromStdString(spec->pan_tilt) == done) continue;
    done = QString::fromStdString(spec->pan_tilt);
    m_aim.framePoints(camera, points);
  }
  if (done.isEmpty()) say(tr("Neither pane shows a camera that a pan-tilt aims."));
}

void Workbench::lookAtGripper() {
  if (!m_robot.runtime() || !m_robot.linkUp()) return;
  const auto q = m_robot.runtime()->configuration();
  if (q) m_held.refresh(m_robot.runtime()->holding(), *q);
}

// What a jog keeps clear of: the workcell's bodies and those that were sketched; what is held moves along.
void Workbench::tellObstacles() {
  const auto& workcell = m_document.workcell();
  if (!m_robot.runtime() || !m_robot.linkUp() || !workcell) return;
  std::vector<planning::WorldObject> objects = m_held.obstacles({});
  if (m_held.held()) objects.push_back(m_held.held()->body);
  for (const auto& object : workcell->objects) {
    if (!m_held.held() || m_held.held()->body.name != object.name) objects.push_back(object);
  }
  m_robot.runtime()->setObstacles(objects);
}

void Workbench::connectCalibration() {
  connect(&m_calibration, &session::CalibrationController::applied, this, [this](const QString& camera) {
    useCalibrations();
    say(tr("Camera %1 uses another calibration now; snapshots keep the one they were taken with.").arg(camera));
  });
  connect(&m_calibration, &session::CalibrationController::placed, this, [this](const QString& name) {
    useCalibrations();
    say(tr("%1 stands where its placement in use says; snapshots keep what they were taken with.").arg(name));
  });
  connect(&m_calibration.intrinsics(), &session::IntrinsicsController::failed, this, &Workbench::said);
  connect(&m_lens, &session::LensController::failed, this, &Workbench::said);
  connect(&m_calibration, &session::CalibrationController::failed, this, &Workbench::said);
  connect(&m_calibration, &session::CalibrationController::solvedAgain, this, [this](const QString& id) {
    say(tr("Solved again from its raw data: kept as %1, not in use. Compare the two in the library.").arg(id));
  });
  connect(&m_stereo, &session::StereoController::failed, this, &Workbench::said);
  connect(&m_fixture, &session::FixtureController::failed, this, &Workbench::said);
  connect(&m_zoom, &session::ZoomController::failed, this, &Workbench::said);
  connect(&m_health, &session::HealthController::changed, this, [this] {
    const QString camera = m_health.worstCamera();
    if (!camera.isEmpty()) say(QString::fromStdString(m_health.of(camera.toStdString()).why));
  });
}

void Workbench::openRobot(const RobotChoice& choice) {
  using WorkcellPtr = std::shared_ptr<const planning::Workcell>;
  m_jobs.run<WorkcellPtr>(
      this,
      [choice]() -> Result<WorkcellPtr> {
        auto workcell = chosenWorkcell(choice);
        if (!workcell) return workcell.error();
        return std::make_shared<const planning::Workcell>(std::move(*workcell));
      },
      [this, choice](Result<WorkcellPtr> workcell) {
        if (!workcell) {
          m_robot.giveUp(QString::fromStdString(workcell.error().message));
          return;
        }
        setWorkcell(*workcell);
        session::RuntimeOptions options;
        options.mode = (*workcell)->backend.is_virtual ? session::RobotMode::kVirtual : session::RobotMode::kLive;
        options.scenario = choice.scenario.toStdString();
        options.variant = choice.variant.toStdString();
        m_robot.start(*workcell, options);
      });
}

void Workbench::setWorkcell(std::shared_ptr<const planning::Workcell> workcell) {
  m_calibration.setWorkcell(std::move(workcell));
  useCalibrations();
  m_recorder.open(m_motion_folder, m_document.workcell()->armJointNames());
  chooseCameras();
  for (const auto& warning : m_calibration.library().warnings()) say(QString::fromStdString(warning));
  for (const auto& warning : m_document.workcell()->warnings) say(QString::fromStdString(warning));
}

void Workbench::useCalibrations() {
  const auto workcell = m_calibration.workcellInUse();
  m_document.setWorkcell(planning::withBaseAt(workcell, poseOf(m_stands_at)));
  m_live.setWorkcell(workcell);
  m_aim.setWorkcell(workcell);
  m_zoom_drive.setWorkcell(workcell);
  m_watch.setWorkcell(workcell);
  for (const auto& warning : m_templates.reload()) say(QString::fromStdString(warning));
}

// What stands in the room stays there while the base is driven: wherever that comes to rest, the bodies are told anew.
void Workbench::followBase(const BaseState& base) {
  m_document.setBase(base);
  if (!base.twist.standing() || samePlace(base, m_stands_at)) return;
  m_stands_at = base;
  const auto workcell = m_calibration.workcellInUse();
  if (workcell && planning::hasRoom(*workcell)) m_document.setWorkcell(planning::withBaseAt(workcell, poseOf(base)));
  tellObstacles();
  Q_EMIT baseRested();
}

QString Workbench::whyNotCalibrate() const {
  if (!m_document.workcell()) return tr("There is no workcell whose cameras could use it; save it to a file.");
  if (m_robot.status().moving) return tr("The arm is moving: pause or stop it first.");
  if (m_robot.armed()) return tr("The robot is armed: press STOP before a camera is changed under a motion.");
  return {};
}

void Workbench::chooseCameras() {
  const auto& cameras = m_document.workcell()->cameras;
  QString left, right;
  for (const auto& camera : cameras) {
    if (camera.role == "stereo_left" && !camera.stereo_partner.empty()) {
      left = QString::fromStdString(camera.name);
      right = QString::fromStdString(camera.stereo_partner);
    }
  }
  for (std::size_t i = 0; left.isEmpty() && i + 1 < cameras.size(); ++i) {
    if (cameras[i].role != "ptz" || cameras[i + 1].role != "ptz") continue;
    left = QString::fromStdString(cameras[i].name);
    right = QString::fromStdString(cameras[i + 1].name);
  }
  if (left.isEmpty() && cameras.size() >= 2) {
    left = QString::fromStdString(cameras[0].name);
    right = QString::fromStdString(cameras[1].name);
  }
  setPaneCamera(PaneSide::kLeft, left);
  setPaneCamera(PaneSide::kRight, right);
}

void Workbench::setPaneCamera(PaneSide side, const QString& camera) {
  if (m_pane_cameras[static_cast<int>(side)] == camera) return;
  m_pane_cameras[static_cast<int>(side)] = camera;
  Q_EMIT paneCameraChanged(side);
}

QString Workbench::whyNotTakePair() const {
  if (const QString why = m_robot.whyNotReady(); !why.isEmpty()) return why;
  if (const QString why = m_snapshots.whyNot(); !why.isEmpty()) return why;
  const QString& left = m_pane_cameras[0];
  const QString& right = m_pane_cameras[1];
  if (left.isEmpty() || right.isEmpty()) return tr("The workcell has fewer than two cameras.");
  if (left == right) return tr("Both panes are set to camera %1: choose two cameras.").arg(left);
  return {};
}

void Workbench::takePair() {
  if (const QString why = whyNotTakePair(); !why.isEmpty()) return say(why);
  m_snapshots.takePair(m_pane_cameras[0], m_pane_cameras[1]);
}

// While a pair is taken, or a calibration looks through a camera, the others are silent: on a slow link or a busy robot each
// costs time, and a board that rests for two seconds must be seen twice.
void Workbench::favourCameras() {
  auto* runtime = m_robot.runtime();
  if (runtime == nullptr || !m_robot.linkUp()) return;
  const bool taking = m_snapshots.state() == session::SnapshotController::State::kWaiting, watching = !m_live.watched().isEmpty();
  for (const auto& camera : runtime->workcell().cameras) {
    const QString name = QString::fromStdString(camera.name);
    const bool shown = name == m_pane_cameras[0] || name == m_pane_cameras[1];
    const bool wanted = taking ? shown : !watching || m_live.watched().contains(name);
    (void)runtime->streamCamera(camera.name, wanted);
  }
}

void Workbench::showClearestView(FeatureId feature) {
  const auto advice = m_adviser.advise(feature);
  if (!advice) return say(QString::fromStdString(advice.error().message));
  say(QString::fromStdString(advice->text));
  if (advice->already_shown) return;
  if (advice->snapshot.valid()) return m_targeting.showSnapshot(advice->side, advice->snapshot);
  if (const QString why = m_robot.whyNotReady(); !why.isEmpty()) return say(why);
  if (const QString why = m_snapshots.whyNot(); !why.isEmpty()) return say(why);
  m_snapshots.take(QString::fromStdString(advice->camera), advice->side);
}

QString Workbench::whyNotDrive() const {
  const auto& workcell = m_document.workcell();
  if (workcell && !workcell->base)
    return tr("This robot has no base that can be driven: its workcell names none.");
  if (const QString why = m_robot.whyNotReady(); !why.isEmpty()) return why;
  if (m_robot.status().gate.stopped) return tr("STOP is latched: hold Reset first.");
  if (!m_robot.status().base) return tr("The robot tells no odometry.");
  if (m_robot.status().moving) return tr("The arm is moving: it must be held while the base drives.");
  return {};
}

QString Workbench::whyNotPlan() const {
  if (m_robot.status().driving) return tr("The base is driving.");
  if (m_robot.status().moving) return tr("The arm is moving: pause or stop it first.");
  return m_robot.whyNotReady();
}

// A motion to something that a knocked camera measured is refused; canned motions need no camera.
QString Workbench::whyNotTrust(const QString& macro) const {
  for (const auto& row : m_plans.macros()) {
    if (row.name == macro && row.takes) return m_health.whyNotTrust(m_document.selection().primary);
  }
  return {};
}

void Workbench::plan(const QString& macro) {
  if (const QString why = whyNotPlan(); !why.isEmpty()) return say(why);
  if (const QString why = whyNotTrust(macro); !why.isEmpty()) return say(why);
  m_play_when_planned = m_auto_play;
  const Status started = m_plans.plan(macro);
  if (!started) say(QString::fromStdString(started.error().message));
}

void Workbench::replan() {
  if (const QString why = whyNotPlan(); !why.isEmpty()) return say(why);
  m_play_when_planned = false;
  const Status started = m_plans.replan();
  if (!started) say(QString::fromStdString(started.error().message));
}

void Workbench::planOtherWay() {
  if (const QString why = whyNotPlan(); !why.isEmpty()) return say(why);
  m_play_when_planned = false;
  const Status started = m_plans.planOtherWay();
  if (!started) say(QString::fromStdString(started.error().message));
}

QString Workbench::whyNotReregister() const {
  const auto found = session::findRegistration(m_document);
  return found ? QString() : QString::fromStdString(found.error().message);
}

void Workbench::reregister() {
  const auto found = session::findRegistration(m_document);
  if (!found) return say(QString::fromStdString(found.error().message));
  const Eigen::Matrix3d spread = found->covariance.bottomRightCorner<3, 3>();
  m_history.seal();
  m_history.push(session::applyRegistration(m_document, *found));
  say(tr("%1 stale features moved by %2 marks: residual %3 mm rms, place known to %4 mm (95 %).")
          .arg(found->features)
          .arg(found->marks)
          .arg(found->residual_rms * 1000, 0, 'f', 1)
          .arg(1000 * session::plusMinus95(std::sqrt(spread.diagonal().maxCoeff())), 0, 'f', 1));
}

void Workbench::setAutoPlay(bool on) {
  if (m_auto_play == on) return;
  m_auto_play = on;
  m_play_when_planned = false;
  Q_EMIT autoPlayChanged();
}

void Workbench::playAtOnce(bool planned) {
  if (!std::exchange(m_play_when_planned, false) || !planned || m_hand.holdToRun()) return;
  if (m_play.state().can_play)
    m_play.play();
  else
    say(tr("Not played at once: %1").arg(m_play.state().why_not_play));
}

// What is dragged, or what is selected.
void Workbench::lookAtReach() {
  const auto live = m_targeting.liveMeasure();
  const vision::Feature* selected = m_document.selectedFeature();
  std::optional<vision::Feature> feature;
  if (live && live->feature) feature = live->feature;
  else if (selected != nullptr) feature = *selected;
  m_reach.setFeature(std::move(feature));
}

void Workbench::nudge(planning::JogFrame frame, const Eigen::Vector3d& way, const Eigen::Vector3d& turn) {
  if (m_robot.runtime() == nullptr) return say(tr("No robot is connected."));
  const auto q = m_robot.runtime()->configuration();
  if (!q) return say(QString::fromStdString(q.error().message));
  const auto axes = planning::axesOf(m_robot.runtime()->workcell(), *q, frame, m_pane_cameras[0].toStdString());
  if (!axes) return say(QString::fromStdString(axes.error().message));
  m_play.nudge({*axes, way, turn});
}

void Workbench::say(const QString& sentence) {
  if (!sentence.isEmpty()) Q_EMIT said(sentence);
}

}  // namespace longarm::ui
