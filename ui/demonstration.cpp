#include "ui/demonstration.h"

#include <algorithm>
#include <utility>

#include <QDir>
#include <QPushButton>
#include <QToolButton>
#include <nlohmann/json.hpp>

#include "planning/world/scenario.h"
#include "session/controllers/snapshot_maker.h"

namespace longarm::ui {

using session::ToolKind;
using vision::PaneSide;

namespace {

constexpr double kTruth_s = 3, kAim_s = 20, kPair_s = 15, kPlan_s = 30, kPlay_s = 180, kGrip_s = 15;
constexpr double kMargin_px = 40;          // So far inside both pictures the pipe's ends must lie.
constexpr int kTurns = 12;
constexpr const char* kPipe = "pipe";

Status failed(const QString& sentence) { return {ErrorCode::kNoSolution, sentence.toStdString()}; }

Result<Pose> poseFrom(const nlohmann::json& json) {
  try {
    const auto& xyz = json.at("xyz");
    const auto& q = json.at("quaternion_xyzw");
    Pose X = Pose::Identity();
    X.translation() = Eigen::Vector3d(xyz.at(0), xyz.at(1), xyz.at(2));
    X.linear() = Eigen::Quaterniond(q.at(3), q.at(0), q.at(1), q.at(2)).normalized().toRotationMatrix();
    return X;
  } catch (const nlohmann::json::exception& problem) {
    return {ErrorCode::kInvalidInput, std::string("A pose of the virtual robot: ") + problem.what()};
  }
}

QToolButton* buttonOf(QWidget* within, QAction* action) {
  for (auto* button : within->findChildren<QToolButton*>()) {
    if (button->defaultAction() == action && button->isVisible()) return button;
  }
  return nullptr;
}

}  // namespace

Demonstration::Demonstration(MainWindow& window, DemonstrationOptions options)
    : m_window(window), m_bench(window.bench()), m_options(std::move(options)) {}

Status Demonstration::run() {
  if (!m_options.folder.isEmpty() && !QDir().mkpath(m_options.folder)) {
    return failed(QStringLiteral("The folder %1 cannot be made.").arg(m_options.folder));
  }
  using Step = Status (Demonstration::*)();
  for (const Step step : {&Demonstration::waitForLink, &Demonstration::aim, &Demonstration::takePair, &Demonstration::drawLine,
                          &Demonstration::planGrab, &Demonstration::release, &Demonstration::play, &Demonstration::grip,
                          &Demonstration::showSizes}) {
    if (const Status status = (this->*step)(); !status) {
      (void)shoot("failed");
      return status;
    }
  }
  return {};
}

Result<Demonstration::Truth> Demonstration::truth() const {
  auto* runtime = m_bench.robot().runtime();
  if (runtime == nullptr) return {ErrorCode::kDisconnected, "No robot is connected."};
  const auto answer = runtime->callService("/virtual_robot/truth", "{}", kTruth_s);
  if (!answer) return answer.error();
  const auto scenario = planning::loadScenario(m_options.scenario.toStdString());
  if (!scenario) return scenario.error();
  const auto* pipe = scenario->object(kPipe);
  const auto* shape = pipe != nullptr ? std::get_if<planning::Cylinder>(&pipe->body.shape) : nullptr;
  if (shape == nullptr) return {ErrorCode::kNotFound, "The scenario " + scenario->name + " has no pipe to grab."};
  const auto json = nlohmann::json::parse(*answer, nullptr, false);
  if (json.is_discarded() || !json.is_object()) return {ErrorCode::kInvalidInput, "The virtual robot's truth is no JSON object."};
  Truth result;
  result.held = json.value("held", std::string());
  for (const auto& object : json.value("objects", nlohmann::json::array())) {
    if (object.value("name", std::string()) != kPipe) continue;
    const auto X_WO = poseFrom(object.value("pose", nlohmann::json::object()));
    if (!X_WO) return X_WO.error();
    result.ends = {*X_WO * Eigen::Vector3d(0, 0, -shape->length / 2), *X_WO * Eigen::Vector3d(0, 0, shape->length / 2)};
  }
  const auto links = json.value("links", nlohmann::json::object());
  for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
    const auto* camera = runtime->workcell().camera(m_bench.paneCamera(side).toStdString());
    if (camera == nullptr || !links.contains(camera->link)) {
      return {ErrorCode::kNotFound, "The virtual robot does not say where camera " + m_bench.paneCamera(side).toStdString() + " is."};
    }
    const auto X_WC = poseFrom(links.at(camera->link));
    if (!X_WC) return X_WC.error();
    result.X_WC[static_cast<std::size_t>(side)] = *X_WC;
  }
  return result;
}

