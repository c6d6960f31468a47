#include "ui/world_panel.h"

#include <algorithm>

#include <QComboBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QPushButton>
#include <QTableWidget>
#include <QToolButton>
#include <QVBoxLayout>

#include "core/text.h"

namespace longarm::ui {

using session::WorldItem;
using session::WorldKind;
using session::WorldRole;

WorldPanel::WorldPanel(Workbench& bench, Actions& actions, QWidget* parent)
    : QWidget(parent), m_bench(bench), m_table(new QTableWidget(this)), m_remove(new QPushButton(tr("Remove"), this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(3, 3, 3, 3);
  buildTable();
  column->addWidget(m_table, 1);
  actions.at(ActionId::kAddKeepOut)->setIconText(tr("Keep-out"));      // five buttons in half a small window
  actions.at(ActionId::kAddWorkspace)->setIconText(tr("Workspace"));
  actions.at(ActionId::kExportWorld)->setIconText(tr("Export..."));
  auto* row = new QHBoxLayout;
  for (const auto id : {ActionId::kAddToWorld, ActionId::kAddKeepOut, ActionId::kAddWorkspace, ActionId::kExportWorld}) {
    auto* button = new QToolButton(this);
    button->setDefaultAction(actions.at(id));
    button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    button->setFocusPolicy(Qt::TabFocus);
    row->addWidget(button);
  }
  m_remove->setFocusPolicy(Qt::TabFocus);
  row->addWidget(m_remove);
  row->addStretch(1);
  column->addLayout(row);
  connect(m_remove, &QPushButton::clicked, this, &WorldPanel::removeSelected);
  connect(m_table, &QTableWidget::cellChanged, this, &WorldPanel::edited);
  connect(m_table, &QTableWidget::itemSelectionChanged, this, &WorldPanel::refreshButtons);
  connect(&m_bench.world(), &session::WorldController::changed, this, &WorldPanel::refresh);
  refresh();
}

void WorldPanel::buildTable() {
  m_table->setColumnCount(kColumns);
  m_table->setHorizontalHeaderLabels({tr("Body"), tr("Kind"), tr("x mm"), tr("y mm"), tr("z mm"), tr("Margin mm"), tr("at x"), tr("at y"), tr("at z"),
                                      tr("Shown"), tr("Robot")});
  const char* tips[] = {QT_TR_NOOP("Name; double-click to change it"), QT_TR_NOOP("What it came from"),
                        QT_TR_NOOP("Edge of a box; diameter of a pipe or of points"), QT_TR_NOOP("Edge of a box"),
                        QT_TR_NOOP("Edge of a box, thickness of a slab, length of a pipe"),
                        QT_TR_NOOP("Plans keep this much more away: what the measurement does not know"), QT_TR_NOOP("Its middle in the robot's frame, mm"),
                        QT_TR_NOOP("Its middle in the robot's frame, mm"), QT_TR_NOOP("Its middle in the robot's frame, mm"),
                        QT_TR_NOOP("Drawn in pictures and scene"),
                        QT_TR_NOOP("What it is to the robot: kept clear of, planned through, never entered, or never left")};
  for (int i = 0; i < kColumns; ++i) m_table->horizontalHeaderItem(i)->setToolTip(tr(tips[i]));
  m_table->setSelectionBehavior(QAbstractItemView::SelectRows);
  m_table->setEditTriggers(QAbstractItemView::DoubleClicked);
  m_table->setShowGrid(false);
  m_table->verticalHeader()->hide();
  m_table->verticalHeader()->setDefaultSectionSize(24);
  m_table->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  m_table->horizontalHeader()->setSectionResizeMode(kName, QHeaderView::Stretch);
}

void WorldPanel::refresh() {
  m_filling = true;
  const auto& items = m_bench.world().items();
  m_table->setRowCount(static_cast<int>(items.size()));
  for (std::size_t i = 0; i < items.size(); ++i) fillRow(static_cast<int>(i), items[i]);
  m_filling = false;
  refreshButtons();
}

void WorldPanel::fillRow(int row, const WorldItem& item) {
  const auto number = [](double metres) { return QString::fromStdString(formatFixed(metres * 1000, 1)); };
  const bool round = item.kind == WorldKind::kPipe || item.kind == WorldKind::kPoints;   // one diameter
  const bool cloud = item.kind == WorldKind::kPoints, dropped = item.kind == WorldKind::kTemplate;
  const auto place = [&](int axis) { return cloud ? QString() : number(item.X_WO.translation()(axis)); };
  const bool stale = m_bench.document().stale(item);
  const QString kind = dropped ? QString::fromStdString(item.template_name) : QString::fromLatin1(session::toString(item.kind));
  const QString texts[] = {QString::fromStdString(item.name), kind + (stale ? tr(", stale") : QString()),
                           dropped ? QString() : number(item.size.x()), round || dropped ? QString() : number(item.size.y()),
                           cloud || dropped ? QString() : number(item.size.z()),
                           number(item.margin_m), place(0), place(1), place(2), {}, {}};
  for (int column = 0; column < kColumns; ++column) {
    auto* cell = new QTableWidgetItem(texts[column]);
    Qt::ItemFlags flags = Qt::ItemIsSelectable | Qt::ItemIsEnabled;
    if (column == kShown) {
      cell->setCheckState(item.hidden ? Qt::Unchecked : Qt::Checked);
      flags |= Qt::ItemIsUserCheckable;
    } else if (column != kKind && !texts[column].isEmpty()) {
      flags |= Qt::ItemIsEditable;
    }
    cell->setFlags(flags);
    if (column > kKind) cell->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
    m_table->setItem(row, column, cell);
  }
  addRoleBox(row, item);
}

void WorldPanel::addRoleBox(int row, const WorldItem& item) {
  auto* box = new QComboBox(m_table);
  box->addItem(tr("obstacle"), static_cast<int>(WorldRole::kObstacle));
  box->addItem(tr("drawn only"), static_cast<int>(WorldRole::kDrawn));
  box->addItem(tr("keep-out"), static_cast<int>(WorldRole::kKeepOut));
  if (item.kind == WorldKind::kBox) box->addItem(tr("workspace"), static_cast<int>(WorldRole::kWorkspace));
  box->setCurrentIndex(box->findData(static_cast<int>(item.role)));
  box->setFocusPolicy(Qt::TabFocus);
  box->setFrame(false);
  // Queued: the list is filled anew by what follows, and this box goes with it.
  connect(box, QOverload<int>::of(&QComboBox::activated), this, [this, box, id = item.id] {
    const auto& items = m_bench.world().items();
    const auto found = std::find_if(items.begin(), items.end(), [&](const WorldItem& other) { return other.id == id; });
    if (found == items.end()) return;
    WorldItem after = *found;
    after.role = static_cast<WorldRole>(box->currentData().toInt());
    apply(after);
  }, Qt::QueuedConnection);
  m_table->setCellWidget(row, kRole, box);
}

void WorldPanel::apply(const WorldItem& after) {
  const Status done = m_bench.world().edit(after);
  if (!done) m_bench.say(QString::fromStdString(done.error().message));
  refresh();
}

void WorldPanel::edited(int row, int column) {
  if (m_filling || row >= static_cast<int>(m_bench.world().items().size())) return;
  WorldItem after = m_bench.world().items()[static_cast<std::size_t>(row)];
  const QTableWidgetItem& cell = *m_table->item(row, column);
  const auto number = parseNumber(cell.text().toStdString());
  Status done;
  switch (column) {
    case kName: after.name = cell.text().trimmed().left(100).toStdString(); break;
    case kShown: after.hidden = cell.checkState() != Qt::Checked; break;
    case kRole: return;                  // its own box tells
    default:
      if (!number) done = {ErrorCode::kInvalidInput, "That is no number. The decimal point is a dot."};
      else if (column == kMargin) after.margin_m = *number / 1000;
      else if (column >= kAtX) after.X_WO.translation()(column - kAtX) = *number / 1000;
      else after.size(column - kSizeX) = *number / 1000;
  }
  // Diameters are one number, though a size has three.
  if (column == kSizeX && after.kind == WorldKind::kPipe) after.size.y() = after.size.x();
  if (column == kSizeX && after.kind == WorldKind::kPoints) after.size.setConstant(after.size.x());
  if (column == kName && after.name.empty()) done = {ErrorCode::kInvalidInput, "A body needs a name."};
  if (done) return apply(after);
  m_bench.say(QString::fromStdString(done.error().message));
  refresh();
}

std::vector<WorldItemId> WorldPanel::selected() const {
  std::vector<WorldItemId> ids;
  for (const auto& index : m_table->selectionModel()->selectedRows()) {
    ids.push_back(m_bench.world().items()[static_cast<std::size_t>(index.row())].id);
  }
  return ids;
}

void WorldPanel::refreshButtons() {
  const bool any = !m_table->selectionModel()->selectedRows().empty();
  m_remove->setEnabled(any);
  m_remove->setToolTip(any ? tr("Take the selected bodies out of the world (Ctrl+Z brings them back)") : tr("Select a body in the list first."));
}

void WorldPanel::removeSelected() { m_bench.world().remove(selected()); }

}  // namespace longarm::ui
