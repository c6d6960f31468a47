#include "ui/macro_panel.h"

#include <algorithm>

#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QStyle>
#include <QToolButton>
#include <QVBoxLayout>

#include "widgets/icon.h"

namespace longarm::ui {

namespace {

constexpr int kColumns = 3;

// Macros that have an action of their own, with menu and keys.
const std::map<QString, ActionId>& actionsOfMacros() {
  static const std::map<QString, ActionId> table = {{QStringLiteral("grab_pipe"), ActionId::kGrabPipe},
                                                    {QStringLiteral("home"), ActionId::kHome},
                                                    {QStringLiteral("stow"), ActionId::kStow},
                                                    {QStringLiteral("ready"), ActionId::kReady},
                                                    {QStringLiteral("look_ahead"), ActionId::kLookAhead}};
  return table;
}

QString iconOf(const session::MacroRow& row) {
  if (row.name == QLatin1String("grab_pipe")) return QStringLiteral("macro-grab-pipe");
  if (row.name == QLatin1String("home")) return QStringLiteral("robot-home");
  return QStringLiteral("macro-run");
}

}  // namespace

MacroPanel::MacroPanel(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent)
    : QWidget(parent), m_bench(bench), m_actions(actions), m_appearance(appearance) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(6, 6, 6, 6);
  column->setSpacing(5);
  m_target = new QLabel(this);
  m_target->setTextFormat(Qt::PlainText);
  m_target->setWordWrap(true);
  column->addWidget(m_target);
  m_grid = new QGridLayout;
  m_grid->setSpacing(5);
  for (int i = 0; i < kColumns; ++i) m_grid->setColumnStretch(i, 1);
  column->addLayout(m_grid);
  m_outcome = new QLabel(this);
  m_outcome->setTextFormat(Qt::PlainText);
  m_outcome->setWordWrap(true);
  m_outcome->setAlignment(Qt::AlignTop | Qt::AlignLeft);
  column->addWidget(m_outcome, 1);
  auto* row = new QHBoxLayout;
  for (const auto id : {ActionId::kReplan, ActionId::kDiscardPlan}) {
    auto* button = new QToolButton(this);
    button->setDefaultAction(actions.at(id));
    button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    button->setIconSize({18, 18});
    button->setFocusPolicy(Qt::TabFocus);
    row->addWidget(button);
  }
  row->addStretch(1);
  column->addLayout(row);
  bindActions();
  refresh();
}

void MacroPanel::bindActions() {
  auto& plans = m_bench.plans();
  connect(&plans, &session::PlanController::macrosChanged, this, &MacroPanel::refresh);
  connect(&plans, &session::PlanController::stateChanged, this, &MacroPanel::refresh);
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, &MacroPanel::refresh);
  connect(&m_bench.robot(), &RobotSession::playerChanged, this, &MacroPanel::refresh);
  connect(&m_bench.robot(), &RobotSession::attached, this, &MacroPanel::refresh);
  connect(&m_bench.play(), &session::PlayController::changed, this, &MacroPanel::refreshPlan);
  connect(&m_bench.targeting(), &session::TargetingController::planChanged, this, &MacroPanel::refreshPlan);
  connect(&m_appearance, &Appearance::changed, this, &MacroPanel::applyTheme);
  for (const auto& [macro, id] : actionsOfMacros()) {
    connect(m_actions.at(id), &QAction::triggered, this, [this, name = macro] { m_bench.plan(name); });
  }
  connect(m_actions.at(ActionId::kReplan), &QAction::triggered, &m_bench, &Workbench::replan);
  connect(m_actions.at(ActionId::kDiscardPlan), &QAction::triggered, &plans, &session::PlanController::discard);
  connect(m_actions.at(ActionId::kCancelPlanning), &QAction::triggered, &plans, &session::PlanController::cancel);
}

QPushButton* MacroPanel::button(const QString& macro) const {
  const auto found = m_buttons.find(macro);
  return found == m_buttons.end() ? nullptr : found->second;
}