Result<Eigen::Vector2d> Demonstration::see(PaneSide side, const Truth& truth, const Eigen::Vector3d& p_W) const {
  const auto& runtime = *m_bench.robot().runtime();
  const std::string camera = m_bench.paneCamera(side).toStdString();
  const auto zoom = runtime.zoomAt(camera, runtime.clock().now_s());
  if (!zoom) return zoom.error();
  const auto view = session::cameraView(runtime.workcell(), camera, *runtime.jointState(), *zoom);
  if (!view) return view.error();
  return view->camera.project(truth.X_WC[static_cast<std::size_t>(side)].inverse() * p_W);
}

Status Demonstration::waitForLink() {
  if (m_bench.robot().status().mode != session::RobotMode::kVirtual) {
    return {ErrorCode::kRefused, "A demonstration works the virtual robot only; this one is real."};
  }
  const auto up = [this] {
    return m_bench.robot().linkUp() && !m_bench.live().picture(m_bench.paneCamera(PaneSide::kLeft)).empty() &&
           !m_bench.live().picture(m_bench.paneCamera(PaneSide::kRight)).empty();
  };
  if (!SimulatedHand::waitFor(up, m_options.link_timeout_s)) {
    return failed(QStringLiteral("No link with live pictures within %1 s: %2").arg(m_options.link_timeout_s)
                      .arg(QString::fromStdString(m_bench.robot().status().link_text)));
  }
  SimulatedHand::pump(400);
  return shoot("live");
}

bool Demonstration::inPicture(PaneSide side, const Truth& now) const {
  const auto view = m_bench.live().view(m_bench.paneCamera(side));
  return view && std::all_of(now.ends.begin(), now.ends.end(), [&](const Eigen::Vector3d& end) {
    const auto pixel = see(side, now, end);
    return pixel && view->camera.containsPixel(*pixel, -kMargin_px);
  });
}

QString Demonstration::panTiltOf(PaneSide side) const {
  const auto* camera = m_bench.robot().runtime()->workcell().camera(m_bench.paneCamera(side).toStdString());
  return camera != nullptr ? QString::fromStdString(camera->pan_tilt) : QString();
}

// One turn of the head that carries this pane's camera: a double click on the pipe, or the keys where it is out of the picture.
void Demonstration::turnTowardsPipe(PaneSide side, const Truth& now) {
  auto* canvas = m_window.pictures()->pane(side)->canvas();
  const Eigen::Vector3d pipe_W = (now.ends[0] + now.ends[1]) / 2;
  const auto middle = see(side, now, pipe_W);
  const auto at = middle && canvas->pictureSize().width() > 0 ? canvas->widgetOfPixel(*middle) : std::nullopt;
  if (at && canvas->rect().contains(at->toPoint())) {
    m_hand.doubleClick(canvas, *at);
  } else {
    const Eigen::Vector3d p_C = now.X_WC[static_cast<std::size_t>(side)].inverse() * pipe_W;
    for (int i = 0; i < 3; ++i) m_hand.key(canvas, p_C.x() > 0 ? Qt::Key_Right : Qt::Key_Left, Qt::ShiftModifier);
    for (int i = 0; i < 2; ++i) m_hand.key(canvas, p_C.y() > 0 ? Qt::Key_Down : Qt::Key_Up, Qt::ShiftModifier);
  }
  const auto still = [this, head = panTiltOf(side).toStdString()] {
    const auto angles = m_bench.robot().runtime()->panTilt(head);
    return !angles || !angles->moving;
  };
  SimulatedHand::pump(300);
  SimulatedHand::waitFor(still, kAim_s);
}

Status Demonstration::aim() {
  auto now = truth();
  if (!now) return now.error();
  const auto aimed = [&] { return inPicture(PaneSide::kLeft, *now) && inPicture(PaneSide::kRight, *now); };
  const bool two_heads = panTiltOf(PaneSide::kLeft) != panTiltOf(PaneSide::kRight);
  for (int tries = 0; tries < kTurns && !aimed(); ++tries) {
    turnTowardsPipe(two_heads && inPicture(PaneSide::kLeft, *now) ? PaneSide::kRight : PaneSide::kLeft, *now);
    now = truth();
    if (!now) return now.error();
  }
  return aimed() ? Status() : failed(QStringLiteral("The pipe could not be brought into both pictures."));
}

Status Demonstration::takePair() {
  auto* button = buttonOf(&m_window, m_window.actions().at(ActionId::kTakePair));
  if (button == nullptr) return failed(QStringLiteral("There is no button to take a pair."));
  const auto taken = [this] { return m_bench.document().paneSnapshot(PaneSide::kLeft) && m_bench.document().paneSnapshot(PaneSide::kRight); };
  const auto answered = [&] { return taken() || m_bench.snapshots().state() == session::SnapshotController::State::kIdle; };
  // An operator whose pair was refused presses again.
  for (int tries = 0; tries < 8 && !taken(); ++tries) {
    SimulatedHand::pump(400);
    m_hand.click(button);
    SimulatedHand::waitFor(answered, kPair_s);
  }
  if (!taken()) return failed(QStringLiteral("No pair was taken: %1").arg(m_window.strip()->message()));
  return shoot("pair");
}

