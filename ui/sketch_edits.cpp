#include "ui/sketch_edits.h"

#include <QFileDialog>
#include <QInputDialog>
#include <QMenu>

#include "session/document/world_export.h"

namespace longarm::ui {

using session::TargetingController;

namespace {

constexpr double kReach_px = 8;            // on screen

}  // namespace

SketchEdits::SketchEdits(Workbench& bench, Actions& actions, QWidget* window)
    : QObject(window), m_bench(bench), m_actions(actions), m_window(window) {
  connect(actions.at(ActionId::kNote), &QAction::triggered, this, &SketchEdits::askNote);
  connect(actions.at(ActionId::kNumbers), &QAction::triggered, this, &SketchEdits::showNumbers);
  connect(actions.at(ActionId::kColour), &QAction::triggered, this, &SketchEdits::askColour);
  connect(actions.at(ActionId::kExportWorld), &QAction::triggered, this, &SketchEdits::browseExport);
  connect(actions.at(ActionId::kReregister), &QAction::triggered, &bench, &Workbench::reregister);
  const auto tell = [this](const Status& done) {
    if (!done) m_bench.say(QString::fromStdString(done.error().message));
  };
  connect(actions.at(ActionId::kAddToWorld), &QAction::triggered, this, [this, tell] { tell(m_bench.world().addSelected()); });
  connect(actions.at(ActionId::kCopyToPictures), &QAction::triggered, this,
          [this, tell] { tell(m_bench.targeting().copyToPictures(m_bench.document().selection().primary)); });
  connect(actions.at(ActionId::kAddKeepOut), &QAction::triggered, this,
          [this, tell] { tell(m_bench.world().addSelected(session::WorldRole::kKeepOut)); });
  connect(actions.at(ActionId::kAddWorkspace), &QAction::triggered, this, [this, tell] { tell(m_bench.world().addWorkspace()); });
  connect(actions.at(ActionId::kClearestView), &QAction::triggered, this, [this] { m_bench.showClearestView(); });
  connect(actions.at(ActionId::kSnap), &QAction::toggled, this, [this](bool on) { m_bench.targeting().pictures()->setSnapping(on); });
  connect(actions.at(ActionId::kOwnLinks), &QAction::toggled, this, [this](bool on) { m_bench.targeting().setOwnLinksShown(on); });
  actions.at(ActionId::kOwnLinks)->setChecked(true);
  connect(&bench.targeting(), &TargetingController::featuresChanged, this, &SketchEdits::refresh);
  connect(&bench.targeting(), &TargetingController::worldChanged, this, &SketchEdits::refresh);
  refresh();
}

void SketchEdits::refresh() {
  for (const auto id : {ActionId::kAddToWorld, ActionId::kAddKeepOut}) m_actions.setWhyNot(id, m_bench.world().whyNotAdd());
  m_actions.setWhyNot(ActionId::kReregister, m_bench.whyNotReregister());
  m_actions.setWhyNot(ActionId::kExportWorld, m_bench.world().items().empty() ? tr("Nothing was added to the world yet.") : QString());
}

NumbersDialog* SketchEdits::showNumbers() {
  if (!m_numbers) m_numbers = new NumbersDialog(m_bench.targeting(), m_window);
  m_numbers->show();
  m_numbers->raise();
  return m_numbers;
}

QInputDialog* SketchEdits::askNote() {
  const FeatureId id = m_bench.document().selection().primary;
  const auto* item = m_bench.document().item(id);
  if (item == nullptr) return nullptr;
  auto* dialog = new QInputDialog(m_window);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setModal(false);
  dialog->setWindowTitle(tr("Note"));
  dialog->setLabelText(tr("Note on %1:").arg(QString::fromStdString(item->name)));
  dialog->setTextValue(QString::fromStdString(item->note));
  connect(dialog, &QInputDialog::textValueSelected, this, [this, id](const QString& text) { m_bench.targeting().setNote(id, text); });
  dialog->show();
  return dialog;
}

void SketchEdits::askColour() {
  const auto selected = m_bench.document().selection();
  const auto* item = m_bench.document().item(selected.primary);
  if (item == nullptr) return;
  auto* dialog = new QColorDialog(m_window);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setModal(false);
  dialog->setOption(QColorDialog::DontUseNativeDialog);
  if (item->colour) dialog->setCurrentColor(QColor::fromRgb(static_cast<QRgb>(*item->colour)));
  connect(dialog, &QColorDialog::colorSelected, this, [this, selected](const QColor& colour) {
    for (const FeatureId id : selected.items) m_bench.targeting().setColour(id, colour.rgb() & 0xffffffU);
  });
  dialog->show();
}

void SketchEdits::browseExport() {
  auto* dialog = new QFileDialog(m_window, tr("Export world"));
  dialog->setOption(QFileDialog::DontUseNativeDialog);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setModal(false);
  dialog->setAcceptMode(QFileDialog::AcceptSave);
  dialog->setNameFilters({tr("glTF binary (*.glb)"), tr("Wavefront OBJ (*.obj)"), tr("JSON (*.json)")});
  dialog->setDefaultSuffix(QStringLiteral("glb"));
  connect(dialog, &QFileDialog::filterSelected, dialog, [dialog](const QString& filter) {
    dialog->setDefaultSuffix(filter.section(QLatin1String("*."), 1).section(QLatin1Char(')'), 0, 0));
  });
  connect(dialog, &QFileDialog::fileSelected, this, &SketchEdits::exportWorld);
  dialog->show();
}

void SketchEdits::exportWorld(const QString& path) {
  auto& bench = m_bench;
  bench.jobs().run<int>(
      this,
      [path = path.toStdString(), items = bench.document().world()]() -> Result<int> {
        const Status written = session::exportWorld(path, items);
        if (!written) return written.error();
        return 0;
      },
      [&bench, path](Result<int> written) {
        bench.say(written ? tr("World written to %1").arg(path) : QString::fromStdString(written.error().message));
      });
}

void SketchEdits::showMenu(const SnapshotPane& pane, const QPoint& global_position) {
  if (pane.live()) return;
  auto& targeting = m_bench.targeting();
  const auto* canvas = pane.canvas();
  const Eigen::Vector2d pixel = canvas->pixelOfWidget(canvas->mapFromGlobal(global_position));
  const FeatureId there = targeting.itemAt(pane.side(), pixel, kReach_px / canvas->scale());
  if (there.valid() && !m_bench.document().selection().contains(there)) targeting.select(there);
  auto* menu = new QMenu(m_window);
  menu->setAttribute(Qt::WA_DeleteOnClose);
  menu->setToolTipsVisible(true);
  const auto add = [&](std::initializer_list<ActionId> ids) {
    for (const ActionId id : ids) menu->addAction(m_actions.at(id));
    menu->addSeparator();
  };
  if (there.valid()) {
    add({ActionId::kRename, ActionId::kNote, ActionId::kNumbers, ActionId::kColour});
    add({ActionId::kDuplicate, ActionId::kCopyToPictures, ActionId::kGroup, ActionId::kUngroup, ActionId::kHide, ActionId::kLock, ActionId::kEndsDiffer});
    add({ActionId::kAddToWorld, ActionId::kAddKeepOut, ActionId::kDelete});
  } else {
    add({ActionId::kToolPoint, ActionId::kToolLine, ActionId::kToolPipe, ActionId::kToolPlane, ActionId::kToolTriad, ActionId::kToolMeasure});
    add({ActionId::kSelectAll, ActionId::kFitPictures, ActionId::kFullSize, ActionId::kUndistort});
  }
  menu->popup(global_position);
}

}  // namespace longarm::ui
