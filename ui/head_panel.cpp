#include "ui/head_panel.h"

#include <QCheckBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QToolButton>
#include <QVBoxLayout>

#include "planning/world/workcell.h"

namespace longarm::ui {

namespace {

constexpr double kDegPerRad = 57.29577951308232;

QToolButton* wideButton(QAction* action, QWidget* parent) {
  auto* button = new QToolButton(parent);
  button->setDefaultAction(action);
  button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  button->setIconSize({20, 20});
  button->setMinimumHeight(32);
  button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  button->setFocusPolicy(Qt::TabFocus);
  return button;
}

}  // namespace

HeadPanel::HeadPanel(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent)
    : QWidget(parent), m_bench(bench), m_actions(actions) {
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(6, 6, 6, 6);
  row->setSpacing(10);
  auto* left = new QVBoxLayout;
  m_stick = new widgets::AimStick(this);
  left->addWidget(m_stick, 1, Qt::AlignCenter);
  auto* angles = new QHBoxLayout;
  angles->setSpacing(4);
  m_pan = new widgets::ValueLabel(QStringLiteral("\u00b0"), 1, 180, this);
  m_tilt = new widgets::ValueLabel(QStringLiteral("\u00b0"), 1, 180, this);
  angles->addWidget(new QLabel(tr("pan"), this));
  angles->addWidget(m_pan);
  angles->addSpacing(6);
  angles->addWidget(new QLabel(tr("tilt"), this));
  angles->addWidget(m_tilt);
  left->addLayout(angles);
  m_head = new QLabel(this);
  m_head->setAlignment(Qt::AlignCenter);
  m_head->setToolTip(tr("The head that the stick turns: that of the pane clicked last."));
  left->addWidget(m_head);
  row->addLayout(left);
  auto* right = new QVBoxLayout;
  right->setSpacing(5);
  right->addWidget(wideButton(actions.at(ActionId::kTakePair), this));
  right->addWidget(wideButton(actions.at(ActionId::kGripperOpen), this));
  right->addWidget(wideButton(actions.at(ActionId::kGripperClose), this));
  m_gripper = new QLabel(this);
  m_gripper->setWordWrap(true);
  right->addWidget(m_gripper);
  m_watch = new QCheckBox(tr("Watch the tool"), this);
  m_watch->setChecked(bench.watch().on());
  m_watch->setFocusPolicy(Qt::TabFocus);
  m_watch->setToolTip(tr("While the arm moves the heads turn and zoom to keep the tool and its target in the picture. "
                         "A head that you aim is left alone for 5 s."));
  right->addWidget(m_watch);
  right->addStretch(1);
  row->addLayout(right, 1);
  const auto style = [this, &appearance] { m_stick->setTheme(appearance.theme()); };
  style();
  connect(&appearance, &Appearance::changed, this, style);
  connect(m_stick, &widgets::AimStick::deflected, &m_bench.aim(), &session::AimController::setStick);
  connect(m_actions.at(ActionId::kTakePair), &QAction::triggered, &m_bench, &Workbench::takePair);
  connect(m_watch, &QCheckBox::toggled, &m_bench.watch(), &session::WatchController::setOn);
  connect(m_actions.at(ActionId::kFrameThis), &QAction::triggered, &m_bench, &Workbench::frameSelection);
  bindGripper();
  connect(&m_bench.robot(), &RobotSession::polledSlowly, this, &HeadPanel::refresh);
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, &HeadPanel::refresh);
  connect(&m_bench, &Workbench::paneCameraChanged, this, &HeadPanel::refresh);
  connect(&m_bench.snapshots(), &session::SnapshotController::stateChanged, this, &HeadPanel::refresh);
  refresh();
}

void HeadPanel::bindGripper() {
  const auto move = [this](bool open) {
    const auto& workcell = m_bench.document().workcell();
    if (!workcell || !workcell->gripper) return;
    m_bench.robot().setGripper(open ? workcell->gripper->open : workcell->gripper->closed);
  };
  connect(m_actions.at(ActionId::kGripperOpen), &QAction::triggered, this, [move] { move(true); });
  connect(m_actions.at(ActionId::kGripperClose), &QAction::triggered, this, [move] { move(false); });
}

void HeadPanel::refresh() {
  const QString aim = m_bench.aim().whyNot();
  m_stick->setEnabled(aim.isEmpty() && m_bench.robot().linkUp());
  m_stick->setToolTip(aim.isEmpty() ? tr("Turns the cameras while it is held. Arrow keys in a live pane do the same.") : aim);
  auto* runtime = m_bench.robot().runtime();
  std::optional<double> pan, tilt;
  if (runtime != nullptr && m_bench.robot().linkUp()) {
    const auto angles = runtime->panTilt(m_bench.aim().panTilt().toStdString());
    if (angles) {
      pan = angles->pan * kDegPerRad;
      tilt = angles->tilt * kDegPerRad;
    }
  }
  m_pan->setValue(pan);
  m_tilt->setValue(tilt);
  m_actions.setWhyNot(ActionId::kTakePair, m_bench.whyNotTakePair());

  const auto& workcell = m_bench.document().workcell();
  m_head->setVisible(workcell && workcell->pan_tilts.size() > 1);
  m_watch->setEnabled(workcell && !workcell->pan_tilts.empty());
  m_actions.setWhyNot(ActionId::kFrameThis, m_bench.robot().whyNotReady());
  m_head->setText(m_bench.aim().panTilt());
  QString why = m_bench.robot().whyNotReady();
  if (why.isEmpty() && (!workcell || !workcell->gripper)) why = tr("The workcell has no gripper.");
  m_actions.setWhyNot(ActionId::kGripperOpen, why);
  m_actions.setWhyNot(ActionId::kGripperClose, why);
  if (!why.isEmpty()) {
    m_gripper->setText(tr("gripper unknown"));
  } else {
    const QString opening = QString::number(1000 * runtime->gripperPosition(), 'f', 0);
    const auto& held = m_bench.held().held();
    const QString what = held ? tr("HOLDING %1, at %2 mm").arg(QString::fromStdString(held->body.name)) : tr("HOLDING, at %1 mm");
    m_gripper->setText(runtime->holding() ? what.arg(opening) : tr("finger at %1 mm").arg(opening));
  }
}

}  // namespace longarm::ui