Result<Eigen::Vector2d> Demonstration::handle(PaneSide side, int vertex) const {
  const auto& document = m_bench.document();
  if (!document.items().empty()) {
    const auto* pick = document.items().back().pick(document.paneSnapshotId(side), vertex);
    if (pick != nullptr) return pick->pixel;
  }
  // The tool's own copy: dashed markers in vertex order, the active one among them.
  int index = 0;
  for (const auto& shape : m_bench.targeting().overlay(side).shapes) {
    const bool marker = shape.kind == vision::OverlayShape::Kind::kMarker &&
                        (shape.role == vision::OverlayRole::kUnplaced || shape.role == vision::OverlayRole::kActiveHandle);
    if (marker && index++ == vertex) return shape.points.front();
  }
  return {ErrorCode::kNotFound, "The line tool shows no handle " + std::to_string(vertex + 1) + "."};
}

Status Demonstration::dragHandle(PaneSide side, int vertex, const Eigen::Vector2d& to) {
  auto* canvas = m_window.pictures()->pane(side)->canvas();
  const auto from = handle(side, vertex);
  if (!from) return from.error();
  const auto start = canvas->widgetOfPixel(*from), end = canvas->widgetOfPixel(to);
  if (!start || !end) return failed(QStringLiteral("A handle lies outside the picture shown."));
  m_hand.drag(canvas, *start, *end);
  return {};
}

Status Demonstration::drawLine() {
  const auto now = truth();
  if (!now) return now.error();
  auto* tool = buttonOf(&m_window, m_window.actions().at(ActionId::kToolLine));
  if (tool == nullptr) return failed(QStringLiteral("There is no button for the line tool."));
  m_hand.click(tool);
  if (const Status shown = shoot("line-tool"); !shown) return shown;
  for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
    for (int vertex = 0; vertex < 2; ++vertex) {
      const auto to = see(side, *now, now->ends[static_cast<std::size_t>(vertex)]);
      if (!to) return to.error();
      if (const Status dragged = dragHandle(side, vertex, *to); !dragged) return dragged;
    }
    if (const Status shown = shoot(side == PaneSide::kLeft ? "left-marked" : "both-marked"); !shown) return shown;
  }
  const auto* feature = m_bench.document().selectedFeature();
  if (feature == nullptr) return failed(QStringLiteral("The line is not measured: %1").arg(m_bench.targeting().hint()));
  return {};
}

Status Demonstration::planGrab() {
  auto* button = m_window.macros()->button(QStringLiteral("grab_pipe"));
  if (button == nullptr) return failed(QStringLiteral("There is no button Grab Pipe."));
  if (!SimulatedHand::waitFor([button] { return button->isEnabled(); }, kAim_s)) {
    return failed(QStringLiteral("Grab Pipe is not offered: %1").arg(button->toolTip()));
  }
  m_hand.click(button);
  const auto finished = [this] { return m_bench.document().plan().has_value(); };
  if (!SimulatedHand::waitFor(finished, kPlan_s)) return failed(QStringLiteral("No plan: %1").arg(m_window.strip()->message()));
  const auto& plan = m_bench.document().plan()->plan;
  if (!plan.ok()) return {ErrorCode::kNoSolution, "Grab Pipe was refused: " + plan.reason};
  auto* bar = m_window.motion()->bar()->timeBar();
  const double y = bar->height() / 3.0;
  m_hand.drag(bar, {bar->xOf(0), y}, {bar->xOf(0.75 * plan.trajectory.duration()), y});
  if (const Status shown = shoot("preview"); !shown) return shown;
  m_hand.drag(bar, {bar->xOf(0.75 * plan.trajectory.duration()), y}, {bar->xOf(0), y});
  return {};
}

Status Demonstration::release() {
  auto* reset = m_window.stopPanel()->resetButton();
  const auto free = [this] { return !m_bench.robot().status().gate.stopped; };
  if (!free() && !m_hand.hold(reset, free, 5)) return failed(QStringLiteral("STOP was not reset: %1").arg(m_window.strip()->message()));
  auto* open = buttonOf(&m_window, m_window.actions().at(ActionId::kGripperOpen));
  const auto& gripper = m_bench.robot().runtime()->workcell().gripper;
  if (open == nullptr || !gripper) return failed(QStringLiteral("There is no gripper to open."));
  m_hand.click(open);
  const double wide = gripper->closed + 0.9 * (gripper->open - gripper->closed);
  const auto opened = [this, &gripper, wide] {
    const double at = m_bench.robot().runtime()->gripperPosition();
    return gripper->open > gripper->closed ? at >= wide : at <= wide;
  };
  return SimulatedHand::waitFor(opened, kGrip_s) ? Status() : failed(QStringLiteral("The gripper did not open."));
}

