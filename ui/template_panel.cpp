#include "ui/template_panel.h"

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QVBoxLayout>

#include "ui/elided_label.h"

namespace longarm::ui {
namespace {

// As the operator reads sizes: millimetres and degrees.
double factorOf(const std::string& unit) {
  if (unit == "m") return 1000;
  return unit == "rad" ? 57.29577951308232 : 1;
}

QString suffixOf(const std::string& unit) {
  if (unit == "m") return QStringLiteral(" mm");
  return unit == "rad" ? QStringLiteral(" \u00b0") : QString();
}

QString spoken(const std::string& name) { return QString::fromStdString(name).replace(QLatin1Char('_'), QLatin1Char(' ')); }

}  // namespace

TemplatePanel::TemplatePanel(Workbench& bench, QWidget* parent) : QWidget(parent), m_bench(bench) {
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(6, 4, 6, 4);
  auto* left = new QVBoxLayout;
  row->addLayout(left, 1);
  auto* first = new QHBoxLayout;
  m_kinds = new QComboBox(this);
  m_kinds->setToolTip(tr("What stands there: it is dropped onto the selected plane, box, line or point"));
  m_drop = new QPushButton(tr("Drop"), this);
  first->addWidget(m_kinds, 1);
  first->addWidget(m_drop);
  left->addLayout(first);
  auto* second = new QHBoxLayout;
  m_dropped = new QComboBox(this);
  m_dropped->setToolTip(tr("The templates that were dropped; sizes and actions are of this one"));
  m_remove = new QPushButton(tr("Remove"), this);
  second->addWidget(m_dropped, 1);
  second->addWidget(m_remove);
  left->addLayout(second);
  m_actions = new QWidget(this);
  new QHBoxLayout(m_actions);
  m_actions->layout()->setContentsMargins(0, 0, 0, 0);
  left->addWidget(m_actions);
  m_message = new QLabel(this);
  m_message->setWordWrap(true);
  left->addWidget(m_message);
  m_cancel = new QPushButton(tr("End action"), this);
  m_cancel->setToolTip(tr("Goes on with no further step; moves nothing"));
  left->addWidget(m_cancel);
  left->addStretch(1);
  auto* area = new QScrollArea(this);
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  area->setMinimumWidth(200);
  m_form = new QWidget;
  new QFormLayout(m_form);
  m_form->layout()->setContentsMargins(0, 0, 0, 0);
  area->setWidget(m_form);
  row->addWidget(area, 1);
  for (auto* each : {m_drop, m_remove, m_cancel}) each->setFocusPolicy(Qt::TabFocus);
  connect(m_drop, &QPushButton::clicked, this, &TemplatePanel::drop);
  connect(m_remove, &QPushButton::clicked, this, [this] { m_bench.world().remove({chosen()}); });
  connect(m_cancel, &QPushButton::clicked, &m_bench.templates(), &session::TemplateController::cancel);
  connect(m_kinds, qOverload<int>(&QComboBox::activated), this, &TemplatePanel::refreshActions);
  connect(m_dropped, qOverload<int>(&QComboBox::activated), this, &TemplatePanel::refresh);
  connect(&m_bench.templates(), &session::TemplateController::changed, this, &TemplatePanel::refresh);
  connect(&m_bench.targeting(), &session::TargetingController::featuresChanged, this, &TemplatePanel::refreshActions);
  refresh();
}

WorldItemId TemplatePanel::chosen() const { return {m_dropped->currentData().toULongLong()}; }

QPushButton* TemplatePanel::actionButton(const QString& name) const { return m_actions->findChild<QPushButton*>(name); }

void TemplatePanel::refresh() {
  refreshKinds();
  refreshDropped();
  refreshForm();
  refreshActions();
}

void TemplatePanel::refreshKinds() {
  const auto& templates = m_bench.templates().templates();
  if (m_kinds->count() == static_cast<int>(templates.size())) return;
  m_kinds->clear();
  for (const auto& each : templates) {
    m_kinds->addItem(QString::fromStdString(each.title()), QString::fromStdString(each.name()));
    m_kinds->setItemData(m_kinds->count() - 1, QString::fromStdString(each.description()), Qt::ToolTipRole);
  }
}

// What was dropped last is what is worked on.
void TemplatePanel::refreshDropped() {
  const WorldItemId before = chosen();
  const int count = m_dropped->count();
  m_dropped->clear();
  for (const auto& item : m_bench.world().items()) {
    if (item.kind != session::WorldKind::kTemplate) continue;
    m_dropped->addItem(QString::fromStdString(item.name), QVariant::fromValue<qulonglong>(item.id.value));
  }
  const int same = m_dropped->findData(QVariant::fromValue<qulonglong>(before.value));
  m_dropped->setCurrentIndex(same >= 0 && m_dropped->count() <= count ? same : m_dropped->count() - 1);
}

void TemplatePanel::refreshForm() {
  const auto* item = m_bench.document().worldItem(chosen());
  const auto* what = item != nullptr ? m_bench.templates().templateOf(*item) : nullptr;
  auto* form = static_cast<QFormLayout*>(m_form->layout());
  if (what == nullptr || m_shown != item->id) {
    while (form->rowCount() > 0) form->removeRow(0);
    m_shown = {};
  }
  if (what == nullptr) return;
  const bool build = !m_shown.valid();
  m_shown = item->id;
  for (const auto& parameter : what->parameters()) {
    const double factor = factorOf(parameter.unit);
    QDoubleSpinBox* box = m_form->findChild<QDoubleSpinBox*>(QString::fromStdString(parameter.name));
    if (build) {
      box = new QDoubleSpinBox(m_form);
      box->setObjectName(QString::fromStdString(parameter.name));
      box->setRange(factor * parameter.lower, factor * parameter.upper);
      box->setDecimals(factor == 1 ? 2 : 1);
      box->setSuffix(suffixOf(parameter.unit));
      box->setKeyboardTracking(false);
      box->setToolTip(QString::fromStdString(parameter.description));
      box->setFocusPolicy(Qt::StrongFocus);
      form->addRow(spoken(parameter.name), box);
      connect(box, qOverload<double>(&QDoubleSpinBox::valueChanged), this, [this, name = parameter.name, factor](double value) {
        const Status set = m_bench.templates().setParameter(chosen(), name, value / factor);
        if (!set) m_bench.say(QString::fromStdString(set.error().message));
      });
    }
    const QSignalBlocker quiet(box);
    box->setValue(factor * item->parameters.at(parameter.name));
  }
}

void TemplatePanel::refreshActions() {
  auto& templates = m_bench.templates();
  const QString why = templates.whyNotDrop(m_kinds->currentData().toString());
  m_drop->setEnabled(why.isEmpty());
  m_drop->setToolTip(why.isEmpty() ? tr("Stands it where the selected feature was marked (Ctrl+Z takes it back)") : why);
  const bool any = chosen().valid();
  m_remove->setEnabled(any);
  m_remove->setToolTip(any ? tr("Takes it out of the world (Ctrl+Z brings it back)") : tr("Nothing was dropped yet."));
  const auto rows = templates.actions(chosen());
  for (auto* button : m_actions->findChildren<QPushButton*>()) {
    const bool kept = std::any_of(rows.begin(), rows.end(), [&](const auto& row) { return row.name == button->objectName(); });
    if (!kept) delete button;
  }
  for (const auto& action : rows) {
    auto* button = actionButton(action.name);
    if (button == nullptr) {
      button = new QPushButton(action.title, m_actions);
      button->setObjectName(action.name);
      button->setFocusPolicy(Qt::TabFocus);
      m_actions->layout()->addWidget(button);
      connect(button, &QPushButton::clicked, this, [this, name = action.name] {
        const Status begun = m_bench.beginTemplate(chosen(), name);
        if (!begun) m_bench.say(QString::fromStdString(begun.error().message));
      });
    }
    QString not_now = action.why_not;
    if (not_now.isEmpty()) not_now = m_bench.whyNotPlan();
    button->setEnabled(not_now.isEmpty());
    button->setToolTip(not_now.isEmpty() ? action.description : not_now);
  }
  m_cancel->setVisible(templates.running());
  m_message->setText(templates.running() ? templates.progress() : (any ? QString() : tr("Mark a door's face, drop the door onto it, and open it.")));
}

void TemplatePanel::drop() {
  const Status dropped = m_bench.templates().drop(m_kinds->currentData().toString());
  if (!dropped) m_bench.say(QString::fromStdString(dropped.error().message));
}

}  // namespace longarm::ui
