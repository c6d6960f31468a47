#include "ui/window_layout.h"

#include <utility>

#include <QDockWidget>
#include <QGuiApplication>
#include <QScreen>

namespace longarm::ui {

namespace {

constexpr int kLeastVisible = 100;         // So much of the window must lie on a screen [px].

QString splitterKey(const QSplitter& splitter) { return QStringLiteral("layout/splitter_") + splitter.objectName(); }

}  // namespace

WindowLayout::WindowLayout(QMainWindow& window, QMainWindow& docks, std::vector<QSplitter*> splitters, QSettings& settings,
                           std::function<void()> size)
    : m_window(window), m_docks(docks), m_splitters(std::move(splitters)), m_settings(settings), m_size(std::move(size)),
      m_factory(docks.saveState(kSchema)) {
  for (const auto* splitter : m_splitters) m_factory_splitters.push_back(splitter->saveState());
}

bool WindowLayout::onScreen() const {
  for (const auto* screen : QGuiApplication::screens()) {
    const QRect common = screen->availableGeometry().intersected(m_window.frameGeometry());
    if (common.width() >= kLeastVisible && common.height() >= kLeastVisible) return true;
  }
  return false;
}

bool WindowLayout::restore() {
  const QByteArray geometry = m_settings.value(QStringLiteral("layout/geometry")).toByteArray();
  const QByteArray state = m_settings.value(QStringLiteral("layout/docks")).toByteArray();
  const bool known = m_settings.value(QStringLiteral("layout/schema")).toInt() == kSchema && !state.isEmpty();
  if (!known || !m_window.restoreGeometry(geometry) || !onScreen() || !m_docks.restoreState(state, kSchema)) {
    reset();
    return false;
  }
  for (auto* splitter : m_splitters) {
    const QByteArray kept = m_settings.value(splitterKey(*splitter)).toByteArray();
    if (!kept.isEmpty()) splitter->restoreState(kept);
  }
  m_is_factory = false;
  return true;
}

void WindowLayout::save() {
  m_settings.setValue(QStringLiteral("layout/schema"), kSchema);
  m_settings.setValue(QStringLiteral("layout/geometry"), m_window.saveGeometry());
  m_settings.setValue(QStringLiteral("layout/docks"), m_docks.saveState(kSchema));
  for (const auto* splitter : m_splitters) m_settings.setValue(splitterKey(*splitter), splitter->saveState());
}

void WindowLayout::reset() {
  m_docks.restoreState(m_factory, kSchema);
  for (auto* dock : m_docks.findChildren<QDockWidget*>()) {
    dock->setFloating(false);
    dock->show();
  }
  m_docks.restoreState(m_factory, kSchema);
  for (std::size_t i = 0; i < m_splitters.size(); ++i) m_splitters[i]->restoreState(m_factory_splitters[i]);
  m_is_factory = true;
  if (m_window.isVisible()) shown();
}

void WindowLayout::shown() {
  if (m_is_factory && m_size) m_size();
}

}  // namespace longarm::ui