// Presses Play as often as it takes: on a busy machine the watchdogs may stop the arm on its way, and when it then
// stands beside its path the console asks for a new plan.
bool Demonstration::keepPlaying() {
  using planning::PlayerState;
  auto* button = m_window.motion()->bar()->playButton();
  const auto player = m_bench.robot().status().player;
  if (player == PlayerState::kDone) return true;
  if (m_bench.play().state().playing || m_bench.plans().state() == session::PlanController::State::kPlanning) return false;
  if (m_bench.robot().status().gate.stopped) {
    (void)m_hand.hold(m_window.stopPanel()->resetButton(), [this] { return !m_bench.robot().status().gate.stopped; }, 5);
  } else if (m_bench.play().state().stale) {
    m_hand.click(buttonOf(&m_window, m_window.actions().at(ActionId::kReplan)));
  } else if (button->isEnabled()) {
    m_hand.click(button);
  }
  return false;
}

Status Demonstration::play() {
  const double half = m_bench.document().plan()->plan.trajectory.duration() / 2;
  bool over = false;
  const auto midway = [&] { return (over = keepPlaying()) || m_bench.play().state().cursor_s > half; };
  if (!SimulatedHand::waitFor(midway, kPlay_s)) return failed(QStringLiteral("The arm did not get half way: %1").arg(m_window.strip()->message()));
  if (const Status shown = shoot("playing"); !shown) return shown;
  if (!over && !SimulatedHand::waitFor([this] { return keepPlaying(); }, kPlay_s)) {
    return failed(QStringLiteral("The motion did not end: %1").arg(m_window.strip()->message()));
  }
  return {};
}

Status Demonstration::grip() {
  auto* close = buttonOf(&m_window, m_window.actions().at(ActionId::kGripperClose));
  if (close == nullptr) return failed(QStringLiteral("There is no button to close the gripper."));
  m_hand.click(close);
  if (!SimulatedHand::waitFor([this] { return m_bench.robot().runtime()->holding(); }, kGrip_s)) {
    return failed(QStringLiteral("The gripper closed on nothing."));
  }
  const auto now = truth();
  if (!now) return now.error();
  if (now->held != kPipe) return failed(QStringLiteral("The gripper holds \"%1\", not the pipe.").arg(QString::fromStdString(now->held)));
  m_hand.click(buttonOf(&m_window, m_window.actions().at(ActionId::kSceneReset)));
  for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) m_hand.click(m_window.pictures()->pane(side)->liveButton());
  // Live pictures of after the grip, which a busy machine takes its time over.
  const double gripped_s = m_bench.robot().runtime()->clock().now_s();
  const auto fresh = [this, gripped_s] {
    const double now_s = m_bench.robot().runtime()->clock().now_s();
    for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
      const auto age = m_bench.live().age(m_bench.paneCamera(side));
      if (!age || now_s - *age < gripped_s) return false;
    }
    return true;
  };
  SimulatedHand::waitFor(fresh, kPair_s);
  SimulatedHand::pump(500);
  return shoot("gripped");
}

Status Demonstration::showSizes() {
  if (m_options.folder.isEmpty()) return {};
  const QSize before = m_window.size();
  for (const auto& [size, name] : {std::pair{QSize(1280, 800), "small"}, std::pair{QSize(1920, 1080), "large"}}) {
    if (const Status shown = shootAt(size, name); !shown) return shown;
  }
  m_window.resize(before);
  return {};
}

Status Demonstration::shootAt(const QSize& size, const char* name) {
  m_window.resize(size);
  SimulatedHand::pump(600);
  return shoot(name);
}

Status Demonstration::shoot(const char* name) {
  if (m_options.folder.isEmpty()) return {};
  m_window.scene()->view()->requestRender();
  SimulatedHand::pump(350);
  const QString path = QStringLiteral("%1/%2-%3.png").arg(m_options.folder).arg(m_pictures + 1, 2, 10, QLatin1Char('0')).arg(QString::fromLatin1(name));
  // Packing a picture takes long enough for the watchdog to think that the window hangs: not on this thread.
  const QImage image = m_window.grab().toImage();
  const auto written = std::make_shared<std::optional<bool>>();
  m_bench.jobs().run<bool>(
      &m_window, [image, path]() -> Result<bool> { return image.save(path); },
      [written](Result<bool> result) { *written = result.valueOr(false); });
  SimulatedHand::waitFor([written] { return written->has_value(); }, 60);
  if (!written->value_or(false)) return failed(QStringLiteral("The picture %1 could not be written.").arg(path));
  ++m_pictures;
  return {};
}

}  // namespace longarm::ui
