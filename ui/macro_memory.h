#pragma once

/// @file
/// MacroMemory: what was set for each motion, kept from run to run.

#include <QObject>
#include <QSettings>

#include "session/controllers/plan_controller.h"

namespace longarm::ui {

/// Reads at once, writes with every change.  GUI thread only.
class MacroMemory final : public QObject {
  Q_OBJECT

 public:
  /// Borrowed; both outlive this.
  MacroMemory(session::PlanController& plans, QSettings& settings, QObject* parent = nullptr);

 private:
  void read();
  void write();

  session::PlanController& m_plans;
  QSettings& m_settings;
};

}  // namespace longarm::ui
