#include "ui/simulated_operator.h"

#include <algorithm>

#include <QPushButton>
#include <QToolButton>

#include "session/controllers/snapshot_maker.h"

namespace longarm::ui {

using vision::PaneSide;

namespace {

constexpr double kTruth_s = 3, kAim_s = 20, kPair_s = 15, kGrip_s = 15;
constexpr double kMargin_px = 40;  // So far inside both pictures what is to be marked must lie.
constexpr int kTurns = 12;

Status failed(const QString& sentence) { return {ErrorCode::kNoSolution, sentence.toStdString()}; }

QToolButton* buttonOf(QWidget* within, QAction* action) {
  for (auto* button : within->findChildren<QToolButton*>()) {
    if (button->defaultAction() == action && button->isVisible()) return button;
  }
  return nullptr;
}

}  // namespace

Result<SimulatedOperator::Truth> SimulatedOperator::look() const {
  auto* runtime = m_bench.robot().runtime();
  if (runtime == nullptr) return {ErrorCode::kDisconnected, "No robot is connected."};
  const auto answer = runtime->callService("/virtual_robot/truth", "{}", kTruth_s);
  if (!answer) return answer.error();
  auto truth = session::parseTruth(*answer);
  if (!truth) return truth;
  for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
    const std::string name = m_bench.paneCamera(side).toStdString();
    const auto* camera = runtime->workcell().camera(name);
    if (camera == nullptr || truth->links.count(camera->link) == 0) {
      return {ErrorCode::kNotFound, "The virtual robot does not say where camera " + name + " is."};
    }
  }
  return truth;
}

Pose SimulatedOperator::cameraPose(PaneSide side, const Truth& now) const {
  const auto* camera = m_bench.robot().runtime()->workcell().camera(m_bench.paneCamera(side).toStdString());
  return now.links.at(camera->link);
}

Result<Eigen::Vector2d> SimulatedOperator::see(PaneSide side, const Truth& now,
                                               const Eigen::Vector3d& p_W) const {
  const auto& runtime = *m_bench.robot().runtime();
  const std::string camera = m_bench.paneCamera(side).toStdString();
  const auto zoom = runtime.zoomAt(camera, runtime.clock().now_s());
  if (!zoom) return zoom.error();
  const auto view = session::cameraView(runtime.workcell(), camera, *runtime.jointState(), *zoom);
  if (!view) return view.error();
  return view->camera.project(cameraPose(side, now).inverse() * p_W);
}

Status SimulatedOperator::waitForLink(double timeout_s) {
  if (m_bench.robot().status().mode != session::RobotMode::kVirtual) {
    return {ErrorCode::kRefused, "A demonstration works the virtual robot only; this one is real."};
  }
  const auto up = [this] {
    return m_bench.robot().linkUp() && !m_bench.live().picture(m_bench.paneCamera(PaneSide::kLeft)).empty() &&
           !m_bench.live().picture(m_bench.paneCamera(PaneSide::kRight)).empty();
  };
  if (!SimulatedHand::waitFor(up, timeout_s)) {
    return failed(QStringLiteral("No link with live pictures within %1 s: %2")
                      .arg(timeout_s)
                      .arg(QString::fromStdString(m_bench.robot().status().link_text)));
  }
  SimulatedHand::pump(400);
  return {};
}

bool SimulatedOperator::inPicture(PaneSide side, const Truth& now, const Points& points) const {
  const auto view = m_bench.live().view(m_bench.paneCamera(side));
  return view && std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& p_W) {
           const auto pixel = see(side, now, p_W);
           return pixel && view->camera.containsPixel(*pixel, -kMargin_px);
         });
}

QString SimulatedOperator::panTiltOf(PaneSide side) const {
  const auto* camera = m_bench.robot().runtime()->workcell().camera(m_bench.paneCamera(side).toStdString());
  return camera != nullptr ? QString::fromStdString(camera->pan_tilt) : QString();
}

