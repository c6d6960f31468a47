#include "ui/macro_memory.h"

#include <cmath>

namespace longarm::ui {

MacroMemory::MacroMemory(session::PlanController& plans, QSettings& settings, QObject* parent)
    : QObject(parent), m_plans(plans), m_settings(settings) {
  read();
  connect(&m_plans, &session::PlanController::argumentsChanged, this, &MacroMemory::write);
}

void MacroMemory::read() {
  session::MacroSettings all;
  m_settings.beginGroup(QStringLiteral("macros"));
  for (const auto& macro : m_settings.childGroups()) {
    m_settings.beginGroup(macro);
    for (const auto& parameter : m_settings.childKeys()) {
      bool number = false;
      const double value = m_settings.value(parameter).toDouble(&number);
      if (number && std::isfinite(value)) all[macro.toStdString()][parameter.toStdString()] = value;
    }
    m_settings.endGroup();
  }
  m_settings.endGroup();
  m_plans.setSettings(std::move(all));
}

void MacroMemory::write() {
  m_settings.remove(QStringLiteral("macros"));
  for (const auto& [macro, values] : m_plans.settings()) {
    for (const auto& [parameter, value] : values) {
      m_settings.setValue(QStringLiteral("macros/%1/%2").arg(QString::fromStdString(macro), QString::fromStdString(parameter)), value);
    }
  }
}

}  // namespace longarm::ui
