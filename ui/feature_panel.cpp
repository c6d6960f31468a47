#include "ui/feature_panel.h"

#include <QHeaderView>
#include <QLabel>
#include <QTableView>
#include <QVBoxLayout>

namespace longarm::ui {

FeaturePanel::FeaturePanel(session::TargetingController& targeting, Actions& actions, Appearance& appearance, QWidget* parent)
    : QWidget(parent), m_targeting(targeting), m_table(new FeatureTable(targeting, appearance, this)), m_view(new QTableView(this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(3, 3, 3, 3);
  buildView();
  column->addWidget(m_view);
  for (const auto id : {ActionId::kRename, ActionId::kNote, ActionId::kNumbers, ActionId::kColour, ActionId::kHide, ActionId::kLock,
                        ActionId::kGroup, ActionId::kUngroup, ActionId::kDuplicate, ActionId::kCopyToPictures, ActionId::kAddToWorld, ActionId::kDelete}) {
    m_view->addAction(actions.at(id));
  }
  m_view->setContextMenuPolicy(Qt::ActionsContextMenu);
  connect(actions.at(ActionId::kRename), &QAction::triggered, this, &FeaturePanel::editName);
  m_empty = new QLabel(tr("Nothing is sketched yet.\nChoose the line tool (N) and mark both ends in both pictures."), m_view->viewport());
  m_empty->setAlignment(Qt::AlignCenter);
  m_empty->setWordWrap(true);
  m_empty->setObjectName(QStringLiteral("muted"));
  m_empty->setAttribute(Qt::WA_TransparentForMouseEvents);
  m_view->viewport()->installEventFilter(this);
  connect(&m_targeting, &session::TargetingController::featuresChanged, this, [this] {
    refreshEmpty();
    showSelection();
  });
  connect(m_view->selectionModel(), &QItemSelectionModel::selectionChanged, this, &FeaturePanel::takeSelection);
  connect(m_view, &QTableView::clicked, this, &FeaturePanel::onClicked);
  refreshEmpty();
  showSelection();
}

void FeaturePanel::buildView() {
  m_view->setModel(m_table);
  m_view->setSelectionBehavior(QAbstractItemView::SelectRows);
  m_view->setSelectionMode(QAbstractItemView::ExtendedSelection);
  m_view->setEditTriggers(QAbstractItemView::DoubleClicked);
  m_view->setShowGrid(false);
  m_view->setAlternatingRowColors(true);
  m_view->setWordWrap(false);
  m_view->setIconSize({16, 16});
  m_view->verticalHeader()->hide();
  m_view->verticalHeader()->setDefaultSectionSize(24);
  auto* header = m_view->horizontalHeader();
  header->setHighlightSections(false);
  header->setSectionResizeMode(QHeaderView::ResizeToContents);
  header->setSectionResizeMode(FeatureTable::kName, QHeaderView::Stretch);
  header->setMinimumSectionSize(30);
  for (const int narrow : {FeatureTable::kShown, FeatureTable::kLocked}) {
    header->setSectionResizeMode(narrow, QHeaderView::Fixed);
    header->resizeSection(narrow, 30);
  }
}

void FeaturePanel::editName() {
  const auto primary = m_targeting.document().selection().primary;
  const int row = m_targeting.document().indexOf(primary);
  if (row >= 0) m_view->edit(m_table->index(row, FeatureTable::kName));
}

void FeaturePanel::showSelection() {
  m_following = true;
  QItemSelection selection;
  for (int i = 0; i < m_table->rowCount(); ++i) {
    if (m_table->row(i).selected) selection.select(m_table->index(i, 0), m_table->index(i, FeatureTable::kColumns - 1));
    if (m_table->row(i).primary) m_view->selectionModel()->setCurrentIndex(m_table->index(i, 0), QItemSelectionModel::NoUpdate);
  }
  m_view->selectionModel()->select(selection, QItemSelectionModel::ClearAndSelect);
  m_following = false;
}

void FeaturePanel::takeSelection() {
  if (m_following) return;
  session::Selection selection;
  for (const auto& index : m_view->selectionModel()->selectedRows()) {
    selection.items.insert(m_table->row(index.row()).id);
    selection.primary = m_table->row(index.row()).id;
  }
  const auto current = m_view->selectionModel()->currentIndex();
  if (current.isValid() && selection.contains(m_table->row(current.row()).id)) selection.primary = m_table->row(current.row()).id;
  m_targeting.select(selection);
}

void FeaturePanel::onClicked(const QModelIndex& index) {
  const auto row = m_table->row(index.row());
  if (index.column() == FeatureTable::kShown) m_targeting.setHidden(row.id, !row.hidden);
  if (index.column() == FeatureTable::kLocked) m_targeting.setLocked(row.id, !row.locked);
}

void FeaturePanel::refreshEmpty() {
  m_empty->setVisible(m_table->rowCount() == 0);
  m_empty->setGeometry(m_view->viewport()->rect());
}

bool FeaturePanel::eventFilter(QObject* watched, QEvent* event) {
  if (event->type() == QEvent::Resize) refreshEmpty();
  return QWidget::eventFilter(watched, event);
}

}  // namespace longarm::ui
