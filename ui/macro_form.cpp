#include "ui/macro_form.h"

#include <algorithm>
#include <cmath>

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QToolButton>
#include <QVBoxLayout>

namespace longarm::ui {

namespace {

constexpr double kEqual = 1e-9;

// "stand_off": "Stand off"
QString titleOf(const std::string& name) {
  QString title = QString::fromStdString(name).replace(QLatin1Char('_'), QLatin1Char(' '));
  if (!title.isEmpty()) title[0] = title[0].toUpper();
  return title;
}

}  // namespace

ShownUnit shownUnit(const planning::MacroParameter& parameter) {
  if (parameter.unit == "m") return {1000, QStringLiteral(" mm"), 1, 5};
  if (parameter.unit == "m/s") return {1000, QStringLiteral(" mm/s"), 0, 5};
  if (parameter.unit == "rad") return {180 / M_PI, QStringLiteral(" \u00b0"), 1, 5};
  if (parameter.unit == "choice") return {1, {}, 0, 1};
  return {1, {}, 2, 0.05};
}

MacroForm::MacroForm(session::PlanController& plans, QWidget* parent) : QWidget(parent), m_plans(plans) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(3);
  auto* head = new QHBoxLayout;
  m_title = new QLabel(this);
  m_title->setTextFormat(Qt::PlainText);
  m_title->setWordWrap(true);
  m_defaults = new QToolButton(this);
  m_defaults->setText(tr("Defaults"));
  m_defaults->setToolTip(tr("Put every value back to its default"));
  m_defaults->setFocusPolicy(Qt::TabFocus);
  head->addWidget(m_title, 1);
  head->addWidget(m_defaults, 0, Qt::AlignTop);
  column->addLayout(head);
  auto* area = new QScrollArea(this);
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  column->addWidget(area, 1);
  m_rows = new QWidget;
  area->setWidget(m_rows);
  connect(m_defaults, &QToolButton::clicked, this, [this] {
    m_plans.resetArguments(macro());
    Q_EMIT edited(macro());
  });
  connect(&m_plans, &session::PlanController::argumentsChanged, this, &MacroForm::showValues);
  rebuild();
}

void MacroForm::setMacro(const std::optional<session::MacroRow>& row) {
  const bool same = row.has_value() == m_row.has_value() && (!row || row->name == m_row->name);
  m_row = row;
  if (!same) return rebuild();
  showValues();                            // defaults that follow the robot have gone on
}

QDoubleSpinBox* MacroForm::number(const QString& parameter) const {
  const auto found = m_numbers.find(parameter.toStdString());
  return found == m_numbers.end() ? nullptr : found->second;
}

QComboBox* MacroForm::choice(const QString& parameter) const {
  const auto found = m_choices.find(parameter.toStdString());
  return found == m_choices.end() ? nullptr : found->second;
}

void MacroForm::rebuild() {
  m_numbers.clear();
  m_choices.clear();
  qDeleteAll(m_rows->findChildren<QWidget*>(QString(), Qt::FindDirectChildrenOnly));
  delete m_rows->layout();
  auto* form = new QFormLayout(m_rows);
  form->setContentsMargins(0, 0, 2, 0);
  form->setVerticalSpacing(3);
  form->setHorizontalSpacing(6);
  const bool any = m_row && !m_row->parameters.empty();
  m_title->setText(any ? m_row->title : m_row ? tr("%1 has nothing to set.").arg(m_row->title) : tr("Choose a motion to see what can be set."));
  m_defaults->setVisible(any);
  if (!any) return;
  for (const auto& parameter : m_row->parameters) form->addRow(titleOf(parameter.name), editorOf(parameter));
  showValues();
}

QWidget* MacroForm::editorOf(const planning::MacroParameter& parameter) {
  const ShownUnit unit = shownUnit(parameter);
  const QString tip = QString::fromStdString(parameter.description);
  if (!parameter.choices.empty()) {
    auto* box = new QComboBox(m_rows);
    for (const auto& choice : parameter.choices) box->addItem(QString::fromStdString(choice));
    box->setToolTip(tip);
    connect(box, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this, parameter](int index) { write(parameter, parameter.lower + index); });
    m_choices[parameter.name] = box;
    return box;
  }
  auto* box = new QDoubleSpinBox(m_rows);
  box->setDecimals(unit.decimals);
  box->setRange(parameter.lower * unit.factor, parameter.upper * unit.factor);
  box->setSingleStep(unit.step);
  box->setSuffix(unit.suffix);
  box->setKeyboardTracking(false);
  const auto shown = [&](double value) { return QString::number(value * unit.factor, 'f', unit.decimals); };
  box->setToolTip(tr("%1 %2 to %3%4, by default %5").arg(tip, shown(parameter.lower), shown(parameter.upper), unit.suffix, shown(parameter.value)));
  connect(box, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, [this, parameter, unit](double value) {
    write(parameter, std::clamp(value / unit.factor, parameter.lower, parameter.upper));
  });
  m_numbers[parameter.name] = box;
  return box;
}

void MacroForm::write(const planning::MacroParameter& parameter, double value) {
  const Status set = m_plans.setArgument(macro(), QString::fromStdString(parameter.name), value);
  if (!set) return showValues();
  Q_EMIT edited(macro());
}

void MacroForm::showValues() {
  if (!m_row) return;
  bool differs = false;
  const auto values = m_plans.arguments(m_row->name);
  for (const auto& parameter : m_row->parameters) {
    const auto found = values.find(parameter.name);
    if (found == values.end()) continue;
    differs = differs || std::abs(found->second - parameter.value) > kEqual;
    if (auto* box = number(QString::fromStdString(parameter.name))) {
      const QSignalBlocker quiet(box);
      box->setValue(found->second * shownUnit(parameter).factor);
    }
    if (auto* box = choice(QString::fromStdString(parameter.name))) {
      const QSignalBlocker quiet(box);
      box->setCurrentIndex(static_cast<int>(std::lround(found->second - parameter.lower)));
    }
  }
  m_defaults->setEnabled(differs);
}

}  // namespace longarm::ui
