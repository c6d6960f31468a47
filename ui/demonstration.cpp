#include "ui/demonstration.h"

#include <algorithm>
#include <utility>

#include <QDir>
#include <QToolButton>

#include "planning/world/scenario.h"

namespace longarm::ui {

using vision::PaneSide;

namespace {

constexpr double kPair_s = 15, kPlan_s = 30, kPlay_s = 180, kGrip_s = 15;
constexpr const char* kPipe = "pipe";
constexpr int kPause_ms = 60;

Status failed(const QString& sentence) { return {ErrorCode::kNoSolution, sentence.toStdString()}; }

}  // namespace

Demonstration::Demonstration(MainWindow& window, DemonstrationOptions options)
    : m_window(window),
      m_bench(window.bench()),
      m_options(std::move(options)),
      m_operator(window, kPause_ms) {}

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

// Where the pipe's ends are now.
Result<SimulatedOperator::Points> Demonstration::ends() const {
  const auto scenario = planning::loadScenario(m_options.scenario.toStdString());
  if (!scenario) return scenario.error();
  const auto* pipe = scenario->object(kPipe);
  const auto* shape = pipe != nullptr ? std::get_if<planning::Cylinder>(&pipe->body.shape) : nullptr;
  if (shape == nullptr) return {ErrorCode::kNotFound, "The scenario " + scenario->name + " has no pipe to grab."};
  const auto now = m_operator.look();
  if (!now) return now.error();
  const auto X_WO = now->objects.find(kPipe);
  if (X_WO == now->objects.end())
    return {ErrorCode::kNotFound, "The virtual robot does not say where the pipe is."};
  const Eigen::Vector3d half(0, 0, shape->length / 2);
  return SimulatedOperator::Points{X_WO->second * Eigen::Vector3d(-half), X_WO->second * half};
}

Status Demonstration::waitForLink() {
  if (const Status up = m_operator.waitForLink(m_options.link_timeout_s); !up) return up;
  return shoot("live");
}

Status Demonstration::aim() {
  return m_operator.aim([this] { return ends(); });
}

Status Demonstration::takePair() {
  if (const Status taken = m_operator.takePair(); !taken) return taken;
  return shoot("pair");
}

Status Demonstration::drawLine() {
  const auto there = ends();
  if (!there) return there.error();
  if (const Status shown = shoot("line-tool"); !shown) return shown;
  return m_operator.mark(ActionId::kToolLine, *there, [this](PaneSide side) {
    return shoot(side == PaneSide::kLeft ? "left-marked" : "both-marked");
  });
}

Status Demonstration::planGrab() {
  if (const Status planned = m_operator.plan(QStringLiteral("grab_pipe"), kPlan_s); !planned) return planned;
  const auto& plan = m_bench.document().plan()->plan;
  auto* bar = m_window.motion()->bar()->timeBar();
  const double y = bar->height() / 3.0;
  auto& hand = m_operator.hand();
  hand.drag(bar, {bar->xOf(0), y}, {bar->xOf(0.75 * plan.trajectory.duration()), y});
  if (const Status shown = shoot("preview"); !shown) return shown;
  hand.drag(bar, {bar->xOf(0.75 * plan.trajectory.duration()), y}, {bar->xOf(0), y});
  return {};
}

Status Demonstration::release() {
  if (const Status free = m_operator.resetStop(); !free) return free;
  return m_operator.openGripper();
}

Status Demonstration::play() {
  const double half = m_bench.document().plan()->plan.trajectory.duration() / 2;
  bool over = false;
  const auto midway = [&] {
    return (over = m_operator.keepPlaying()) || m_bench.play().state().cursor_s > half;
  };
  if (!SimulatedHand::waitFor(midway, kPlay_s)) return failed(QStringLiteral("The arm did not get half way: %1").arg(m_window.strip()->message()));
  if (const Status shown = shoot("playing"); !shown) return shown;
  if (!over && !SimulatedHand::waitFor([this] { return m_operator.keepPlaying(); }, kPlay_s)) {
    return failed(QStringLiteral("The motion did not end: %1").arg(m_window.strip()->message()));
  }
  return {};
}

Status Demonstration::grip() {
  if (const Status clicked = m_operator.click(ActionId::kGripperClose); !clicked) return clicked;
  if (!SimulatedHand::waitFor([this] { return m_bench.robot().runtime()->holding(); }, kGrip_s)) {
    return failed(QStringLiteral("The gripper closed on nothing."));
  }
  const auto now = m_operator.look();
  if (!now) return now.error();
  if (now->held != kPipe) return failed(QStringLiteral("The gripper holds \"%1\", not the pipe.").arg(QString::fromStdString(now->held)));
  (void)m_operator.click(ActionId::kSceneReset).ok();
  for (const auto side : {PaneSide::kLeft, PaneSide::kRight})
    m_operator.hand().click(m_window.pictures()->pane(side)->liveButton());
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
