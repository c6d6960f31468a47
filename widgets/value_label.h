#pragma once

/// @file
/// ValueLabel: a number with unit in a field that does not jump.

#include <optional>

#include <QLabel>

namespace longarm::widgets {

/// Shows "12.3 mm", or a dash when there is no value.  The point is always "." and the width fits `widest`.
class ValueLabel final : public QLabel {
  Q_OBJECT

 public:
  ValueLabel(const QString& unit, int decimals, double widest, QWidget* parent = nullptr);
  void setValue(std::optional<double> value);
  std::optional<double> value() const { return m_value; }

 private:
  QString m_unit;
  int m_decimals;
  std::optional<double> m_value;
};

}  // namespace longarm::widgets
