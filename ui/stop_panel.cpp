#include "ui/stop_panel.h"

#include <QHBoxLayout>
#include <QVBoxLayout>

namespace longarm::ui {

namespace {

constexpr int kResetHold_ms = 1000;
constexpr int kClearance = 13;             // Around STOP [px], about 13 mm at the usual density with the frame's margin.

}  // namespace

StopPanel::StopPanel(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent)
    : QWidget(parent), m_bench(bench), m_actions(actions) {
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 2, 0);
  row->setSpacing(kClearance);
  m_reset = new widgets::HoldButton(tr("Hold to\nreset STOP"), kResetHold_ms, this);
  m_reset->setMinimumSize(96, 48);
  m_reset->setFocusPolicy(Qt::TabFocus);
  row->addWidget(m_reset, 0, Qt::AlignVCenter);
  m_stop = new widgets::StopButton(this);
  row->addWidget(m_stop, 0, Qt::AlignVCenter);
  const auto style = [this, &appearance] {
    m_reset->setTheme(appearance.theme());
    m_stop->setTheme(appearance.theme());
  };
  style();
  connect(&appearance, &Appearance::changed, this, style);
  const auto stop = [this] { m_bench.robot().stop("operator", "STOP was pressed"); };
  connect(m_stop, &widgets::StopButton::stopPressed, this, stop);
  connect(m_actions.at(ActionId::kStop), &QAction::triggered, this, stop);
  const auto reset = [this] { m_bench.robot().resetStop(); };
  connect(m_reset, &widgets::HoldButton::held, this, reset);
  connect(m_actions.at(ActionId::kReset), &QAction::triggered, this, reset);
  connect(&m_bench.robot(), &RobotSession::stopChanged, this, &StopPanel::refresh);
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, &StopPanel::refresh);
  refresh();
}

void StopPanel::refresh() {
  const auto& status = m_bench.robot().status();
  const bool there = m_bench.robot().runtime() != nullptr;
  m_stop->setState(!there || !status.gate.stopped ? widgets::StopButton::State::kReady
                   : status.stop_confirmed        ? widgets::StopButton::State::kConfirmed
                                                  : widgets::StopButton::State::kRequested);
  QString why;
  if (!there) why = tr("No robot is connected.");
  else if (!status.gate.stopped) why = tr("STOP is not latched.");
  m_actions.setWhyNot(ActionId::kReset, why);
  m_reset->setEnabled(why.isEmpty());
  m_reset->setToolTip(why.isEmpty() ? tr("Hold for one second: lets motion through again. Nothing moves by itself.") : why);
}

}  // namespace longarm::ui
