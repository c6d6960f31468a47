#include "ui/shortcut_sheet.h"

#include <QTextBrowser>
#include <QVBoxLayout>

namespace longarm::ui {

namespace {

struct Gesture {
  const char *where, *gesture, *does;
};

// Keys and gestures that belong to no action.
constexpr Gesture kGestures[] = {
    {"Everywhere", "Space, Pause", "STOP the robot, in text fields too while it can move"},
    {"Everywhere", "1 to 9, Alt+1 to 9", "Show that camera live in the left, the right pane"},
    {"Pictures", "Wheel", "Zoom about the cursor"},
    {"Pictures", "Middle or right drag", "Move the picture"},
    {"Pictures", "Middle double-click", "Show the whole picture"},
    {"Pictures", "Alt while pointing", "Loupe with the pixel to 0.1 px"},
    {"Snapshots", "Drag a handle", "First picture: freely; second: along the epipolar curve"},
    {"Snapshots", "Ctrl while dragging", "Let go of the epipolar curve; the miss is shown"},
    {"Snapshots", "Arrow keys", "Move the active handle 0.1 px, with Shift 1 px"},
    {"Snapshots", "Shift while dragging", "Snap to the corner or edge next to the handle, to a fraction of a pixel"},
    {"Snapshots", "Tab", "Take the match that is offered in the other picture; else next handle"},
    {"Live pictures", "Double-click, Ctrl+click", "Bring that place to the middle of the picture"},
    {"Live pictures", "Drag a frame", "Turn and zoom the camera so that what is in the frame fills the picture"},
    {"Live pictures", "Page up, Page down", "Zoom in or out while held, with Shift focus farther or nearer"},
    {"Live pictures", "Arrow keys", "Turn the cameras 1 degree, with Shift 5 degrees"},
    {"3-D scene", "Left drag", "Turn the scene"},
    {"3-D scene", "Middle or Shift drag", "Move the scene"},
    {"3-D scene", "Wheel, right drag", "Come closer, go away"},
    {"3-D scene", "Click a feature", "Select it"},
};

QString row(const QString& keys, const QString& does) {
  return QStringLiteral("<tr><td width=190><b>%1</b></td><td>%2</td></tr>").arg(keys.toHtmlEscaped(), does.toHtmlEscaped());
}

}  // namespace

QString shortcutPage(const Actions& actions) {
  QString page;
  QString section;
  const auto begin = [&](const QString& title) {
    if (title == section) return;
    if (!section.isEmpty()) page += QStringLiteral("</table>");
    section = title;
    page += QStringLiteral("<h3>%1</h3><table cellspacing=0 cellpadding=3>").arg(title.toHtmlEscaped());
  };
  for (const auto& gesture : kGestures) {
    begin(QObject::tr(gesture.where));
    page += row(QObject::tr(gesture.gesture), QObject::tr(gesture.does));
  }
  for (const auto& spec : actionTable()) {
    const auto keys = actions.at(spec.id)->shortcuts();
    if (keys.isEmpty()) continue;
    begin(QObject::tr(spec.menu));
    page += row(QKeySequence::listToString(keys, QKeySequence::NativeText), QObject::tr(spec.tip));
  }
  return page + QStringLiteral("</table>");
}

ShortcutSheet::ShortcutSheet(const Actions& actions, QWidget* parent) : QDialog(parent) {
  setWindowTitle(tr("Keys and mouse"));
  setModal(false);
  setAttribute(Qt::WA_DeleteOnClose);
  resize(640, 620);
  auto* column = new QVBoxLayout(this);
  auto* text = new QTextBrowser(this);
  text->setHtml(shortcutPage(actions));
  column->addWidget(text);
}

}  // namespace longarm::ui
