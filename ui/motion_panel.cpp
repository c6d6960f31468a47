#include "ui/motion_panel.h"

#include <QVBoxLayout>

namespace longarm::ui {

namespace {

constexpr double kStep_s = 0.1;

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
  refreshStages();
}

void MotionPanel::bindBar() {
  auto& play = m_bench.play();
  connect(m_bar, &widgets::TransportBar::playWanted, &play, &session::PlayController::play);
  connect(m_bar, &widgets::TransportBar::backUpWanted, &play, &session::PlayController::backUp);
  connect(m_bar, &widgets::TransportBar::pauseWanted, &play, &session::PlayController::pause);
  connect(m_bar, &widgets::TransportBar::speedWanted, &play, &session::PlayController::setSpeed);
  connect(m_bar, &widgets::TransportBar::scrubWanted, &play, &session::PlayController::scrub);
  connect(m_bar, &widgets::TransportBar::toStartWanted, this, [&play] { play.scrub(0); });
  connect(m_bar, &widgets::TransportBar::toEndWanted, this, [&play] { play.scrub(play.state().duration_s); });
}

void MotionPanel::bindActions() {
  auto& play = m_bench.play();
  const auto on = [this](ActionId id, const std::function<void()>& act) {
    connect(m_actions.at(id), &QAction::triggered, this, [act] { act(); });
  };
  on(ActionId::kPlayPause, [&play] { play.state().playing ? play.pause() : play.play(); });
  on(ActionId::kBackUp, [&play] { play.backUp(); });
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
  const QString phase = state.playing ? tr("moving") : state.loaded ? tr("on the path") : tr("preview");
  return tr("%1 (%2), %3 s, clearance %4 mm")
      .arg(name, phase, QString::number(state.duration_s, 'f', 1), QString::number(record->plan.min_clearance * 1000, 'f', 0));
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
  shown.caption = caption();
  m_bar->setState(shown);

  m_actions.setWhyNot(ActionId::kPlayPause, state.playing ? QString() : state.why_not_play);
  m_actions.setWhyNot(ActionId::kBackUp, state.why_not_back_up);
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
    for (const auto& stage : record->plan.stages) stages.push_back({QString::fromStdString(stage.name), stage.start_s, stage.end_s});
  }
  m_bar->setStages(std::move(stages), duration_s);
  refresh();
}

}  // namespace longarm::ui
