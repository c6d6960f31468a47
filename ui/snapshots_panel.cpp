#include "ui/snapshots_panel.h"

#include <QHBoxLayout>
#include <QImage>
#include <QListWidget>
#include <QToolButton>
#include <QVBoxLayout>
#include <opencv2/imgproc.hpp>

#include "ui/picture_text.h"
#include "widgets/picture_layer.h"

namespace longarm::ui {

using vision::PaneSide;

namespace {

constexpr int kThumbWidth = 96, kThumbHeight = 72;

}  // namespace

SnapshotsPanel::SnapshotsPanel(Workbench& bench, Appearance&, QWidget* parent)
    : QWidget(parent), m_bench(bench), m_list(new QListWidget(this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(3, 3, 3, 3);
  m_list->setViewMode(QListView::IconMode);
  m_list->setIconSize({kThumbWidth, kThumbHeight});
  m_list->setGridSize({kThumbWidth + 40, kThumbHeight + 44});
  m_list->setMovement(QListView::Static);
  m_list->setResizeMode(QListView::Adjust);
  m_list->setWordWrap(true);
  column->addWidget(m_list, 1);
  auto* row = new QHBoxLayout;
  column->addLayout(row);
  addButton(Button::kLeft, tr("Left"), tr("Show it in the left pane"));
  addButton(Button::kRight, tr("Right"), tr("Show it in the right pane"));
  addButton(Button::kThird, tr("Third"), tr("Show it beside the panes with both epipolar curves, or put it away"));
  addButton(Button::kPin, tr("Pin"), tr("Keep it from being deleted, or let it go"));
  addButton(Button::kCompare, tr("Compare"), tr("Fade between it and the left pane's picture"));
  addButton(Button::kDelete, tr("Delete"), tr("Delete it with every pick made in it (Ctrl+Z brings it back)"));
  for (const auto& [which, button] : m_buttons) row->addWidget(button);
  row->addStretch(1);
  auto& targeting = m_bench.targeting();
  connect(&targeting, &session::TargetingController::snapshotsChanged, this, &SnapshotsPanel::refresh);
  connect(&targeting, &session::TargetingController::panesChanged, this, &SnapshotsPanel::refresh);
  connect(&targeting, &session::TargetingController::thirdChanged, this, &SnapshotsPanel::refresh);
  connect(m_list, &QListWidget::currentRowChanged, this, &SnapshotsPanel::refreshButtons);
  connect(m_list, &QListWidget::itemDoubleClicked, this, [this] { act(Button::kLeft); });
  refresh();
}

void SnapshotsPanel::addButton(Button which, const QString& text, const QString& tip) {
  auto* button = new QToolButton(this);
  button->setText(text);
  button->setFocusPolicy(Qt::TabFocus);
  connect(button, &QToolButton::clicked, this, [this, which] { act(which); });
  m_buttons[which] = button;
  m_tips[which] = tip;
}

SnapshotId SnapshotsPanel::chosen() const {
  const auto* item = m_list->currentItem();
  return item == nullptr ? SnapshotId{} : SnapshotId{item->data(Qt::UserRole).toULongLong()};
}

const QIcon& SnapshotsPanel::thumbnail(const vision::Snapshot& snapshot) {
  const auto found = m_thumbnails.find(snapshot.id);
  if (found != m_thumbnails.end()) return found->second;
  cv::Mat small;
  const double scale = std::min(static_cast<double>(kThumbWidth) / snapshot.image.cols, static_cast<double>(kThumbHeight) / snapshot.image.rows);
  cv::resize(snapshot.image, small, cv::Size(), scale, scale, cv::INTER_AREA);
  return m_thumbnails[snapshot.id] = QIcon(QPixmap::fromImage(widgets::toQImage(small)));
}

QString SnapshotsPanel::caption(const vision::Snapshot& snapshot) const {
  QString text = QString::fromStdString(snapshot.view.name) + QLatin1Char('\n') + pictureTime(snapshot.wall_time_s);
  const auto& document = m_bench.document();
  QStringList marks;
  if (document.paneSnapshotId(PaneSide::kLeft) == snapshot.id) marks << tr("left");
  if (document.paneSnapshotId(PaneSide::kRight) == snapshot.id) marks << tr("right");
  if (m_bench.targeting().third() == snapshot.id) marks << tr("third");
  if (document.pinned(snapshot.id)) marks << tr("pinned");
  return marks.isEmpty() ? text : text + QStringLiteral(" ") + marks.join(QStringLiteral(", "));
}

void SnapshotsPanel::refresh() {
  const SnapshotId kept = chosen();
  m_list->clear();
  std::map<SnapshotId, QIcon> used;
  for (const auto& snapshot : m_bench.document().snapshots()) {
    used[snapshot->id] = thumbnail(*snapshot);
    auto* item = new QListWidgetItem(used[snapshot->id], caption(*snapshot), m_list);
    item->setData(Qt::UserRole, QVariant::fromValue<qulonglong>(snapshot->id.value));
    item->setToolTip(QString::fromStdString(snapshot->source == "live" ? snapshot->view.name : snapshot->source));
    if (snapshot->id == kept) m_list->setCurrentItem(item);
  }
  m_thumbnails = std::move(used);
  refreshButtons();
}

QString SnapshotsPanel::whyNot(Button which) const {
  const SnapshotId id = chosen();
  if (!id.valid()) return tr("Choose a picture in the list first.");
  const auto& document = m_bench.document();
  const SnapshotId left = document.paneSnapshotId(PaneSide::kLeft);
  switch (which) {
    case Button::kDelete: return document.pinned(id) ? tr("It is pinned: unpin it first.") : QString();
    case Button::kThird:
      return id == left || id == document.paneSnapshotId(PaneSide::kRight) ? tr("It is in a pane already: choose another picture as the third.") : QString();
    case Button::kCompare:
      if (!left.valid() || id == left) return tr("Choose a picture other than the left pane's.");
      return document.snapshot(id)->image.size() == document.snapshot(left)->image.size() ? QString() : tr("Pictures of different sizes cannot be laid over each other.");
    default: return {};
  }
}

void SnapshotsPanel::refreshButtons() {
  for (const auto& [which, button] : m_buttons) {
    const QString why = whyNot(which);
    button->setEnabled(why.isEmpty());
    button->setToolTip(why.isEmpty() ? m_tips.at(which) : m_tips.at(which) + QStringLiteral("\n") + tr("Not now: %1").arg(why));
  }
  m_buttons.at(Button::kPin)->setText(m_bench.document().pinned(chosen()) ? tr("Unpin") : tr("Pin"));
}

void SnapshotsPanel::act(Button which) {
  const SnapshotId id = chosen();
  if (!whyNot(which).isEmpty()) return;
  auto& targeting = m_bench.targeting();
  const auto& document = m_bench.document();
  switch (which) {
    case Button::kLeft: targeting.showSnapshot(PaneSide::kLeft, id); break;
    case Button::kRight: targeting.showSnapshot(PaneSide::kRight, id); break;
    case Button::kThird: targeting.setThird(targeting.third() == id ? SnapshotId{} : id); break;
    case Button::kPin: targeting.setPinned(id, !document.pinned(id)); break;
    case Button::kCompare: Q_EMIT compareRequested(document.paneSnapshot(PaneSide::kLeft), document.snapshot(id)); break;
    case Button::kDelete: targeting.removeSnapshot(id); break;
  }
}

}  // namespace longarm::ui
