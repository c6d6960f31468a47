#include "widgets/value_label.h"

namespace longarm::widgets {

ValueLabel::ValueLabel(const QString& unit, int decimals, double widest, QWidget* parent)
    : QLabel(parent), m_unit(unit), m_decimals(decimals) {
  setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  setTextFormat(Qt::PlainText);
  setValue(widest);
  setMinimumWidth(sizeHint().width());
  setValue({});
}

void ValueLabel::setValue(std::optional<double> value) {
  m_value = value;
  setText(value ? QString::number(*value, 'f', m_decimals) + QLatin1Char(' ') + m_unit : QStringLiteral("–"));
}

}  // namespace longarm::widgets
