#pragma once

/// @file
/// MacroForm: the parameters of one motion, in the units an operator reads.

#include <map>
#include <optional>

#include <QWidget>

#include "session/controllers/plan_controller.h"

class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QLabel;
class QToolButton;

namespace longarm::ui {

/// Millimetres, degrees and mm/s for what the macro counts in metres, radians and m/s.
struct ShownUnit {
  double factor = 1;                       ///< Shown = factor * value.
  QString suffix;
  int decimals = 2;
  double step = 0.05;
};
ShownUnit shownUnit(const planning::MacroParameter& parameter);

/// Writes each change to the controller at once, which refuses what is beyond a limit.  GUI thread only.
class MacroForm final : public QWidget {
  Q_OBJECT

 public:
  explicit MacroForm(session::PlanController& plans, QWidget* parent = nullptr);

  /// The macro whose parameters are shown; nothing: none.
  void setMacro(const std::optional<session::MacroRow>& row);
  QString macro() const { return m_row ? m_row->name : QString(); }
  QDoubleSpinBox* number(const QString& parameter) const;      ///< Null if there is none.
  QComboBox* choice(const QString& parameter) const;
  QToolButton* defaultsButton() const { return m_defaults; }

 Q_SIGNALS:
  void edited(const QString& macro);               ///< By the operator.

 private:
  void rebuild();
  QWidget* editorOf(const planning::MacroParameter& parameter);
  void showValues();
  void write(const planning::MacroParameter& parameter, double value);

  session::PlanController& m_plans;
  std::optional<session::MacroRow> m_row;
  QLabel* m_title;
  QWidget* m_rows = nullptr;
  QToolButton* m_defaults;
  std::map<std::string, QDoubleSpinBox*> m_numbers;
  std::map<std::string, QComboBox*> m_choices;
};

}  // namespace longarm::ui
