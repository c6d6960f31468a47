#include "ui/status_strip.h"

#include <algorithm>

#include <QHBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QStyle>
#include <QToolButton>

#include "planning/world/workcell.h"
#include "ui/elided_label.h"

namespace longarm::ui {

using session::LinkState;
using widgets::StatusLamp;

namespace {

constexpr int kMessage_ms = 15000;
constexpr int kSaidKept = 8;

QToolButton* actionButton(QAction* action, QWidget* parent) {
  auto* button = new QToolButton(parent);
  button->setDefaultAction(action);
  button->setIconSize({18, 18});
  button->setFocusPolicy(Qt::TabFocus);
  return button;
}

StatusLamp::Level levelOf(const session::RuntimeStatus& status) {
  if (status.link == LinkState::kUp) return status.faults.empty() ? StatusLamp::Level::kOk : StatusLamp::Level::kDegraded;
  if (status.link == LinkState::kConnecting) return StatusLamp::Level::kBusy;
  return status.link == LinkState::kQuiet ? StatusLamp::Level::kDegraded : StatusLamp::Level::kLost;
}

}  // namespace

StatusStrip::StatusStrip(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent)
    : QFrame(parent), m_bench(bench), m_appearance(appearance) {
  setObjectName(QStringLiteral("strip"));
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(8, 3, 8, 3);
  row->setSpacing(12);
  m_mode = new QLabel(this);
  m_mode->setObjectName(QStringLiteral("badge"));
  m_mode->setProperty("level", QStringLiteral("selection"));
  row->addWidget(m_mode);
  m_link = new StatusLamp(this);
  m_restart = actionButton(actions.at(ActionId::kRestart), this);
  m_restart->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  m_owner = new StatusLamp(this);
  m_arm = new StatusLamp(this);
  m_video = new StatusLamp(this);
  m_arm->setReserve(QStringLiteral("arm slowing down"));
  m_video->setReserve(QStringLiteral("video 00.0 s"));
  row->addWidget(m_link);
  row->addWidget(m_restart);
  row->addWidget(m_owner);
  row->addWidget(m_arm);
  row->addWidget(m_video);
  m_cameras = new StatusLamp(this);
  m_cameras->setCursor(Qt::PointingHandCursor);
  connect(m_cameras, &StatusLamp::clicked, this, [this] { Q_EMIT healthWanted(m_bench.health().worstCamera()); });
  row->addWidget(m_cameras);
  m_message = new ElidedLabel(this);
  m_message->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
  m_message->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  row->addWidget(m_message, 1);
  m_planning = new QLabel(this);
  m_planning->setTextFormat(Qt::PlainText);
  m_progress = new QProgressBar(this);
  m_progress->setRange(0, 1000);
  m_progress->setFixedWidth(130);
  m_progress->setTextVisible(false);
  m_cancel = actionButton(actions.at(ActionId::kCancelPlanning), this);
  row->addWidget(m_planning);
  row->addWidget(m_progress);
  row->addWidget(m_cancel);

  m_forget.setSingleShot(true);
  connect(&m_forget, &QTimer::timeout, this, [this] { m_message->setFullText({}); });
  connect(&m_bench, &Workbench::said, this, &StatusStrip::showMessage);
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, [this] { showMode(); showLink(); showArm(); });
  connect(&m_bench.robot(), &RobotSession::polled, this, &StatusStrip::showArm);
  connect(&m_bench.robot(), &RobotSession::polledSlowly, this, &StatusStrip::showVideo);
  connect(&m_bench.health(), &session::HealthController::changed, this, &StatusStrip::showCameras);
  connect(&m_bench.plans(), &session::PlanController::stateChanged, this, &StatusStrip::showProgress);
  connect(&m_bench.plans(), &session::PlanController::progressChanged, this, &StatusStrip::showProgress);
  connect(&m_appearance, &Appearance::changed, this, &StatusStrip::applyTheme);
  applyTheme();
  showMode();
  showLink();
  showArm();
  showVideo();
  showCameras();
  showProgress();
}

QString StatusStrip::message() const { return m_message->fullText(); }

void StatusStrip::applyTheme() {
  for (auto* lamp : {m_link, m_owner, m_arm, m_video, m_cameras}) lamp->setTheme(m_appearance.theme());
}

void StatusStrip::showMode() {
  const auto mode = m_bench.robot().status().mode;
  m_mode->setText(QString::fromLatin1(session::toString(mode)));
  m_mode->setToolTip(mode == session::RobotMode::kVirtual
                         ? tr("VIRTUAL: a simulated robot; no driver of a real one exists in this program now")
                         : mode == session::RobotMode::kLive ? tr("LIVE: a real robot moves") : tr("REPLAY: a recording"));
}

