#include "ui/calibrate_fields.h"

#include <algorithm>
#include <cmath>

#include <QDoubleSpinBox>
#include <QProgressBar>
#include <QSpinBox>

namespace longarm::ui {

void setBar(QProgressBar* bar, double part, const QString& text) {
  bar->setValue(static_cast<int>(std::lround(100 * std::min(1.0, std::max(0.0, part)))));
  bar->setFormat(text);
}

QDoubleSpinBox* lengthBox(QWidget* parent, double value_mm, double least_mm) {
  auto* box = new QDoubleSpinBox(parent);
  box->setRange(least_mm, 2000);
  box->setDecimals(2);
  box->setSuffix(QStringLiteral(" mm"));
  box->setValue(value_mm);
  box->setKeyboardTracking(false);
  return box;
}

QSpinBox* countBox(QWidget* parent, int value) {
  auto* box = new QSpinBox(parent);
  box->setRange(3, 60);
  box->setValue(value);
  box->setKeyboardTracking(false);
  return box;
}

}  // namespace longarm::ui
