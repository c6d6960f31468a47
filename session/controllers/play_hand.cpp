#include "session/controllers/play_hand.h"

namespace longarm::session {

namespace {

constexpr int kRepeat_ms = 50;  // the motion thread waits 250 ms for the next

}  // namespace

PlayHand::PlayHand(PlayController& play, QObject* parent) : QObject(parent), m_play(play) {
  m_timer.setInterval(kRepeat_ms);
  m_timer.setTimerType(Qt::PreciseTimer);
  connect(&m_timer, &QTimer::timeout, this, &PlayHand::tick);
}

void PlayHand::setHoldToRun(bool on) {
  if (holdToRun() == on) return;
  release();
  m_play.setOnlyHeld(on);
  Q_EMIT changed();
}

QString PlayHand::whyHold() const {
  if (holdToRun()) return tr("Hold to run is on: the arm moves only while Play is held.");
  if (m_live)
    return tr("On a live robot hold Play for %1 s.").arg(QString::number(kConfirm_ms / 1000.0, 'f', 1));
  return {};
}

void PlayHand::press(Order order) {
  if (m_held) return;
  m_held = order;
  m_acted = false;
  m_since.start();
  m_timer.start();
  if (holdToRun() || !m_live) act();  // which may grey the button, and so let go of it
  Q_EMIT changed();
}

void PlayHand::release() {
  if (!m_held) return;
  m_timer.stop();
  m_held.reset();
  if (!m_acted)
    Q_EMIT said(whyHold());
  else if (holdToRun())
    m_play.pause();
  Q_EMIT changed();
}

void PlayHand::click(Order order) {
  if (const QString why = whyHold(); !why.isEmpty()) {
    Q_EMIT said(why);
    return;
  }
  press(order);
  release();
}

void PlayHand::tick() {
  if (!m_acted && m_since.elapsed() >= kConfirm_ms) act();
  if (m_acted && holdToRun()) m_play.keepRunning();
}

void PlayHand::act() {
  m_acted = true;
  switch (*m_held) {
    case Order::kPlay:
      return m_play.play();
    case Order::kBackUp:
      return m_play.backUp();
    case Order::kStage:
      return m_play.playStage();
    case Order::kStageBack:
      return m_play.backUpStage();
  }
}

}  // namespace longarm::session
