#include "ui/file_actions.h"

#include <limits>
#include <utility>

#include <QFileDialog>
#include <QFileInfo>
#include <QMenu>

#include "session/commands/sketch_commands.h"
#include "session/document/document_file.h"

namespace longarm::ui {

namespace {

constexpr int kRecent = 8;
constexpr auto kRecentKey = "files/recent";
const QString kSeparator = QStringLiteral("\n");

}  // namespace

FileActions::FileActions(Workbench& bench, Actions& actions, QSettings& settings, QWidget* window)
    : QObject(window), m_bench(bench), m_settings(settings), m_window(window), m_recent(new QMenu(tr("Open &recent"), window)) {
  connect(m_recent, &QMenu::aboutToShow, this, &FileActions::fillRecent);
  connect(actions.at(ActionId::kOpenPair), &QAction::triggered, this, &FileActions::showPicturesDialog);
  connect(actions.at(ActionId::kOpenViews), &QAction::triggered, this, [this] {
    browse(tr("Open views file"), false, false, [this](const QString& path) { openViews(path); });
  });
  connect(actions.at(ActionId::kOpenSketch), &QAction::triggered, this, [this] {
    browse(tr("Open sketch: its folder"), true, false, [this](const QString& path) { openSketch(path); });
  });
  const auto save_as = [this] {
    browse(tr("Save sketch: a folder for it"), true, true, [this](const QString& path) { saveSketch(path); });
  };
  connect(actions.at(ActionId::kSaveSketchAs), &QAction::triggered, this, save_as);
  connect(actions.at(ActionId::kSaveSketch), &QAction::triggered, this, [this, save_as] {
    // Where the opening of that sketch was undone, something else is on the table: it needs a folder of its own.
    if (isOfFolder()) saveSketch(m_folder);
    else save_as();
  });
  fillRecent();
}

void FileActions::showPicturesDialog() {
  if (!m_pictures) {
    m_pictures = new PictureFilesDialog(m_window);
    connect(m_pictures, &PictureFilesDialog::chosen, this, &FileActions::openPictures);
  }
  m_pictures->show();
  m_pictures->raise();
}

void FileActions::browse(const QString& title, bool folder, bool saving, const std::function<void(const QString&)>& chosen) {
  auto* dialog = new QFileDialog(m_window, title);
  dialog->setOption(QFileDialog::DontUseNativeDialog);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setModal(false);
  dialog->setFileMode(folder ? QFileDialog::Directory : QFileDialog::ExistingFile);
  if (folder) dialog->setOption(QFileDialog::ShowDirsOnly);
  if (saving) dialog->setLabelText(QFileDialog::Accept, tr("Save here"));
  if (!folder) dialog->setNameFilters({tr("Views files (*.yaml *.yml)"), tr("All files (*)")});
  connect(dialog, &QFileDialog::fileSelected, this, [chosen](const QString& path) { chosen(path); });
  dialog->show();
}

void FileActions::openPictures(const session::PictureFiles& left, const session::PictureFiles& right) {
  m_bench.snapshots().openFiles(left, right);
  QStringList paths;
  for (const auto* path : {&left.image, &left.camera, &right.image, &right.camera}) paths << QFileInfo(QString::fromStdString(*path)).absoluteFilePath();
  remember(QStringLiteral("pictures"), paths);
}

void FileActions::openViews(const QString& path) {
  m_bench.snapshots().openViews(path);
  remember(QStringLiteral("views"), {QFileInfo(path).absoluteFilePath()});
}

void FileActions::openSketch(const QString& folder) {
  auto& bench = m_bench;
  bench.jobs().run<session::DocumentState>(
      this, [path = folder.toStdString()] { return session::loadSketch(path); },
      [this, &bench, folder](Result<session::DocumentState> state) {
        if (!state) return bench.say(QString::fromStdString(state.error().message));
        const bool lost_nothing = bench.history().isClean();
        bench.history().push(session::openState(bench.document(), std::move(*state), QFileInfo(folder).fileName().toStdString()));
        bench.history().markClean();
        m_from = bench.history().position();
        m_to = std::numeric_limits<std::size_t>::max();
        setFolder(folder);
        if (!lost_nothing) bench.say(tr("Opened %1. What you had was not saved: Undo brings it back").arg(folder));
        remember(QStringLiteral("sketch"), {QFileInfo(folder).absoluteFilePath()});
      });
}

void FileActions::saveSketch(const QString& folder) {
  auto& bench = m_bench;
  const auto position = bench.history().position();
  bench.jobs().run<int>(
      this,
      [path = folder.toStdString(), state = bench.document().state()]() -> Result<int> {
        const Status saved = session::saveSketch(path, state);
        if (!saved) return saved.error();
        return 0;
      },
      [this, &bench, folder, position](Result<int> saved) {
        if (!saved) return bench.say(QString::fromStdString(saved.error().message));
        if (bench.history().position() == position) bench.history().markClean();
        if (position < m_from) m_to = std::exchange(m_from, 0);
        setFolder(folder);
        remember(QStringLiteral("sketch"), {QFileInfo(folder).absoluteFilePath()});
        bench.say(tr("Saved to %1").arg(folder));
      });
}

bool FileActions::isOfFolder() const {
  const std::size_t position = m_bench.history().position();
  return !m_folder.isEmpty() && position >= m_from && position < m_to;
}

void FileActions::setFolder(const QString& folder) {
  m_folder = folder;
  Q_EMIT sketchFolderChanged();
}

void FileActions::remember(const QString& kind, const QStringList& paths) {
  QStringList entries = m_settings.value(QLatin1String(kRecentKey)).toStringList();
  const QString entry = (QStringList{kind} + paths).join(kSeparator);
  entries.removeAll(entry);
  entries.prepend(entry);
  while (entries.size() > kRecent) entries.removeLast();
  m_settings.setValue(QLatin1String(kRecentKey), entries);
}

void FileActions::fillRecent() {
  m_recent->clear();
  for (const QString& entry : m_settings.value(QLatin1String(kRecentKey)).toStringList()) {
    const QStringList parts = entry.split(kSeparator);
    if (parts.size() < 2) continue;
    const QString text = parts[0] == QLatin1String("pictures") && parts.size() == 5
                             ? tr("%1 and %2").arg(QFileInfo(parts[1]).fileName(), QFileInfo(parts[3]).fileName())
                             : parts[1];
    QAction* action = m_recent->addAction(QString(text).replace(QLatin1Char('&'), QLatin1String("&&")));
    action->setToolTip(parts.mid(1).join(QLatin1String(", ")).toHtmlEscaped());
    connect(action, &QAction::triggered, this, [this, entry] { openRecent(entry); });
  }
  if (m_recent->isEmpty()) m_recent->addAction(tr("Nothing was opened yet"))->setEnabled(false);
}

void FileActions::openRecent(const QString& entry) {
  const QStringList parts = entry.split(kSeparator);
  if (parts[0] == QLatin1String("views")) openViews(parts[1]);
  if (parts[0] == QLatin1String("sketch")) openSketch(parts[1]);
  if (parts[0] == QLatin1String("pictures") && parts.size() == 5) {
    session::PictureFiles left, right;
    left.image = parts[1].toStdString();
    left.camera = parts[2].toStdString();
    right.image = parts[3].toStdString();
    right.camera = parts[4].toStdString();
    openPictures(left, right);
  }
}

}  // namespace longarm::ui
