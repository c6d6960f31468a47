#pragma once

/// @file
/// SnapshotsPanel: the library of pictures, with what can be done with each.

#include <map>

#include <QIcon>
#include <QWidget>

#include "ui/appearance.h"
#include "ui/workbench.h"

class QListWidget;
class QToolButton;

namespace longarm::ui {

/// Thumbnails with camera, time and where they are shown.  Double-click shows one in the left pane.  GUI thread only.
class SnapshotsPanel final : public QWidget {
  Q_OBJECT

 public:
  enum class Button { kLeft, kRight, kThird, kPin, kCompare, kDelete };

  SnapshotsPanel(Workbench& bench, Appearance& appearance, QWidget* parent = nullptr);
  QListWidget* list() const { return m_list; }
  QToolButton* button(Button which) const { return m_buttons.at(which); }
  /// The picture chosen in the list; invalid: none.
  SnapshotId chosen() const;

 Q_SIGNALS:
  void compareRequested(const longarm::vision::SnapshotPtr& a, const longarm::vision::SnapshotPtr& b);

 private:
  void addButton(Button which, const QString& text, const QString& tip);
  void refresh();
  void refreshButtons();
  void act(Button which);
  QString caption(const vision::Snapshot& snapshot) const;
  QString whyNot(Button which) const;
  const QIcon& thumbnail(const vision::Snapshot& snapshot);

  Workbench& m_bench;
  QListWidget* m_list;
  std::map<Button, QToolButton*> m_buttons;
  std::map<Button, QString> m_tips;
  std::map<SnapshotId, QIcon> m_thumbnails;
};

}  // namespace longarm::ui
