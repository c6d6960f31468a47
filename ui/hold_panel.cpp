#include "ui/hold_panel.h"

#include <QGuiApplication>
#include <QHBoxLayout>
#include <QVBoxLayout>

#include "ui/elided_label.h"

namespace longarm::ui {

using session::DeadManSwitch;

HoldPanel::HoldPanel(Workbench& bench, DeadManSwitch& held, QWidget* parent)
    : QWidget(parent), m_bench(bench), m_row(new QHBoxLayout), m_state(new ElidedLabel(this)), m_held(held) {
  setFocusPolicy(Qt::StrongFocus);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(6, 6, 6, 4);
  column->setSpacing(4);
  m_row->setSpacing(12);
  column->addLayout(m_row, 1);
  column->addWidget(m_state);
  connect(&m_held, &DeadManSwitch::refused, this, [this](const QString& sentence) {
    m_refusal = sentence;
    refresh();
  });
  connect(&m_held, &DeadManSwitch::changed, this, [this] {
    if (m_held.held()) m_refusal.clear();
    refresh();
  });
  connect(&m_bench.robot(), &RobotSession::polledSlowly, this, [this] { refresh(); });
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, [this] { refresh(); });
  connect(&m_bench.robot(), &RobotSession::stopChanged, this, [this] { refresh(); });
  connect(qGuiApp, &QGuiApplication::applicationStateChanged, this, [this](Qt::ApplicationState state) {
    if (state != Qt::ApplicationActive) letGo();
  });
}

QString HoldPanel::message() const { return m_state->fullText(); }

void HoldPanel::letGo() {
  forgetKeys();
  m_held.letGo();
}

void HoldPanel::hideEvent(QHideEvent* event) {
  QWidget::hideEvent(event);
  letGo();
}

void HoldPanel::focusOutEvent(QFocusEvent* event) {
  QWidget::focusOutEvent(event);
  if (keyHeld()) letGo();
}

}  // namespace longarm::ui
