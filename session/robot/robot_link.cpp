#include "session/robot/robot_link.h"

namespace longarm::session {
namespace {

constexpr int kPoll_ms = 33;

bool sameLink(const RuntimeStatus& a, const RuntimeStatus& b) {
  return a.link == b.link && a.link_text == b.link_text && a.faults == b.faults;
}

bool samePlayer(const RuntimeStatus& a, const RuntimeStatus& b) {
  return a.player == b.player && a.cursor == b.cursor && a.rate == b.rate && a.speed == b.speed &&
         a.duration == b.duration;
}

bool sameStop(const RuntimeStatus& a, const RuntimeStatus& b) {
  return a.gate.stopped == b.gate.stopped && a.stop_confirmed == b.stop_confirmed &&
         a.gate.reason == b.gate.reason;
}

}  // namespace

RobotLink::RobotLink(RobotRuntime& runtime, QObject* parent) : QObject(parent), m_runtime(runtime) {
  m_timer.setTimerType(Qt::PreciseTimer);
  connect(&m_timer, &QTimer::timeout, this, &RobotLink::poll);
  m_timer.start(kPoll_ms);
}

RobotLink::~RobotLink() {
  if (m_restart.joinable()) m_restart.join();
}

void RobotLink::poll() {
  m_runtime.touchGui();
  const RuntimeStatus before = m_status;
  m_status = m_runtime.status();
  if (!sameLink(before, m_status)) Q_EMIT linkChanged();
  if (!sameStop(before, m_status)) Q_EMIT stopChanged();
  if (!samePlayer(before, m_status)) Q_EMIT playerChanged();
  if (const auto joints = m_runtime.jointState(); joints != m_joints) {
    m_joints = joints;
    Q_EMIT jointStateChanged();
  }
  pollFrames();
  if (before.notice != m_status.notice && !m_status.notice.empty()) {
    Q_EMIT noticed(QString::fromStdString(m_status.notice));
  }
  Q_EMIT polled();
}

void RobotLink::pollFrames() {
  for (const auto& camera : m_runtime.workcell().cameras) {
    const auto frame = m_runtime.cameraFrame(camera.name);
    if (!frame) continue;
    auto& seen = m_frames[camera.name];
    if (seen == frame->sequence + 1) continue;
    seen = frame->sequence + 1;
    Q_EMIT frameArrived(QString::fromStdString(camera.name));
  }
}

void RobotLink::restart() {
  if (m_restarting) return;
  if (m_restart.joinable()) m_restart.join();
  m_restarting = true;
  m_restart = std::thread([this] {
    const auto status = m_runtime.restart();
    const QString text = status ? QString() : QString::fromStdString(status.error().message);
    QMetaObject::invokeMethod(
        this,
        [this, ok = status.ok(), text] {
          m_restarting = false;
          Q_EMIT restarted(ok, text);
        },
        Qt::QueuedConnection);
  });
}

}  // namespace longarm::session