// One turn of the head that carries this pane's camera: a double click on the place, or the keys where it is
// out of the picture.
void SimulatedOperator::turnTowards(PaneSide side, const Truth& now, const Eigen::Vector3d& p_W) {
  auto* canvas = m_window.pictures()->pane(side)->canvas();
  const auto middle = see(side, now, p_W);
  const auto at = middle && canvas->pictureSize().width() > 0 ? canvas->widgetOfPixel(*middle) : std::nullopt;
  if (at && canvas->rect().contains(at->toPoint())) {
    m_hand.doubleClick(canvas, *at);
  } else {
    const Eigen::Vector3d p_C = cameraPose(side, now).inverse() * p_W;
    for (int i = 0; i < 3; ++i)
      m_hand.key(canvas, p_C.x() > 0 ? Qt::Key_Right : Qt::Key_Left, Qt::ShiftModifier);
    for (int i = 0; i < 2; ++i)
      m_hand.key(canvas, p_C.y() > 0 ? Qt::Key_Down : Qt::Key_Up, Qt::ShiftModifier);
  }
  const auto still = [this, head = panTiltOf(side).toStdString()] {
    const auto angles = m_bench.robot().runtime()->panTilt(head);
    return !angles || !angles->moving;
  };
  SimulatedHand::pump(300);
  SimulatedHand::waitFor(still, kAim_s);
}

Status SimulatedOperator::aim(const std::function<Result<Points>()>& points) {
  const bool two_heads = panTiltOf(PaneSide::kLeft) != panTiltOf(PaneSide::kRight);
  for (int tries = 0; tries < kTurns; ++tries) {
    const auto wanted = points();
    const auto now = look();
    if (!wanted) return wanted.error();
    if (!now) return now.error();
    const bool left = inPicture(PaneSide::kLeft, *now, *wanted);
    if (left && inPicture(PaneSide::kRight, *now, *wanted)) return {};
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& p_W : *wanted) middle += p_W / static_cast<double>(wanted->size());
    turnTowards(two_heads && left ? PaneSide::kRight : PaneSide::kLeft, *now, middle);
  }
  return failed(QStringLiteral("It could not be brought into both pictures."));
}

Status SimulatedOperator::takePair() {
  auto* button = buttonOf(&m_window, m_window.actions().at(ActionId::kTakePair));
  if (button == nullptr) return failed(QStringLiteral("There is no button to take a pair."));
  const auto left = m_bench.document().paneSnapshotId(PaneSide::kLeft),
             right = m_bench.document().paneSnapshotId(PaneSide::kRight);
  const auto taken = [this, left, right] {
    const auto& document = m_bench.document();
    return document.paneSnapshot(PaneSide::kLeft) && document.paneSnapshot(PaneSide::kRight) &&
           document.paneSnapshotId(PaneSide::kLeft) != left && document.paneSnapshotId(PaneSide::kRight) != right;
  };
  const auto answered = [&] {
    return taken() || m_bench.snapshots().state() == session::SnapshotController::State::kIdle;
  };
  // An operator whose pair was refused presses again.
  for (int tries = 0; tries < 8 && !taken(); ++tries) {
    SimulatedHand::pump(400);
    m_hand.click(button);
    SimulatedHand::waitFor(answered, kPair_s);
  }
  if (!taken()) return failed(QStringLiteral("No pair was taken: %1").arg(m_window.strip()->message()));
  return {};
}

void SimulatedOperator::setTremble(double sigma_px, unsigned seed) {
  m_tremble_px = sigma_px;
  m_random.seed(seed);
}

// The tool's own copy is the last thing that is drawn: a marker per vertex.
Result<Eigen::Vector2d> SimulatedOperator::handle(PaneSide side, int vertex, int vertices) const {
  using vision::OverlayRole;
  std::vector<Eigen::Vector2d> markers;
  for (const auto& shape : m_bench.targeting().overlay(side).shapes) {
    const bool handle = shape.role == OverlayRole::kUnplaced || shape.role == OverlayRole::kActiveHandle ||
                        shape.role == OverlayRole::kHandle;
    if (shape.kind == vision::OverlayShape::Kind::kMarker && handle) markers.push_back(shape.points.front());
  }
  if (static_cast<int>(markers.size()) < vertices)
    return {ErrorCode::kNotFound, "The tool shows no handle " + std::to_string(vertex + 1) + "."};
  return markers[markers.size() - static_cast<std::size_t>(vertices - vertex)];
}

Status SimulatedOperator::dragHandle(PaneSide side, int vertex, int vertices, const Eigen::Vector2d& to,
                                     Qt::KeyboardModifiers keys) {
  auto* canvas = m_window.pictures()->pane(side)->canvas();
  const auto from = handle(side, vertex, vertices);
  if (!from) return from.error();
  const auto start = canvas->widgetOfPixel(*from), end = canvas->widgetOfPixel(to);
  if (!start || !end) return failed(QStringLiteral("A handle lies outside the picture shown."));
  m_hand.drag(canvas, *start, *end, keys);
  return {};
}

