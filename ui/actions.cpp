#include "ui/actions.h"

#include <QKeySequence>
#include <QStringList>

#include "widgets/icon.h"

namespace longarm::ui {

Actions::Actions(Appearance& appearance, QObject* parent) : QObject(parent), m_appearance(appearance) {
  for (const auto& spec : actionTable()) make(spec);
  refreshIcons();
  connect(&m_appearance, &Appearance::changed, this, &Actions::refreshIcons);
}

void Actions::make(const ActionSpec& spec) {
  auto* action = new QAction(tr(spec.text), this);
  action->setCheckable(spec.checkable);
  QList<QKeySequence> keys;
  for (const QString& key : QString::fromLatin1(spec.keys).split(QLatin1Char(' '), Qt::SkipEmptyParts)) {
    keys.append(QKeySequence(key));
  }
  action->setShortcuts(keys);
  action->setShortcutContext(Qt::WindowShortcut);
  m_actions[spec.id] = action;
  refreshTip(spec);
}

void Actions::refreshTip(const ActionSpec& spec) {
  QAction* action = m_actions.at(spec.id);
  QString tip = tr(spec.tip);
  if (!action->shortcut().isEmpty()) {
    tip += QStringLiteral(" (%1)").arg(action->shortcut().toString(QKeySequence::NativeText));
  }
  const QString reason = whyNot(spec.id);
  if (!reason.isEmpty()) tip += QStringLiteral("\n") + tr("Not now: %1").arg(reason);
  action->setToolTip(tip.toHtmlEscaped().replace(QLatin1Char('\n'), QLatin1String("<br>")));
  action->setStatusTip(tip);
}

void Actions::refreshIcons() {
  for (const auto& spec : actionTable()) {
    if (*spec.icon != '\0') m_actions.at(spec.id)->setIcon(widgets::icon(QString::fromLatin1(spec.icon), m_appearance.theme()));
  }
}

QString Actions::whyNot(ActionId id) const {
  const auto found = m_reasons.find(id);
  return found == m_reasons.end() ? QString() : found->second;
}

void Actions::setWhyNot(ActionId id, const QString& reason) {
  QString& known = m_reasons[id];
  if (known == reason) return;
  known = reason;
  m_actions.at(id)->setEnabled(reason.isEmpty());
  for (const auto& spec : actionTable()) {
    if (spec.id == id) refreshTip(spec);
  }
}

void Actions::setText(ActionId id, const QString& text) {
  QString plain = text;
  m_actions.at(id)->setText(plain.replace(QLatin1Char('&'), QLatin1String("&&")));
}

}  // namespace longarm::ui
