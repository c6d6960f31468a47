#pragma once

/// @file
/// SketchActions: tools, undo and the edits of what is selected, as actions.

#include <QObject>

#include "session/controllers/targeting_controller.h"
#include "ui/actions.h"

namespace longarm::ui {

/// Keeps texts, reasons and check marks up to date.  GUI thread only.
class SketchActions final : public QObject {
  Q_OBJECT

 public:
  SketchActions(session::TargetingController& targeting, Actions& actions, QObject* parent = nullptr);

 private:
  void bind();
  void refreshHistory();
  void refreshSelection();
  void refreshTools();
  void selectAll();
  void toggle(void (session::TargetingController::*set)(FeatureId, bool), bool now);

  session::TargetingController& m_targeting;
  Actions& m_actions;
};

}  // namespace longarm::ui
