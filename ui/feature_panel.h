#pragma once

/// @file
/// FeaturePanel: the list of what is sketched and measured.

#include <QWidget>

#include "ui/actions.h"
#include "ui/feature_table.h"

class QLabel;
class QTableView;

namespace longarm::ui {

/// Selection goes both ways between list and document.  GUI thread only.
class FeaturePanel final : public QWidget {
  Q_OBJECT

 public:
  FeaturePanel(session::TargetingController& targeting, Actions& actions, Appearance& appearance, QWidget* parent = nullptr);
  QTableView* view() const { return m_view; }
  /// Opens the name of the primary selection for editing.
  void editName();

 private:
  void buildView();
  void showSelection();
  void takeSelection();
  void onClicked(const QModelIndex& index);
  void refreshEmpty();
  bool eventFilter(QObject* watched, QEvent* event) override;   ///< The list's resizing.

  session::TargetingController& m_targeting;
  FeatureTable* m_table;
  QTableView* m_view;
  QLabel* m_empty;
  bool m_following = false;                // The view is being set from the document.
};

}  // namespace longarm::ui