void StatusStrip::showLink() {
  const auto& status = m_bench.robot().status();
  QStringList detail{QString::fromStdString(status.link_text)};
  for (const auto& fault : status.faults) detail.append(QString::fromStdString(fault));
  m_link->setStatus(levelOf(status), tr("link %1").arg(QString::fromLatin1(session::toString(status.link))),
                    detail.join(QLatin1Char('\n')));
  const bool trouble = status.link == LinkState::kLost || status.link == LinkState::kClosed || status.link == LinkState::kQuiet;
  m_restart->setVisible(trouble && !m_bench.robot().busy());
  if (!trouble && m_message->fullText() == m_link_trouble) m_message->setFullText({});
  m_link_trouble = trouble ? QString::fromStdString(status.link_text) : QString();
  showMessage(m_link_trouble);
}

void StatusStrip::showArm() {
  const auto& status = m_bench.robot().status();
  const bool up = m_bench.robot().linkUp();
  const QString owner = QString::fromStdString(status.gate.owner);
  m_owner->setStatus(owner.isEmpty() ? StatusLamp::Level::kOk : StatusLamp::Level::kBusy,
                     owner.isEmpty() ? tr("arm free") : tr("arm owned by %1").arg(owner),
                     tr("Who may move the arm now; one at a time"));
  if (!up) {
    m_arm->setStatus(StatusLamp::Level::kLost, tr("arm unknown"), tr("No fresh joint state"));
  } else if (status.gate.stopped) {
    m_arm->setStatus(StatusLamp::Level::kFault, status.stop_confirmed ? tr("STOPPED") : tr("STOPPING"),
                     tr("Stopped by %1: %2").arg(QString::fromStdString(status.gate.source),
                                                QString::fromStdString(status.gate.reason)));
  } else if (status.driving) {
    m_arm->setStatus(StatusLamp::Level::kBusy, tr("base driving"), tr("The base drives; the arm is held"));
  } else if (status.moving) {
    m_arm->setStatus(StatusLamp::Level::kBusy, tr("arm moving"), tr("Follows its path"));
  } else {
    m_arm->setStatus(StatusLamp::Level::kOk, tr("arm holds still"), tr("Ready to move"));
  }
}

void StatusStrip::showVideo() {
  std::optional<double> oldest;
  // While a calibration looks through cameras, the others are silent.
  const QStringList panes{m_bench.paneCamera(vision::PaneSide::kLeft), m_bench.paneCamera(vision::PaneSide::kRight)};
  for (const QString& camera : m_bench.live().watched().isEmpty() ? panes : m_bench.live().watched()) {
    const auto age = m_bench.live().age(camera);
    if (age) oldest = std::max(oldest.value_or(0), *age);
  }
  if (!oldest) {
    m_video->setStatus(StatusLamp::Level::kLost, tr("no video"), tr("No picture has come from the cameras that are looked through"));
    return;
  }
  const auto level = *oldest < 0.25 ? StatusLamp::Level::kOk : *oldest < 1 ? StatusLamp::Level::kDegraded : StatusLamp::Level::kLost;
  m_video->setStatus(level, tr("video %1 s").arg(QString::number(std::min(*oldest, 999.0), 'f', *oldest < 10 ? 1 : 0)),
                     tr("Age of the oldest of the live pictures that are looked at, from exposure"));
}

// By exception: nothing is said while no camera looks knocked.
void StatusStrip::showCameras() {
  using calibration::HealthLevel;
  const QString camera = m_bench.health().worstCamera();
  m_cameras->setVisible(!camera.isEmpty());
  if (camera.isEmpty()) return;
  const auto health = m_bench.health().of(camera.toStdString());
  const bool knocked = health.level == HealthLevel::kKnocked;
  m_cameras->setStatus(knocked ? StatusLamp::Level::kFault : StatusLamp::Level::kDegraded,
                       (knocked ? tr("%1 knocked? %2 px off") : tr("%1 doubtful, %2 px")).arg(camera, QString::number(health.off_px, 'f', 1)),
                       QString::fromStdString(health.why));
}

void StatusStrip::showProgress() {
  const bool planning = m_bench.plans().state() == session::PlanController::State::kPlanning;
  m_planning->setVisible(planning);
  m_progress->setVisible(planning);
  m_cancel->setVisible(planning);
  if (!planning) return;
  const QString what = m_bench.plans().progressText();
  m_planning->setText(what.isEmpty() ? tr("planning") : what);
  m_progress->setValue(static_cast<int>(m_bench.plans().progress() * 1000));
}

void StatusStrip::showMessage(const QString& sentence) {
  if (sentence.isEmpty()) return;
  if (m_said.isEmpty() || m_said.front() != sentence) m_said.prepend(sentence);
  while (m_said.size() > kSaidKept) m_said.removeLast();
  setToolTip(m_said.join(QLatin1Char('\n')).toHtmlEscaped().replace(QLatin1Char('\n'), QLatin1String("<br>")));
  m_message->setFullText(sentence);
  m_forget.start(kMessage_ms);
}

}  // namespace longarm::ui
