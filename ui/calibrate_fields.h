#pragma once

/// @file
/// Fields of the board wizard.

#include <QString>

class QDoubleSpinBox;
class QProgressBar;
class QSpinBox;
class QWidget;

namespace longarm::ui {

/// Shows a part of what is enough, 0 ... 1, with its own words on it.
void setBar(QProgressBar* bar, double part, const QString& text);
/// A length in millimetres.
QDoubleSpinBox* lengthBox(QWidget* parent, double value_mm, double least_mm);
/// A number of corners or circles.
QSpinBox* countBox(QWidget* parent, int value);

}  // namespace longarm::ui
