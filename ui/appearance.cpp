#include "ui/appearance.h"

#include <QApplication>

namespace longarm::ui {

Appearance::Appearance(const QString& name, QObject* parent) : QObject(parent), m_theme(widgets::Theme::byName(name)) {
  widgets::applyTheme(*qApp, m_theme);
}

void Appearance::setTheme(const QString& name) {
  if (name == m_theme.name) return;
  m_theme = widgets::Theme::byName(name);
  widgets::applyTheme(*qApp, m_theme);
  Q_EMIT changed();
}

void Appearance::toggle() { setTheme(m_theme.name == QLatin1String("dark") ? QStringLiteral("light") : QStringLiteral("dark")); }

}  // namespace longarm::ui
