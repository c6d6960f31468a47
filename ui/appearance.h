#pragma once

/// @file
/// Appearance: the theme in force, and word of its change.

#include <QObject>

#include "widgets/theme.h"

namespace longarm::ui {

/// GUI thread only.
class Appearance final : public QObject {
  Q_OBJECT

 public:
  explicit Appearance(const QString& name, QObject* parent = nullptr);
  const widgets::Theme& theme() const { return m_theme; }
  /// "dark" or "light"; restyles the whole program.
  void setTheme(const QString& name);
  void toggle();

 Q_SIGNALS:
  void changed();

 private:
  widgets::Theme m_theme;
};

}  // namespace longarm::ui
