#pragma once

/// @file
/// FeatureTable: the feature list as a Qt table model.

#include <vector>

#include <QAbstractTableModel>

#include "session/controllers/targeting_controller.h"
#include "ui/appearance.h"

namespace longarm::ui {

/// Rows are the document's features in list order.  Only the name can be edited.  GUI thread only.
class FeatureTable final : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { kName, kPosition, kPlusMinus, kLength, kMiss, kShown, kLocked, kColumns };

  FeatureTable(session::TargetingController& targeting, Appearance& appearance, QObject* parent = nullptr);
  const session::FeatureRow& row(int index) const { return m_rows[static_cast<std::size_t>(index)]; }

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  Qt::ItemFlags flags(const QModelIndex& index) const override;
  bool setData(const QModelIndex& index, const QVariant& value, int role) override;

 private:
  void refresh();
  QString text(const session::FeatureRow& row, int column) const;
  QString tip(const session::FeatureRow& row, int column) const;
  QVariant mark(const session::FeatureRow& row, int column) const;

  session::TargetingController& m_targeting;
  Appearance& m_appearance;
  std::vector<session::FeatureRow> m_rows;
};

}  // namespace longarm::ui
