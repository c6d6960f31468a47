#pragma once

/// @file
/// SketchEdits: the edits that ask for something first (a note, numbers, a colour, a file), and the pictures' context menu.

#include <QColorDialog>
#include <QObject>
#include <QPointer>

#include "ui/actions.h"
#include "ui/numbers_dialog.h"
#include "ui/snapshot_pane.h"
#include "ui/workbench.h"

class QInputDialog;

namespace longarm::ui {

/// No dialog of it is modal.  GUI thread only.
class SketchEdits final : public QObject {
  Q_OBJECT

 public:
  SketchEdits(Workbench& bench, Actions& actions, QWidget* window);

  NumbersDialog* showNumbers();
  QInputDialog* askNote();
  /// Right click in a pane: selects what lies there, if anything, and opens the menu of what can be done.
  void showMenu(const SnapshotPane& pane, const QPoint& global_position);
  void exportWorld(const QString& path);

 private:
  void askColour();
  void browseExport();
  void refresh();

  Workbench& m_bench;
  Actions& m_actions;
  QWidget* m_window;
  QPointer<NumbersDialog> m_numbers;
};

}  // namespace longarm::ui
