#pragma once

/// @file
/// PicturesArea: the two panes with the palette between them and the line that tells what to do.

#include <QWidget>

#include "ui/actions.h"
#include "ui/snapshot_pane.h"
#include "ui/third_pane.h"

class QSplitter;

namespace longarm::ui {

class ElidedLabel;

/// Binds the actions that concern both pictures.  GUI thread only.
class PicturesArea final : public QWidget {
  Q_OBJECT

 public:
  PicturesArea(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent = nullptr);
  ThirdPane* third() const { return m_third; }
  SnapshotPane* pane(vision::PaneSide side) const { return m_panes[static_cast<int>(side)]; }

 private:
  void bind();
  void toggleMaximised(bool on);
  void refreshLine();
  void refreshLive();

  Workbench& m_bench;
  Actions& m_actions;
  SnapshotPane* m_panes[2];
  ThirdPane* m_third;
  QSplitter* m_splitter;
  ElidedLabel *m_hint, *m_numbers;
};

}  // namespace longarm::ui
