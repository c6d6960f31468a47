#include "ui/drive_panel.h"

#include <cmath>

#include <QComboBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/elided_label.h"

namespace longarm::ui {

namespace {

using Way = DrivePanel::Way;

std::optional<Way> wayOf(int key) {
  switch (key) {
    case Qt::Key_Up:
      return Way::kForward;
    case Qt::Key_Down:
      return Way::kBack;
    case Qt::Key_Left:
      return Way::kTurnLeft;
    case Qt::Key_Right:
      return Way::kTurnRight;
    case Qt::Key_Home:
      return Way::kLeft;
    case Qt::Key_End:
      return Way::kRight;
    default:
      return {};
  }
}

}  // namespace

DrivePanel::DrivePanel(Workbench& bench, QWidget* parent) : HoldPanel(bench, bench.drive(), parent) {
  m_row->addWidget(makeChoices(), 1);
  m_row->addWidget(makePad());
  connect(&m_bench.robot(), &RobotSession::attached, this, &DrivePanel::fillCameras);
  fillCameras();
}

QWidget* DrivePanel::makePad() {
  auto* pad = new QWidget(this);
  auto* grid = new QGridLayout(pad);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setSpacing(4);
  const struct {
    Way way;
    const char *text, *tip;
    int row, column;
  } places[] = {{Way::kTurnLeft, "\u21ba", QT_TR_NOOP("Turn to the left while held (arrow left)"), 0, 0},
                {Way::kForward, "\u2191", QT_TR_NOOP("Drive forwards while held (arrow up)"), 0, 1},
                {Way::kTurnRight, "\u21bb", QT_TR_NOOP("Turn to the right while held (arrow right)"), 0, 2},
                {Way::kLeft, "\u2190", QT_TR_NOOP("Move to the left while held (Home)"), 1, 0},
                {Way::kBack, "\u2193", QT_TR_NOOP("Drive backwards while held (arrow down)"), 1, 1},
                {Way::kRight, "\u2192", QT_TR_NOOP("Move to the right while held (End)"), 1, 2}};
  for (const auto& place : places) {
    auto* made = new QToolButton(pad);
    made->setText(QString::fromUtf8(place.text));
    made->setMinimumSize(52, 34);
    made->setFocusPolicy(Qt::TabFocus);
    made->setProperty("holds", true);
    made->setProperty("does", tr(place.tip));
    connect(made, &QToolButton::pressed, this, [this, way = place.way] { m_bench.drive().hold(way); });
    connect(made, &QToolButton::released, this, [this, way = place.way] { m_bench.drive().release(way); });
    grid->addWidget(made, place.row, place.column);
    m_buttons[place.way] = made;
  }
  return pad;
}

QWidget* DrivePanel::makeChoices() {
  auto* box = new QWidget(this);
  auto* column = new QVBoxLayout(box);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(4);
  auto* camera = new QHBoxLayout;
  camera->addWidget(new QLabel(tr("See by"), box));
  m_cameras = new QComboBox(box);
  m_cameras->setToolTip(tr("Shown live in the left pane while you drive"));
  camera->addWidget(m_cameras, 1);
  column->addLayout(camera);
  connect(m_cameras, qOverload<int>(&QComboBox::activated), this,
          [this](int) { Q_EMIT cameraWanted(m_cameras->currentData().toString()); });
  auto* speed = new QHBoxLayout;
  m_speed = new QSlider(Qt::Horizontal, box);
  m_speed->setRange(5, 100);
  m_speed->setToolTip(tr("Speed, up to the cap of the workcell"));
  m_speed_text = new QLabel(box);
  m_speed_text->setMinimumWidth(m_speed_text->fontMetrics().horizontalAdvance(QStringLiteral("0.30 m/s")));
  speed->addWidget(m_speed, 1);
  speed->addWidget(m_speed_text);
  column->addLayout(speed);
  connect(m_speed, &QSlider::valueChanged, this, [this](int value) {
    m_bench.drive().setSpeed(value / 100.0);
    refresh();
  });
  m_odometry = new QLabel(box);
  m_odometry->setTextFormat(Qt::PlainText);
  m_odometry->setToolTip(tr("Where the robot's own odometry says it is, from where it started"));
  column->addWidget(m_odometry);
  column->addStretch(1);
  m_speed->setValue(30);
  return box;
}

void DrivePanel::fillCameras() {
  m_cameras->clear();
  const auto& workcell = m_bench.document().workcell();
  if (workcell) {
    for (const char* role : {"drive", "reverse"}) {
      for (const auto& camera : workcell->cameras) {
        if (camera.role == role)
          m_cameras->addItem(QString::fromStdString(camera.name), QString::fromStdString(camera.name));
      }
    }
  }
  m_cameras->setEnabled(m_cameras->count() > 0);
  m_bench.drive().setSpeed(m_speed->value() / 100.0);
  refresh();
}

QString DrivePanel::odometry() const {
  const auto& base = m_bench.robot().status().base;
  if (!base) return tr("no odometry");
  return tr("x %1 m, y %2 m, heading %3\u00b0; %4 m/s")
      .arg(QString::number(base->x, 'f', 2), QString::number(base->y, 'f', 2),
           QString::number(std::remainder(base->yaw, 2 * M_PI) * 180 / M_PI, 'f', 1),
           QString::number(std::hypot(base->twist.forward, base->twist.left), 'f', 2));
}

void DrivePanel::refresh() {
  const QString why = m_bench.whyNotDrive();
  const auto& workcell = m_bench.document().workcell();
  const bool sideways = workcell && workcell->base && workcell->base->sideways;
  for (const auto& [way, button] : m_buttons) {
    const bool side = way == Way::kLeft || way == Way::kRight;
    const QString reason = side && !sideways && why.isEmpty() ? tr("This base cannot move sideways.") : why;
    button->setEnabled(reason.isEmpty());
    button->setToolTip(reason.isEmpty() ? button->property("does").toString() : reason);
  }
  const double cap = workcell && workcell->base ? workcell->base->max_speed : 0;
  m_speed_text->setText(tr("%1 m/s").arg(QString::number(m_bench.drive().speed() * cap, 'f', 2)));
  m_odometry->setText(odometry());
  const auto& status = m_bench.robot().status();
  m_state->setFullText(
      !why.isEmpty()         ? why
      : !m_refusal.isEmpty() ? m_refusal
      : status.driving       ? tr("driving; the arm is held")
      : !status.drive_notice.empty()
          ? QString::fromStdString(status.drive_notice)
          : tr("Hold a button, or an arrow key here. The arm is held while the base moves."));
}

void DrivePanel::keyPressEvent(QKeyEvent* event) {
  const auto way = wayOf(event->key());
  if (!way) return QWidget::keyPressEvent(event);
  if (event->isAutoRepeat() || m_keys.count(event->key()) != 0) return;
  if (!m_buttons.at(*way)->isEnabled()) return;
  m_keys[event->key()] = *way;
  m_bench.drive().hold(*way);
}

void DrivePanel::keyReleaseEvent(QKeyEvent* event) {
  const auto held = m_keys.find(event->key());
  if (event->isAutoRepeat() || held == m_keys.end()) return QWidget::keyReleaseEvent(event);
  const Way way = held->second;
  m_keys.erase(held);
  m_bench.drive().release(way);
}

}  // namespace longarm::ui
