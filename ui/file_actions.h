#pragma once

/// @file
/// FileActions: opening pictures and sketches, saving, what was open lately.

#include <cstddef>
#include <functional>
#include <limits>

#include <QObject>
#include <QPointer>
#include <QSettings>
#include <QStringList>

#include "ui/actions.h"
#include "ui/picture_files_dialog.h"
#include "ui/workbench.h"

class QMenu;

namespace longarm::ui {

/// Dialogs are never modal and are Qt's own.  GUI thread only.
class FileActions final : public QObject {
  Q_OBJECT

 public:
  /// @param window Parent of the dialogs.  The settings outlive this.
  FileActions(Workbench& bench, Actions& actions, QSettings& settings, QWidget* window);

  /// Filled when it opens.  Owned by the window.
  QMenu* recentMenu() const { return m_recent; }
  void openPictures(const session::PictureFiles& left, const session::PictureFiles& right);
  void openViews(const QString& path);
  /// One step of undo: the sketch before comes back with Undo.
  void openSketch(const QString& folder);
  void saveSketch(const QString& folder);
  /// Where the sketch on the table was read from or written to; empty when it has no folder.
  QString sketchFolder() const { return isOfFolder() ? m_folder : QString(); }

 Q_SIGNALS:
  void sketchFolderChanged();

 private:
  void showPicturesDialog();
  void browse(const QString& title, bool folder, bool saving, const std::function<void(const QString&)>& chosen);
  void remember(const QString& kind, const QStringList& paths);
  void fillRecent();
  void openRecent(const QString& entry);
  void setFolder(const QString& folder);
  bool isOfFolder() const;

  Workbench& m_bench;
  QSettings& m_settings;
  QWidget* m_window;
  QMenu* m_recent;
  QPointer<PictureFilesDialog> m_pictures;
  QString m_folder;
  // Positions of the history at which the sketch is that of the folder: undoing or redoing an "Open" leaves them.
  std::size_t m_from = 0, m_to = std::numeric_limits<std::size_t>::max();
};

}  // namespace longarm::ui
