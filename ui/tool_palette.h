#pragma once

/// @file
/// ToolPalette: the sketch tools and the camera button, on the edge of the panes.

#include <QFrame>

#include "ui/actions.h"

namespace longarm::ui {

/// Buttons of actions, top to bottom.  GUI thread only.
class ToolPalette final : public QFrame {
  Q_OBJECT

 public:
  explicit ToolPalette(Actions& actions, QWidget* parent = nullptr);
};

}  // namespace longarm::ui
