#include "ui/feature_table.h"

#include <QColor>
#include <QFont>

#include "widgets/icon.h"

namespace longarm::ui {

FeatureTable::FeatureTable(session::TargetingController& targeting, Appearance& appearance, QObject* parent)
    : QAbstractTableModel(parent), m_targeting(targeting), m_appearance(appearance), m_rows(targeting.rows()) {
  connect(&m_targeting, &session::TargetingController::featuresChanged, this, &FeatureTable::refresh);
  connect(&m_appearance, &Appearance::changed, this, &FeatureTable::refresh);
}

void FeatureTable::refresh() {
  auto rows = m_targeting.rows();
  bool same = rows.size() == m_rows.size();
  for (std::size_t i = 0; same && i < rows.size(); ++i) same = rows[i].id == m_rows[i].id;
  if (same) {
    m_rows = std::move(rows);
    if (!m_rows.empty()) Q_EMIT dataChanged(index(0, 0), index(rowCount() - 1, kColumns - 1));
    return;
  }
  beginResetModel();
  m_rows = std::move(rows);
  endResetModel();
}

int FeatureTable::rowCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : static_cast<int>(m_rows.size()); }
int FeatureTable::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : kColumns; }

QString FeatureTable::text(const session::FeatureRow& row, int column) const {
  switch (column) {
    case kName: return QString::fromStdString(row.name);
    case kPosition:
      if (row.stale) return tr("stale");
      return row.measured ? QString::fromStdString(row.xyz_text) : tr("not measured yet");
    case kPlusMinus: return QString::fromStdString(row.plus_minus_text);
    case kLength: return QString::fromStdString(row.length_text);
    case kMiss: return QString::fromStdString(row.miss_text);
    default: return {};
  }
}

QString FeatureTable::tip(const session::FeatureRow& row, int column) const {
  if (column == kShown) return row.hidden ? tr("Hidden: click to show it") : tr("Shown: click to hide it");
  if (column == kLocked) return row.locked ? tr("Locked: click to let it be moved") : tr("Click to keep it from being moved");
  if (!row.measured) return QString::fromStdString(row.reason);
  QString text = tr("%1 (%2)").arg(QString::fromStdString(row.name), QString::fromLatin1(vision::toString(row.kind)));
  if (!row.size_text.empty()) text += QLatin1Char('\n') + QString::fromStdString(row.size_text);
  if (!row.note.empty()) text += QLatin1Char('\n') + QString::fromStdString(row.note);
  if (row.group != 0) text += QLatin1Char('\n') + tr("In group %1").arg(row.group);
  if (row.stale)
    text += QLatin1Char('\n') + tr("Stale: the base was driven since its pictures were taken. Re-register "
                                   "it, or mark it in new pictures.");
  for (const auto& warning : row.warnings) text += QLatin1Char('\n') + QString::fromStdString(warning);
  return text;
}

QVariant FeatureTable::mark(const session::FeatureRow& row, int column) const {
  const auto& theme = m_appearance.theme();
  if (column == kName) {
    const QString word = row.pipe ? QStringLiteral("pipe") : QString::fromLatin1(vision::toString(row.kind));
    if (!row.colour) return widgets::icon(QStringLiteral("tool-") + word, theme);
    widgets::Theme own = theme;
    own.text = own.on_selection = QColor::fromRgb(static_cast<QRgb>(*row.colour));
    return widgets::icon(QStringLiteral("tool-") + word, own);
  }
  if (column == kShown) return widgets::icon(row.hidden ? QStringLiteral("feature-hide") : QStringLiteral("feature-show"), theme);
  if (column == kLocked) return widgets::icon(row.locked ? QStringLiteral("feature-lock") : QStringLiteral("feature-unlock"), theme);
  return {};
}

QVariant FeatureTable::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || index.row() >= rowCount()) return {};
  const session::FeatureRow& shown = row(index.row());
  switch (role) {
    case Qt::DisplayRole:
      return text(shown, index.column());
    case Qt::EditRole: return text(shown, index.column());
    case Qt::ToolTipRole: return tip(shown, index.column()).toHtmlEscaped().replace(QLatin1Char('\n'), QLatin1String("<br>"));
    case Qt::DecorationRole: return mark(shown, index.column());
    case Qt::TextAlignmentRole:
      return int(index.column() == kName ? Qt::AlignLeft | Qt::AlignVCenter
                 : index.column() == kShown || index.column() == kLocked ? Qt::AlignCenter : Qt::AlignRight | Qt::AlignVCenter);
    case Qt::ForegroundRole:
      if (shown.stale) return m_appearance.theme().amber;
      return shown.hidden || !shown.measured ? QVariant(m_appearance.theme().muted) : QVariant();
    default: return {};
  }
}

QVariant FeatureTable::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal) return {};
  static const struct { const char *text, *tip; } heads[] = {
      {QT_TR_NOOP("Feature"), QT_TR_NOOP("Name; double-click or F2 to change it")},
      {QT_TR_NOOP("x, y, z mm"), QT_TR_NOOP("Point, or middle of a line, in the robot's frame")},
      {QT_TR_NOOP("\u00b1 mm"), QT_TR_NOOP("95 % along the worst direction")},
      {QT_TR_NOOP("Length, size"), QT_TR_NOOP("Between the two ends, with 95 % interval; a pipe's radius; a box's edges")},
      {QT_TR_NOOP("Miss mm"), QT_TR_NOOP("Distance between the two viewing rays; a growing miss is the first sign of a knocked camera")},
      {"", QT_TR_NOOP("Shown or hidden: click to change")},
      {"", QT_TR_NOOP("Locked or free to be moved: click to change")}};
  if (role == Qt::DisplayRole) return *heads[section].text == '\0' ? QString() : tr(heads[section].text);
  if (role == Qt::ToolTipRole) return tr(heads[section].tip);
  return {};
}

Qt::ItemFlags FeatureTable::flags(const QModelIndex& index) const {
  const auto base = QAbstractTableModel::flags(index);
  return index.column() == kName ? base | Qt::ItemIsEditable : base;
}

bool FeatureTable::setData(const QModelIndex& index, const QVariant& value, int role) {
  if (role != Qt::EditRole || index.column() != kName || value.toString().trimmed().isEmpty()) return false;
  m_targeting.rename(row(index.row()).id, value.toString());
  return true;
}

}  // namespace longarm::ui
