#include "widgets/transport_bar.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <QHBoxLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <QVariant>
#include <QVBoxLayout>

#include "widgets/icon.h"

namespace longarm::widgets {

namespace {

constexpr int kSteps = 20;                     // 10 % each

}  // namespace

TransportBar::TransportBar(QWidget* parent) : QWidget(parent) {
  auto* rows = new QVBoxLayout(this);
  rows->setContentsMargins(0, 0, 0, 0);
  rows->setSpacing(3);
  m_caption = new QLabel(this);
  m_caption->setTextFormat(Qt::PlainText);
  m_caption->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
  auto* head = new QHBoxLayout;
  m_badge = new QLabel(this);
  m_badge->setObjectName(QStringLiteral("badge"));
  m_badge->setProperty("level", QStringLiteral("amber"));
  head->addWidget(m_badge);
  head->addWidget(m_caption, 1);
  rows->addLayout(head);
  m_time = new TimeBar(this);
  rows->addWidget(m_time);
  auto* row = new QHBoxLayout;
  row->setSpacing(6);
  rows->addLayout(row);
  m_to_start = button(QStringLiteral("transport-to-start"), tr("To start"), tr("Show the start of the motion (Home). Moves nothing."));
  m_stage_back = moving(QStringLiteral("transport-stage-back"), {}, Key::kStageBack);
  m_back_up = moving(QStringLiteral("transport-back-up"), tr("Back up"), Key::kBackUp);
  m_pause = button(QStringLiteral("transport-pause"), tr("Pause"), tr("Slow down along the path and hold (P)"));
  m_play = moving(QStringLiteral("transport-play"), tr("Play"), Key::kPlay);
  m_stage = moving(QStringLiteral("transport-stage"), {}, Key::kStage);
  m_to_end = button(QStringLiteral("transport-to-end"), tr("To end"), tr("Show the end of the motion (End). Moves nothing."));
  for (auto* each : {m_to_start, m_stage_back, m_back_up, m_pause, m_play, m_stage, m_to_end})
    row->addWidget(each);
  row->addSpacing(8);
  auto* label = new QLabel(tr("Speed"), this);
  row->addWidget(label);
  m_speed = new QSlider(Qt::Horizontal, this);
  m_speed->setRange(-kSteps, kSteps);
  m_speed->setPageStep(5);
  m_speed->setTickInterval(10);
  m_speed->setTickPosition(QSlider::TicksBelow);
  m_speed->setMinimumSize(130, 26);
  m_speed->setFocusPolicy(Qt::ClickFocus);
  m_speed->setToolTip(tr("Speed and direction, -2x to 2x, in steps of 10 % (keys - and +); negative backs up"));
  row->addWidget(m_speed, 1);
  m_speed_text = new QLabel(this);
  m_speed_text->setMinimumWidth(fontMetrics().horizontalAdvance(QStringLiteral("-2.0x  now -2.00x ")));
  row->addWidget(m_speed_text);

  connect(m_to_start, &QToolButton::clicked, this, &TransportBar::toStartWanted);
  connect(m_pause, &QToolButton::clicked, this, &TransportBar::pauseWanted);
  connect(m_to_end, &QToolButton::clicked, this, &TransportBar::toEndWanted);
  connect(m_time, &TimeBar::scrubbed, this, &TransportBar::scrubWanted);
  connect(m_speed, &QSlider::valueChanged, this, [this](int value) { Q_EMIT speedWanted(value / 10.0); });
  refreshIcons();
  setState({});
}

QToolButton* TransportBar::button(const QString& action, const QString& text, const QString& tip) {
  auto* result = new QToolButton(this);
  result->setProperty("action_icon", action);
  result->setText(text);
  result->setToolTip(tip);
  result->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  result->setIconSize({22, 22});
  result->setMinimumSize(44, 40);
  result->setFocusPolicy(Qt::TabFocus);
  return result;
}

QToolButton* TransportBar::moving(const QString& action, const QString& text, Key key) {
  auto* result = button(action, text, {});
  if (text.isEmpty()) result->setToolButtonStyle(Qt::ToolButtonIconOnly);
  connect(result, &QToolButton::pressed, this, [this, key] { Q_EMIT pressed(key); });
  connect(result, &QToolButton::released, this, &TransportBar::released);
  return result;
}

QToolButton* TransportBar::keyButton(Key key) const {
  switch (key) {
    case Key::kPlay:
      return m_play;
    case Key::kBackUp:
      return m_back_up;
    case Key::kStage:
      return m_stage;
    case Key::kStageBack:
      return m_stage_back;
  }
  return nullptr;
}

void TransportBar::refreshIcons() {
  for (auto* each : {m_to_start, m_stage_back, m_back_up, m_pause, m_play, m_stage, m_to_end}) {
    each->setIcon(icon(each->property("action_icon").toString(), m_theme));
  }
}

void TransportBar::setTheme(const Theme& theme) {
  m_theme = theme;
  m_time->setTheme(theme);
  refreshIcons();
}

void TransportBar::setStages(std::vector<TimeStage> stages, double duration_s) {
  m_time->setStages(std::move(stages), duration_s);
}

void TransportBar::setClearance(planning::ClearanceProfile clearance) { m_time->setClearance(std::move(clearance)); }

void TransportBar::showSpeed(double speed) {
  const QSignalBlocker quiet(m_speed);
  if (!m_speed->isSliderDown()) m_speed->setValue(static_cast<int>(std::lround(speed * 10)));
  QString text = tr("%1x").arg(QString::number(speed, 'f', 1));
  if (m_state.playing || std::abs(m_state.rate) > 1e-3) text += tr("  now %1x").arg(QString::number(m_state.rate, 'f', 2));
  m_speed_text->setText(text);
}

void TransportBar::setState(const TransportState& state) {
  m_state = state;
  // A button that was greyed under the finger would let go of the motion.
  const bool forwards = state.playing && !state.only_held && state.speed > 0,
             back = state.playing && !state.only_held && state.speed < 0;
  m_play->setEnabled((state.can_play || (m_play->isDown() && state.playing)) && !forwards);
  m_back_up->setEnabled((state.can_back_up || (m_back_up->isDown() && state.playing)) && !back);
  m_stage->setEnabled(state.why_not_stage.isEmpty() || (m_stage->isDown() && state.playing));
  m_stage_back->setEnabled(state.why_not_stage_back.isEmpty() || (m_stage_back->isDown() && state.playing));
  m_stage->setToolTip(state.why_not_stage.isEmpty()
                          ? tr("Move the robot to the end of this stage and rest there (Shift+P)")
                          : state.why_not_stage.toHtmlEscaped());
  m_stage_back->setToolTip(state.why_not_stage_back.isEmpty()
                               ? tr("Move the robot back to the start of this stage and rest there (Shift+B)")
                               : state.why_not_stage_back.toHtmlEscaped());
  m_badge->setText(state.badge);
  m_badge->setVisible(!state.badge.isEmpty());
  m_pause->setEnabled(state.playing);
  m_to_start->setEnabled(state.loaded && state.can_scrub);
  m_to_end->setEnabled(state.loaded && state.can_scrub);
  const QString why = state.why_not.toHtmlEscaped();
  m_play->setToolTip(state.can_play ? tr("Move the robot along the path (P)") : why);
  m_back_up->setToolTip(state.can_back_up ? tr("Move the robot back along its path (B)") : state.why_not_back_up.toHtmlEscaped());
  m_time->setScrubbable(state.can_scrub);
  m_time->setCursorTime(state.cursor_s);
  m_caption->setText(state.can_play || state.why_not.isEmpty() ? state.caption
                     : state.caption.isEmpty()                 ? state.why_not
                                                               : tr("%1. Cannot play: %2").arg(state.caption, state.why_not));
  m_caption->setToolTip(m_caption->text().toHtmlEscaped());
  showSpeed(state.speed);
}

void TransportBar::stepSpeed(int steps) {
  const int now = static_cast<int>(std::lround(m_state.speed * 10));
  Q_EMIT speedWanted(std::clamp(now + steps, -kSteps, kSteps) / 10.0);
}

}  // namespace longarm::widgets