Status SimulatedOperator::mark(ActionId tool, const Points& points,
                               const std::function<Status(PaneSide)>& between, bool off_curve) {
  const auto now = look();
  if (!now) return now.error();
  if (const Status chosen = click(tool); !chosen) return chosen;
  const auto before = m_bench.document().items().size();
  for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
    const Qt::KeyboardModifiers keys = off_curve && side == PaneSide::kRight ? Qt::ControlModifier : Qt::NoModifier;
    for (std::size_t vertex = 0; vertex < points.size(); ++vertex) {
      auto to = see(side, *now, points[vertex]);
      if (!to) return to.error();
      std::normal_distribution<double> normal(0, 1);
      for (int axis = 0; axis < 2; ++axis) (*to)[axis] += m_tremble_px * normal(m_random);
      if (const Status dragged =
              dragHandle(side, static_cast<int>(vertex), static_cast<int>(points.size()), *to, keys);
          !dragged)
        return dragged;
    }
    if (!between) continue;
    if (const Status done = between(side); !done) return done;
  }
  if (m_bench.document().items().size() != before + 1)
    return failed(QStringLiteral("Nothing was marked: %1").arg(m_bench.targeting().hint()));
  const FeatureId id = m_bench.document().items().back().id;
  const auto& measured = m_bench.document().measurement(id);
  return measured.feature ? Status() : Status(ErrorCode::kNoSolution, measured.reason);
}

Status SimulatedOperator::plan(const QString& macro, double timeout_s) {
  auto* button = m_window.macros()->button(macro);
  if (button == nullptr) return failed(QStringLiteral("There is no button for %1.").arg(macro));
  if (!SimulatedHand::waitFor([button] { return button->isVisible() && button->isEnabled(); }, kAim_s)) {
    return failed(QStringLiteral("%1 is not offered: %2").arg(macro, button->toolTip()));
  }
  const auto before = m_bench.document().plan() ? m_bench.document().plan()->id : PlanId{};
  m_hand.click(button);
  const auto finished = [this, before] {
    return m_bench.document().plan() && m_bench.document().plan()->id != before;
  };
  if (!SimulatedHand::waitFor(finished, timeout_s))
    return failed(QStringLiteral("No plan: %1").arg(m_window.strip()->message()));
  const auto& plan = m_bench.document().plan()->plan;
  return plan.ok() ? Status() : Status(ErrorCode::kNoSolution, plan.macro + " was refused: " + plan.reason);
}

Status SimulatedOperator::resetStop() {
  const auto free = [this] { return !m_bench.robot().status().gate.stopped; };
  if (free() || m_hand.hold(m_window.stopPanel()->resetButton(), free, 5)) return {};
  return failed(QStringLiteral("STOP was not reset: %1").arg(m_window.strip()->message()));
}

Status SimulatedOperator::openGripper() {
  const auto& gripper = m_bench.robot().runtime()->workcell().gripper;
  if (!gripper) return failed(QStringLiteral("There is no gripper to open."));
  if (const Status clicked = click(ActionId::kGripperOpen); !clicked) return clicked;
  const double wide = gripper->closed + 0.9 * (gripper->open - gripper->closed);
  const auto opened = [this, &gripper, wide] {
    const double at = m_bench.robot().runtime()->gripperPosition();
    return gripper->open > gripper->closed ? at >= wide : at <= wide;
  };
  return SimulatedHand::waitFor(opened, kGrip_s) ? Status()
                                                 : failed(QStringLiteral("The gripper did not open."));
}

Status SimulatedOperator::click(ActionId action) {
  auto* button = buttonOf(&m_window, m_window.actions().at(action));
  if (button == nullptr)
    return failed(QStringLiteral("There is no button \"%1\".").arg(m_window.actions().at(action)->text()));
  m_hand.click(button);
  return {};
}

bool SimulatedOperator::keepPlaying() {
  using planning::PlayerState;
  auto* button = m_window.motion()->bar()->playButton();
  const auto player = m_bench.robot().status().player;
  if (player == PlayerState::kDone) return true;
  if (m_bench.play().state().playing || m_bench.plans().state() == session::PlanController::State::kPlanning)
    return false;
  if (m_bench.robot().status().gate.stopped) {
    (void)resetStop().ok();
  } else if (m_bench.play().state().stale) {
    (void)click(ActionId::kReplan).ok();
  } else if (button->isEnabled()) {
    m_hand.click(button);
  }
  return false;
}

}  // namespace longarm::ui
