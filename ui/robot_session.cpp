#include "ui/robot_session.h"

#include <utility>

namespace longarm::ui {

using session::LinkState;

RobotSession::RobotSession(session::JobRunner& jobs, QObject* parent) : QObject(parent), m_jobs(jobs) {
  setStatus(LinkState::kClosed, tr("no robot yet"));
}

RobotSession::~RobotSession() = default;

void RobotSession::setStatus(LinkState link, const QString& text) {
  m_status = {};
  m_status.mode = m_options.mode;
  m_status.link = link;
  m_status.link_text = text.toStdString();
  Q_EMIT linkChanged();
  Q_EMIT stopChanged();
}

void RobotSession::giveUp(const QString& sentence) {
  setStatus(LinkState::kClosed, sentence);
  Q_EMIT noticed(sentence);
}

void RobotSession::start(std::shared_ptr<const planning::Workcell> workcell, const session::RuntimeOptions& options) {
  m_workcell = std::move(workcell);
  m_options = options;
  m_starting = true;
  setStatus(LinkState::kConnecting, options.mode == session::RobotMode::kVirtual ? tr("starting the virtual robot")
                                                                                 : tr("connecting to the robot"));
  using RuntimePtr = std::shared_ptr<session::RobotRuntime>;
  m_jobs.run<RuntimePtr>(
      this,
      [shared = m_workcell, options]() -> Result<RuntimePtr> {
        auto started = session::RobotRuntime::start(shared, options);
        if (!started) return started.error();
        return RuntimePtr(std::move(*started));
      },
      [this](Result<RuntimePtr> result) {
        m_starting = false;
        if (result) {
          attach(std::move(*result));
        } else {
          giveUp(QString::fromStdString(result.error().message));
        }
      });
}

void RobotSession::attach(std::shared_ptr<session::RobotRuntime> runtime) {
  m_runtime = std::move(runtime);
  m_feed = std::make_unique<session::RuntimeFeed>(*m_runtime);
  m_link = std::make_unique<session::RobotLink>(*m_runtime);
  const session::RobotLink* link = m_link.get();
  const auto follow = [this, link] { m_status = link->status(); };
  connect(link, &session::RobotLink::linkChanged, this, [this, follow] { follow(); Q_EMIT linkChanged(); });
  connect(link, &session::RobotLink::stopChanged, this, [this, follow] { follow(); Q_EMIT stopChanged(); });
  connect(link, &session::RobotLink::playerChanged, this, [this, follow] { follow(); Q_EMIT playerChanged(); });
  connect(link, &session::RobotLink::polled, this, [this, follow] {
    follow();
    Q_EMIT polled();
    if (++m_polls % 3 == 0) Q_EMIT polledSlowly();
  });
  connect(link, &session::RobotLink::jointStateChanged, this, &RobotSession::jointStateChanged);
  connect(link, &session::RobotLink::frameArrived, this, &RobotSession::frameArrived);
  connect(link, &session::RobotLink::noticed, this, &RobotSession::noticed);
  connect(link, &session::RobotLink::restarted, this, [this](bool ok, const QString& text) {
    m_restarting = false;
    Q_EMIT linkChanged();
    Q_EMIT noticed(ok ? tr("The robot was started anew. STOP is latched: hold Reset to let motion through.") : text);
  });
  Q_EMIT attached();
}

void RobotSession::restart() {
  if (busy()) return;
  if (m_link) {
    m_restarting = true;
    m_link->restart();
    Q_EMIT linkChanged();
  } else if (m_workcell) {
    start(m_workcell, m_options);
  }
}

QString RobotSession::whyNotReady() const {
  if (m_starting) return tr("The robot is being started.");
  if (m_restarting) return tr("The robot is being started anew.");
  if (!m_runtime) return tr("No robot is connected: %1").arg(QString::fromStdString(m_status.link_text));
  if (!linkUp()) {
    return tr("The link is %1: %2").arg(QString::fromLatin1(session::toString(m_status.link)),
                                        QString::fromStdString(m_status.link_text));
  }
  return {};
}

QString RobotSession::whyNotRestart() const {
  if (busy()) return tr("It is being started already.");
  if (!m_workcell) return tr("There is no workcell to start a robot from.");
  if (m_status.moving) return tr("The arm is moving: stop it first.");
  return {};
}

void RobotSession::stop(const char* source, const char* reason) {
  if (m_runtime) m_runtime->stop(source, reason);
}

void RobotSession::resetStop() {
  if (!m_runtime) return;
  const Status reset = m_runtime->resetStop();
  if (!reset) Q_EMIT noticed(QString::fromStdString(reset.error().message));
}

void RobotSession::setGripper(double position) {
  if (!m_runtime) return;
  const Status sent = m_runtime->setGripper(position);
  if (!sent) Q_EMIT noticed(QString::fromStdString(sent.error().message));
}

}  // namespace longarm::ui
