#pragma once

/// @file
/// WorldPanel: the bodies that were added to the world, with sizes that can be changed.

#include <QWidget>

#include "ui/actions.h"
#include "ui/workbench.h"

class QPushButton;
class QTableWidget;

namespace longarm::ui {

/// GUI thread only.
class WorldPanel final : public QWidget {
  Q_OBJECT

 public:
  enum Column { kName, kKind, kSizeX, kSizeY, kSizeZ, kMargin, kAtX, kAtY, kAtZ, kShown, kRole, kColumns };

  WorldPanel(Workbench& bench, Actions& actions, QWidget* parent = nullptr);
  QTableWidget* table() const { return m_table; }
  QPushButton* removeButton() const { return m_remove; }

 private:
  void buildTable();
  void refresh();
  void fillRow(int row, const session::WorldItem& item);
  void edited(int row, int column);
  void addRoleBox(int row, const session::WorldItem& item);
  void apply(const session::WorldItem& after);
  void refreshButtons();
  void removeSelected();
  std::vector<WorldItemId> selected() const;

  Workbench& m_bench;
  QTableWidget* m_table;
  QPushButton* m_remove;
  bool m_filling = false;
};

}  // namespace longarm::ui
