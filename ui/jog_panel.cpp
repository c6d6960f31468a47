#include "ui/jog_panel.h"

#include <array>

#include <QButtonGroup>
#include <QCheckBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/elided_label.h"

namespace longarm::ui {

using planning::JogFrame;

namespace {

struct AxisNames {
  const char *name, *minus, *plus;
};
using SixAxes = std::array<AxisNames, 6>;

// The ways as the operator sees them; x, y, z of frames.md behind them.
const SixAxes& axesOf(JogFrame frame) {
  static const SixAxes base{{{"x", "back", "forward"}, {"y", "right", "left"}, {"z", "down", "up"},
                             {"roll", "left", "right"}, {"pitch", "up", "down"}, {"yaw", "right", "left"}}};
  static const SixAxes tool{{{"x", "-", "+"}, {"y", "-", "+"}, {"z", "retract", "reach"},
                             {"about x", "-", "+"}, {"about y", "-", "+"}, {"about z", "-", "+"}}};
  static const SixAxes camera{{{"across", "left", "right"}, {"height", "up", "down"}, {"depth", "nearer", "farther"},
                               {"pitch", "-", "+"}, {"yaw", "-", "+"}, {"roll", "-", "+"}}};
  if (frame == JogFrame::kTool) return tool;
  return frame == JogFrame::kCamera ? camera : base;
}

struct KeyWay {
  int axis, way;
};

// What a key means: right, up and away from the operator.
std::optional<KeyWay> wayOf(int key, JogFrame frame) {
  const int across = frame == JogFrame::kBase ? 1 : 0, ahead = frame == JogFrame::kBase ? 0 : 2;
  const int height = frame == JogFrame::kBase ? 2 : 1;
  const int right = frame == JogFrame::kBase ? -1 : 1, up = frame == JogFrame::kCamera ? -1 : 1;
  switch (key) {
    case Qt::Key_Left: return KeyWay{across, -right};
    case Qt::Key_Right: return KeyWay{across, right};
    case Qt::Key_Up: return KeyWay{ahead, 1};
    case Qt::Key_Down: return KeyWay{ahead, -1};
    case Qt::Key_PageUp: return KeyWay{height, up};
    case Qt::Key_PageDown: return KeyWay{height, -up};
    default: return {};
  }
}

}  // namespace

JogPanel::JogPanel(Workbench& bench, QWidget* parent) : HoldPanel(bench, bench.jog(), parent) {
  m_row->addWidget(makeChoices());
  m_axes = new QWidget(this);
  m_grid = new QGridLayout(m_axes);
  m_grid->setContentsMargins(0, 0, 0, 0);
  m_grid->setSpacing(4);
  m_row->addWidget(m_axes, 1);
  connect(&m_bench.robot(), &RobotSession::attached, this, &JogPanel::fillAxes);
  setFrame(JogFrame::kBase);
}

QWidget* JogPanel::makeChoices() {
  auto* box = new QWidget(this);
  auto* column = new QVBoxLayout(box);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(4);
  auto* frames = new QGridLayout;
  frames->setSpacing(4);
  m_frames = new QButtonGroup(this);
  const std::pair<JogFrame, std::pair<QString, QString>> choices[] = {
      {JogFrame::kJoint, {tr("Joints"), tr("One joint at a time")}},
      {JogFrame::kTool, {tr("Tool"), tr("Along and about the tool's own axes")}},
      {JogFrame::kBase, {tr("Base"), tr("Along and about the robot's forward, left and up")}},
      {JogFrame::kCamera, {tr("Camera"), tr("As the left pane's camera sees it: right, down and away in the picture")}}};
  int at = 0;
  for (const auto& [frame, words] : choices) {
    auto* button = new QToolButton(this);
    button->setText(words.first);
    button->setToolTip(words.second);
    button->setCheckable(true);
    button->setMinimumSize(76, 28);
    button->setFocusPolicy(Qt::TabFocus);
    m_frames->addButton(button, static_cast<int>(frame));
    frames->addWidget(button, at / 2, at % 2);
    ++at;
  }
  column->addLayout(frames);
  connect(m_frames, &QButtonGroup::idClicked, this, [this](int id) { setFrame(static_cast<JogFrame>(id)); });
  auto* speed = new QHBoxLayout;
  m_speed = new QSlider(Qt::Horizontal, this);
  m_speed->setRange(2, 100);
  m_speed->setValue(30);
  m_speed->setToolTip(tr("Speed of the jog; near obstacles, limits and stretched poses the arm slows down by itself"));
  m_speed_text = new QLabel(this);
  m_speed_text->setMinimumWidth(m_speed_text->fontMetrics().horizontalAdvance(QStringLiteral("150 mm/s")));
  speed->addWidget(m_speed, 1);
  speed->addWidget(m_speed_text);
  column->addLayout(speed);
  connect(m_speed, &QSlider::valueChanged, this, &JogPanel::showSpeed);
  m_creep = new QCheckBox(tr("Creep through contact"), this);
  m_creep->setToolTip(tr("Moves at 10 mm/s although the model says that something is touched; for getting free when the model is wrong"));
  connect(m_creep, &QCheckBox::toggled, &m_bench.jog(), &session::JogController::setThroughContact);
  column->addWidget(m_creep);
  column->addStretch(1);
  return box;
}

void JogPanel::showSpeed() {
  const double share = m_speed->value() / 100.0;
  m_bench.jog().setSpeed(share);
  const planning::JogSpeeds full;
  m_speed_text->setText(m_bench.jog().frame() == JogFrame::kJoint
                            ? QStringLiteral("%1 %").arg(m_speed->value())
                            : QStringLiteral("%1 mm/s").arg(1000 * share * full.linear, 0, 'f', 0));
}

void JogPanel::setFrame(JogFrame frame) {
  m_frames->button(static_cast<int>(frame))->setChecked(true);
  m_bench.jog().setFrame(frame, m_bench.paneCamera(vision::PaneSide::kLeft));
  fillAxes();
  showSpeed();
}

QToolButton* JogPanel::holdButton(const QString& text, int axis, int way) {
  auto* button = new QToolButton(m_axes);
  button->setText(text);
  button->setMinimumHeight(28);
  button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  button->setFocusPolicy(Qt::TabFocus);
  button->setProperty("holds", true);
  connect(button, &QToolButton::pressed, this, [this, axis, way] {
    // The camera may have been changed since the frame was chosen.
    m_bench.jog().setFrame(m_bench.jog().frame(), m_bench.paneCamera(vision::PaneSide::kLeft));
    m_bench.jog().hold(axis, way);
  });
  connect(button, &QToolButton::released, &m_bench.jog(), &session::JogController::letGo);
  return button;
}

void JogPanel::addPair(const QString& name, const QString& minus, const QString& plus, int axis) {
  const int index = static_cast<int>(m_pairs.size()), rows = m_bench.jog().frame() == JogFrame::kJoint ? 4 : 3;
  const int row = index % rows, column = 3 * (index / rows);
  Pair pair{new QLabel(name, m_axes), holdButton(minus, axis, -1), holdButton(plus, axis, 1), axis};
  pair.name->setAlignment(Qt::AlignCenter);
  m_grid->addWidget(pair.minus, row, column);
  m_grid->addWidget(pair.name, row, column + 1);
  m_grid->addWidget(pair.plus, row, column + 2);
  m_pairs.push_back(pair);
}

void JogPanel::fillAxes() {
  m_bench.jog().letGo();
  for (const auto& pair : m_pairs) {
    for (QWidget* widget : {static_cast<QWidget*>(pair.name), static_cast<QWidget*>(pair.minus), static_cast<QWidget*>(pair.plus)}) {
      widget->hide();
      widget->deleteLater();
    }
  }
  m_pairs.clear();
  const JogFrame frame = m_bench.jog().frame();
  if (frame != JogFrame::kJoint) {
    int axis = 0;
    for (const auto& names : axesOf(frame)) addPair(tr(names.name), tr(names.minus), tr(names.plus), axis++);
  } else if (const auto& workcell = m_bench.document().workcell()) {
    int axis = 0;
    for (const auto& joint : workcell->armJointNames()) {
      addPair(QString::fromStdString(joint), QStringLiteral("\u2212"), QStringLiteral("+"), axis++);
    }
  }
  refresh();
}

QToolButton* JogPanel::button(int axis, int way) const {
  for (const auto& pair : m_pairs) {
    if (pair.axis == axis) return way > 0 ? pair.plus : pair.minus;
  }
  return nullptr;
}

void JogPanel::refresh() {
  const auto& status = m_bench.robot().status();
  QString why = m_bench.robot().whyNotReady();
  if (why.isEmpty() && status.gate.stopped) why = tr("STOP is latched: hold Reset first.");
  for (const auto& pair : m_pairs) {
    for (auto* button : {pair.minus, pair.plus}) {
      button->setEnabled(why.isEmpty());
      button->setToolTip(why.isEmpty() ? tr("Moves the arm while it is held") : why);
    }
  }
  if (!why.isEmpty()) return m_state->setFullText(why);
  if (!m_refusal.isEmpty()) return m_state->setFullText(m_refusal);
  if (!status.jogging) {
    return m_state->setFullText(tr("Hold a button; or arrow keys and Page Up / Down here, with Shift to turn."));
  }
  const QString reason = QString::fromStdString(status.jog.reason);
  m_state->setFullText(reason.isEmpty() ? tr("moving; %1 mm free").arg(1000 * status.jog.clearance, 0, 'f', 0)
                                        : tr("%1 % of the speed: %2").arg(100 * status.jog.factor, 0, 'f', 0).arg(reason));
}

void JogPanel::keyPressEvent(QKeyEvent* event) {
  const JogFrame frame = m_bench.jog().frame();
  const auto way = frame == JogFrame::kJoint ? std::nullopt : wayOf(event->key(), frame);
  if (!way) return QWidget::keyPressEvent(event);
  if (event->isAutoRepeat() || m_key != 0) return;
  m_key = event->key();
  m_bench.jog().setFrame(frame, m_bench.paneCamera(vision::PaneSide::kLeft));
  m_bench.jog().hold(event->modifiers().testFlag(Qt::ShiftModifier) ? way->axis + 3 : way->axis, way->way);
}

void JogPanel::keyReleaseEvent(QKeyEvent* event) {
  if (event->isAutoRepeat() || event->key() != m_key) return QWidget::keyReleaseEvent(event);
  m_key = 0;
  m_bench.jog().letGo();
}

}  // namespace longarm::ui
