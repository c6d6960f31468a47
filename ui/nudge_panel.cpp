#include "ui/nudge_panel.h"

#include <cmath>

#include <QComboBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QToolButton>
#include <QVBoxLayout>

namespace longarm::ui {

namespace {

constexpr double kSteps_mm[] = {1, 5, 20};
constexpr double kAngles_deg[] = {1, 5};
const char kAxes[] = "XYZ";

}  // namespace

NudgePanel::NudgePanel(Workbench& bench, QWidget* parent) : QWidget(parent), m_bench(bench) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(6, 6, 6, 6);
  column->setSpacing(5);
  auto* choices = new QHBoxLayout;
  m_frame = new QComboBox(this);
  m_frame->addItem(tr("tool"), static_cast<int>(planning::JogFrame::kTool));
  m_frame->addItem(tr("base"), static_cast<int>(planning::JogFrame::kBase));
  m_frame->addItem(tr("left picture"), static_cast<int>(planning::JogFrame::kCamera));
  m_frame->setToolTip(tr("Whose axes: the tool's (z out of it), the base's (x forwards, z up), or those of the left picture (x right, y down, z away)"));
  m_step = new QComboBox(this);
  for (const double step : kSteps_mm) m_step->addItem(tr("%1 mm").arg(step), step / 1000);
  m_angle = new QComboBox(this);
  for (const double angle : kAngles_deg) m_angle->addItem(tr("%1\u00b0").arg(angle), angle * M_PI / 180);
  for (auto* box : {m_frame, m_step, m_angle}) choices->addWidget(box);
  choices->addStretch(1);
  column->addLayout(choices);
  auto* grid = new QGridLayout;
  grid->setSpacing(4);
  for (int axis = 0; axis < 3; ++axis) {
    for (const int sign : {-1, 1}) {
      const QString name = QString(QLatin1Char(kAxes[axis])) + (sign > 0 ? QStringLiteral("+") : QStringLiteral("\u2212"));
      const int at = 2 * axis + (sign > 0 ? 1 : 0);
      grid->addWidget(m_move[index(axis, sign)] = button(name, axis, sign, false), 0, at);
      grid->addWidget(m_turn[index(axis, sign)] = button(QStringLiteral("\u21bb") + name, axis, sign, true), 1, at);
    }
  }
  column->addLayout(grid);
  m_state = new QLabel(this);
  m_state->setTextFormat(Qt::PlainText);
  m_state->setWordWrap(true);
  m_state->setAlignment(Qt::AlignTop | Qt::AlignLeft);
  column->addWidget(m_state, 1);
  connect(&m_bench.play(), &session::PlayController::changed, this, &NudgePanel::refresh);
  refresh();
}

QToolButton* NudgePanel::button(const QString& text, int axis, int sign, bool turn) {
  auto* made = new QToolButton(this);
  made->setText(text);
  made->setMinimumSize(36, 30);
  made->setFocusPolicy(Qt::TabFocus);
  connect(made, &QToolButton::clicked, this, [this, axis, sign, turn] { nudge(axis, sign, turn); });
  return made;
}

void NudgePanel::nudge(int axis, int sign, bool turn) {
  Eigen::Vector3d step = Eigen::Vector3d::Zero();
  step[axis] = sign * (turn ? m_angle : m_step)->currentData().toDouble();
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  m_bench.nudge(static_cast<planning::JogFrame>(m_frame->currentData().toInt()), turn ? none : step, turn ? step : none);
}

void NudgePanel::refresh() {
  const auto& state = m_bench.play().state();
  const QString& why = state.why_not_correct;
  for (auto* each : m_move) {
    each->setEnabled(why.isEmpty());
    each->setToolTip(why.isEmpty() ? tr("Moves the tool off its path by a step; it comes back onto it afterwards") : why);
  }
  for (auto* each : m_turn) {
    each->setEnabled(why.isEmpty());
    each->setToolTip(why.isEmpty() ? tr("Turns the tool about its point by a step, right-handed about that axis for +") : why);
  }
  m_state->setText(!why.isEmpty() ? why
                   : state.correcting ? tr("Correcting ...")
                                      : tr("A moving arm pauses for a correction and goes on after it."));
}

}  // namespace longarm::ui
