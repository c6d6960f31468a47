#pragma once

/// @file
/// PlaySettings: how Play acts, as the operator set it, kept from run to run.

#include <QObject>
#include <QSettings>

#include "ui/actions.h"
#include "ui/workbench.h"

namespace longarm::ui {

/// Binds "Hold to run" and "Play at once" to the bench; both are off until somebody switches them on.  GUI
/// thread only.
class PlaySettings final : public QObject {
  Q_OBJECT

 public:
  PlaySettings(Workbench& bench, Actions& actions, QSettings& settings, QObject* parent = nullptr);

 private:
  void refresh();

  Workbench& m_bench;
  Actions& m_actions;
};

}  // namespace longarm::ui
