#include "ui/motion_panel.h"

#include <QApplication>
#include <QKeyEvent>
#include <QVBoxLayout>

#include "ui/stop_keys.h"

namespace longarm::ui {

namespace {

constexpr double kStep_s = 0.1;

using Key = widgets::TransportBar::Key;
using Order = session::PlayHand::Order;

Order orderOf(Key key) {
  switch (key) {
    case Key::kPlay:
      return Order::kPlay;
    case Key::kBackUp:
      return Order::kBackUp;
    case Key::kStage:
      return Order::kStage;
    case Key::kStageBack:
      return Order::kStageBack;
  }
  return Order::kPlay;
}

}  // namespace

MotionPanel::MotionPanel(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent)
    : QWidget(parent), m_bench(bench), m_actions(actions), m_bar(new widgets::TransportBar(this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(m_bar);
  const auto style = [this, &appearance] { m_bar->setTheme(appearance.theme()); };
  style();
  connect(&appearance, &Appearance::changed, this, style);
  bindBar();
  bindActions();
  connect(&m_bench.play(), &session::PlayController::changed, this, &MotionPanel::refresh);
  connect(&m_bench.targeting(), &session::TargetingController::planChanged, this, &MotionPanel::refreshStages);
  connect(&m_bench.hand(), &session::PlayHand::changed, this, &MotionPanel::refresh);
  connect(&m_bench, &Workbench::autoPlayChanged, this, &MotionPanel::refresh);
  qApp->installEventFilter(this);
  connect(qApp, &QGuiApplication::applicationStateChanged, this, [this](Qt::ApplicationState state) {
    if (state == Qt::ApplicationActive) return;
    m_key = 0;
    m_bench.hand().release();
  });
  refreshStages();
}

void MotionPanel::bindBar() {
  auto& play = m_bench.play();
  auto& hand = m_bench.hand();
  connect(m_bar, &widgets::TransportBar::pressed, &hand, [&hand](Key key) { hand.press(orderOf(key)); });
  connect(m_bar, &widgets::TransportBar::released, &hand, &session::PlayHand::release);
  connect(m_bar, &widgets::TransportBar::pauseWanted, &play, &session::PlayController::pause);
  connect(m_bar, &widgets::TransportBar::speedWanted, &play, &session::PlayController::setSpeed);
  connect(m_bar, &widgets::TransportBar::scrubWanted, &play, &session::PlayController::scrub);
  connect(m_bar, &widgets::TransportBar::toStartWanted, this, [&play] { play.scrub(0); });
  connect(m_bar, &widgets::TransportBar::toEndWanted, this, [&play] { play.scrub(play.state().duration_s); });
}

void MotionPanel::bindActions() {
  auto& play = m_bench.play();
  auto& hand = m_bench.hand();
  const auto on = [this](ActionId id, const std::function<void()>& act) {
    connect(m_actions.at(id), &QAction::triggered, this, [act] { act(); });
  };
  on(ActionId::kPlayPause,
     [&play, &hand] { play.state().playing ? play.pause() : hand.click(Order::kPlay); });
  on(ActionId::kBackUp, [&hand] { hand.click(Order::kBackUp); });
  on(ActionId::kStage, [&hand] { hand.click(Order::kStage); });
  on(ActionId::kStageBack, [&hand] { hand.click(Order::kStageBack); });
  on(ActionId::kStepBack, [&play] { play.scrub(play.state().cursor_s - kStep_s); });
  on(ActionId::kStepForward, [&play] { play.scrub(play.state().cursor_s + kStep_s); });
  on(ActionId::kToStart, [&play] { play.scrub(0); });
  on(ActionId::kToEnd, [&play] { play.scrub(play.state().duration_s); });
  on(ActionId::kSlower, [this] { m_bar->stepSpeed(-1); });
  on(ActionId::kFaster, [this] { m_bar->stepSpeed(1); });
}

QString MotionPanel::caption() const {
  const auto& record = m_bench.document().plan();
  const auto& state = m_bench.play().state();
  if (!record) return {};
  QString name = QString::fromStdString(record->macro);
  for (const auto& row : m_bench.plans().macros()) {
    if (row.name == name) name = row.title;
  }
  if (!state.has_plan) return tr("%1: refused").arg(name);
  const QString phase = !state.gripper.isEmpty() ? state.gripper : state.playing ? tr("moving") : state.loaded ? tr("on the path") : tr("preview");
  const auto& clearance = record->plan.clearance;
  const double least = clearance.empty() ? record->plan.min_clearance : planning::leastClearance(clearance).distance;
  return tr("%1 (%2), %3 s, clearance %4")
      .arg(name, phase, QString::number(state.duration_s, 'f', 1), widgets::clearanceText(least));
}

QString MotionPanel::badge() const {
  if (m_bench.hand().holdToRun()) return tr("HOLD TO RUN");
  if (!m_bench.hand().whyHold().isEmpty()) return tr("HOLD TO PLAY");
  return m_bench.autoPlay() ? tr("AUTO-PLAY") : QString();
}

bool MotionPanel::eventFilter(QObject* watched, QEvent* event) {
  const bool press = event->type() == QEvent::KeyPress;
  if (!press && event->type() != QEvent::KeyRelease && event->type() != QEvent::ShortcutOverride)
    return false;
  auto* key = static_cast<QKeyEvent*>(event);
  if (event->type() == QEvent::ShortcutOverride) {
    if (m_bench.hand().whyHold().isEmpty() || (key->key() != Qt::Key_P && key->key() != Qt::Key_B) ||
        takesText(qobject_cast<QWidget*>(watched)))
      return false;
    if ((key->modifiers() & ~Qt::ShiftModifier) != 0) return false;
    event->accept();
    return true;
  }
  return heldKey(watched, *key, press);
}

// @returns whether the key was one of ours.
bool MotionPanel::heldKey(const QObject* watched, const QKeyEvent& key, bool press) {
  if (m_key != 0 && key.key() == m_key) {
    if (!press && !key.isAutoRepeat()) {
      m_key = 0;
      m_bench.hand().release();
    }
    return true;
  }
  const bool ours = key.key() == Qt::Key_P || key.key() == Qt::Key_B;
  if (!press || !ours || (key.modifiers() & ~Qt::ShiftModifier) != 0 || m_bench.hand().whyHold().isEmpty())
    return false;
  if (takesText(qobject_cast<const QWidget*>(watched)) || key.isAutoRepeat()) return false;
  const bool stage = key.modifiers().testFlag(Qt::ShiftModifier);
  if (m_bench.play().state().playing && key.key() == Qt::Key_P && !stage) {
    m_bench.play().pause();
    return true;
  }
  m_key = key.key();
  m_bench.hand().press(m_key == Qt::Key_P ? (stage ? Order::kStage : Order::kPlay)
                                          : (stage ? Order::kStageBack : Order::kBackUp));
  return true;
}

void MotionPanel::refresh() {
  const auto& state = m_bench.play().state();
  widgets::TransportState shown;
  shown.loaded = state.has_plan;
  shown.playing = state.playing;
  shown.can_play = state.can_play;
  shown.can_back_up = state.can_back_up;
  shown.why_not = state.why_not_play;
  shown.why_not_back_up = state.why_not_back_up;
  shown.can_scrub = state.can_scrub;
  shown.cursor_s = state.cursor_s;
  shown.duration_s = state.duration_s;
  shown.speed = state.speed;
  shown.rate = state.rate;
  shown.why_not_stage = state.why_not_stage;
  shown.why_not_stage_back = state.why_not_stage_back;
  shown.only_held = state.only_held;
  shown.badge = badge();
  shown.caption = caption();
  m_bar->setState(shown);
  m_bar->setToolTip(m_bench.hand().whyHold());

  m_actions.setWhyNot(ActionId::kPlayPause, state.playing ? QString() : state.why_not_play);
  m_actions.setWhyNot(ActionId::kBackUp, state.why_not_back_up);
  m_actions.setWhyNot(ActionId::kStage, state.why_not_stage);
  m_actions.setWhyNot(ActionId::kStageBack, state.why_not_stage_back);
  const QString scrub = state.can_scrub ? QString()
                        : state.playing ? tr("The arm is moving: pause first.") : tr("There is no plan to look at.");
  for (const auto id : {ActionId::kStepBack, ActionId::kStepForward, ActionId::kToStart, ActionId::kToEnd}) m_actions.setWhyNot(id, scrub);
}

void MotionPanel::refreshStages() {
  std::vector<widgets::TimeStage> stages;
  double duration_s = 0;
  const auto& record = m_bench.document().plan();
  if (record && record->plan.ok()) {
    duration_s = record->plan.trajectory.duration();
    for (const auto& stage : record->plan.stages) {
      const QString then = !stage.gripper ? QString() : stage.gripper->grips ? tr("the gripper closes") : tr("the gripper opens");
      stages.push_back({QString::fromStdString(stage.name), stage.start_s, stage.end_s, then});
    }
  }
  m_bar->setStages(std::move(stages), duration_s);
  m_bar->setClearance(record && record->plan.ok() ? record->plan.clearance : planning::ClearanceProfile());
  refresh();
}

}  // namespace longarm::ui
