#include "session/controllers/dead_man_switch.h"

#include <utility>

namespace longarm::session {

namespace {

constexpr int kRepeat_ms = 50;         // a command lives for 200 ms

}  // namespace

DeadManSwitch::DeadManSwitch(QObject* parent) : QObject(parent) {
  m_timer.setInterval(kRepeat_ms);
  m_timer.setTimerType(Qt::PreciseTimer);
  connect(&m_timer, &QTimer::timeout, this, &DeadManSwitch::tick);
}

void DeadManSwitch::setRelease(Release release) {
  letGo();
  m_release = std::move(release);
}

void DeadManSwitch::repeat() {
  m_timer.start();
  Q_EMIT changed();
  tick();
}

void DeadManSwitch::letGo() {
  m_timer.stop();
  if (!held()) return;
  forget();
  if (m_release) m_release();
  Q_EMIT changed();
}

void DeadManSwitch::tick() {
  if (!held()) return;
  const Status sent = send();
  if (sent) return;
  letGo();
  Q_EMIT refused(QString::fromStdString(sent.error().message));
}

}  // namespace longarm::session