void MacroPanel::rebuild(const std::vector<session::MacroRow>& rows) {
  for (const auto& [name, each] : m_buttons) each->deleteLater();
  m_buttons.clear();
  int place = 0;
  auto ordered = rows;
  std::stable_partition(ordered.begin(), ordered.end(), [](const session::MacroRow& row) { return row.takes.has_value(); });
  for (const auto& row : ordered) {
    auto* button = new QPushButton(row.title, this);
    button->setProperty("action_icon", iconOf(row));
    button->setIconSize({20, 20});
    button->setFocusPolicy(Qt::TabFocus);
    connect(button, &QPushButton::clicked, this, [this, name = row.name] { m_bench.plan(name); });
    m_grid->addWidget(button, place / kColumns, place % kColumns);
    m_buttons[row.name] = button;
    ++place;
  }
  applyTheme();
}

void MacroPanel::refresh() {
  const auto rows = m_bench.plans().macros();
  bool same = rows.size() == m_buttons.size();
  for (const auto& row : rows) same = same && button(row.name) != nullptr;
  if (!same) rebuild(rows);
  const QString busy = m_bench.whyNotPlan();
  for (const auto& [macro, id] : actionsOfMacros()) {
    if (button(macro) == nullptr) m_actions.setWhyNot(id, tr("This workcell has no such motion."));
  }
  for (const auto& row : rows) {
    const QString why = busy.isEmpty() ? row.reason : busy;
    QPushButton* shown = button(row.name);
    shown->setEnabled(why.isEmpty());
    const QString tip = row.description + QLatin1Char('\n') + (why.isEmpty() ? tr("Plans and shows; nothing moves before Play.") : tr("Not now: %1").arg(why));
    shown->setToolTip(tip.toHtmlEscaped().replace(QLatin1Char('\n'), QLatin1String("<br>")));
    const auto action = actionsOfMacros().find(row.name);
    if (action != actionsOfMacros().end()) m_actions.setWhyNot(action->second, why);
  }
  const auto* item = m_bench.document().item(m_bench.document().selection().primary);
  m_target->setText(item != nullptr ? tr("With the selected %1 \u201c%2\u201d:")
                                          .arg(QString::fromLatin1(vision::toString(item->kind)), QString::fromStdString(item->name))
                                    : tr("Nothing is selected: canned motions."));
  refreshPlan();
}

void MacroPanel::refreshPlan() {
  const bool planning = m_bench.plans().state() == session::PlanController::State::kPlanning;
  m_actions.setWhyNot(ActionId::kCancelPlanning, planning ? QString() : tr("Nothing is being planned."));
  const auto& record = m_bench.document().plan();
  const QString none = record ? QString() : tr("There is no plan.");
  m_actions.setWhyNot(ActionId::kDiscardPlan, m_bench.play().state().playing ? tr("The arm is moving along it.") : none);
  m_actions.setWhyNot(ActionId::kReplan, none.isEmpty() ? m_bench.whyNotPlan() : none);
  if (!record || planning) {
    m_outcome->setText(planning ? tr("Planning %1 ...").arg(m_bench.plans().planning()) : tr("A motion is shown first, and moves only by Play."));
    return;
  }
  const auto& plan = record->plan;
  QStringList lines;
  if (!plan.ok()) {
    lines << tr("Refused: %1").arg(QString::fromStdString(plan.reason));
  } else {
    lines << tr("%1 s, clearance %2 mm, planned in %3 s.").arg(QString::number(plan.trajectory.duration(), 'f', 1),
        QString::number(plan.min_clearance * 1000, 'f', 0), QString::number(plan.planning_seconds, 'f', 2));
    if (plan.go != "go") lines << QString::fromStdString(plan.accuracy_note);
    for (const auto& note : plan.notes) lines << QString::fromStdString(note);
  }
  m_outcome->setText(lines.join(QLatin1Char('\n')));
  m_outcome->setToolTip(m_outcome->text().toHtmlEscaped().replace(QLatin1Char('\n'), QLatin1String("<br>")));
}

void MacroPanel::applyTheme() {
  for (const auto& [name, each] : m_buttons) each->setIcon(widgets::icon(each->property("action_icon").toString(), m_appearance.theme()));
}

}  // namespace longarm::ui
