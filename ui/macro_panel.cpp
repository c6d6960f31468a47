#include "ui/macro_panel.h"

#include <algorithm>
#include <cmath>

#include <QEvent>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QScrollArea>
#include <QStyle>
#include <QToolButton>
#include <QVBoxLayout>

#include "widgets/icon.h"
#include "widgets/time_bar.h"

namespace longarm::ui {

namespace {

using Level = planning::ReachAnswer::Level;

constexpr int kMostColumns = 3;
constexpr int kForSigns = 16;              // Room for the sign of reach [px].
constexpr int kLeastButton = 48;           // The panel may get so narrow that names are cut [px].
constexpr int kReplanAfter_ms = 300;       // Steps of a value that follow one another plan once.

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

// "· ask": how well the feature is known decides more than a tooltip shows.
QString mark(const session::MacroRow& row) {
  if (row.go == QLatin1String("ask")) return MacroPanel::tr(" \u00b7 ask");
  if (row.go == QLatin1String("no_go")) return MacroPanel::tr(" \u00b7 no go");
  return {};
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
  column->addLayout(m_grid);
  m_outcome = new QLabel;
  m_outcome->setTextFormat(Qt::PlainText);
  m_outcome->setWordWrap(true);
  m_outcome->setAlignment(Qt::AlignTop | Qt::AlignLeft);
  auto* area = new QScrollArea(this);
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  area->setWidget(m_outcome);
  m_form = new MacroForm(bench.plans(), this);
  auto* middle = new QHBoxLayout;
  middle->setSpacing(8);
  middle->addWidget(area, 1);
  middle->addWidget(m_form, 1);
  column->addLayout(middle, 1);
  auto* row = new QHBoxLayout;
  for (const auto id : {ActionId::kReplan, ActionId::kOtherWay, ActionId::kDiscardPlan}) {
    auto* button = new QToolButton(this);
    button->setDefaultAction(actions.at(id));
    button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    button->setIconSize({18, 18});
    button->setFocusPolicy(Qt::TabFocus);
    row->addWidget(button);
  }
  row->addStretch(1);
  column->addLayout(row);
  m_replan.setSingleShot(true);
  m_replan.setInterval(kReplanAfter_ms);
  bindActions();
  refresh();
}

void MacroPanel::bindActions() {
  m_actions.at(ActionId::kDiscardPlan)->setIconText(tr("Discard"));     // on the button; the menu has room for more
  auto& plans = m_bench.plans();
  connect(&plans, &session::PlanController::macrosChanged, this, &MacroPanel::refresh);
  connect(&plans, &session::PlanController::stateChanged, this, &MacroPanel::refresh);
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, &MacroPanel::refresh);
  connect(&m_bench.robot(), &RobotSession::playerChanged, this, &MacroPanel::refresh);
  connect(&m_bench.robot(), &RobotSession::attached, this, &MacroPanel::refresh);
  connect(&m_bench.play(), &session::PlayController::changed, this, &MacroPanel::refreshPlan);
  connect(&m_bench.targeting(), &session::TargetingController::planChanged, this, &MacroPanel::refreshPlan);
  connect(&m_appearance, &Appearance::changed, this, &MacroPanel::applyTheme);
  connect(&m_bench, &Workbench::autoPlayChanged, this, &MacroPanel::refresh);
  connect(&m_bench.hand(), &session::PlayHand::changed, this, &MacroPanel::refresh);
  for (const auto& [macro, id] : actionsOfMacros()) {
    connect(m_actions.at(id), &QAction::triggered, this, [this, name = macro] { m_bench.plan(name); });
  }
  connect(m_actions.at(ActionId::kReplan), &QAction::triggered, &m_bench, &Workbench::replan);
  connect(m_actions.at(ActionId::kOtherWay), &QAction::triggered, &m_bench, &Workbench::planOtherWay);
  connect(&m_bench.reach(), &session::ReachController::changed, this, &MacroPanel::showReach);
  connect(&m_replan, &QTimer::timeout, &m_bench, &Workbench::replan);
  connect(m_form, &MacroForm::edited, this, &MacroPanel::replanIfShown);
  connect(m_actions.at(ActionId::kDiscardPlan), &QAction::triggered, &plans, &session::PlanController::discard);
  connect(m_actions.at(ActionId::kCancelPlanning), &QAction::triggered, &plans, &session::PlanController::cancel);
}

QPushButton* MacroPanel::button(const QString& macro) const {
  const auto found = m_buttons.find(macro);
  return found == m_buttons.end() ? nullptr : found->second;
}

QString MacroPanel::outcome() const { return m_outcome->text(); }

void MacroPanel::rebuild(const std::vector<session::MacroRow>& rows) {
  for (const auto& [name, each] : m_buttons) each->deleteLater();
  m_buttons.clear();
  m_laid_out.clear();
  for (const auto& row : rows) {
    auto* button = new QPushButton(row.title, this);
    button->setProperty("action_icon", iconOf(row));
    button->setProperty("macro", row.name);
    button->setIconSize({20, 20});
    button->setFocusPolicy(Qt::TabFocus);
    button->setMinimumWidth(kLeastButton);
    button->installEventFilter(this);
    button->hide();
    connect(button, &QPushButton::clicked, this, [this, name = row.name] {
      choose(name);
      m_bench.plan(name);
    });
    m_buttons[row.name] = button;
  }
  applyTheme();
}

// Tabbing to a motion shows its settings before anything is planned.
bool MacroPanel::eventFilter(QObject* watched, QEvent* event) {
  if (event->type() == QEvent::FocusIn) choose(watched->property("macro").toString());
  return QWidget::eventFilter(watched, event);
}

bool MacroPanel::offered(const session::MacroRow& row) const {
  const auto* item = m_bench.document().item(m_bench.document().selection().primary);
  return item != nullptr ? row.takes == item->kind : !row.takes.has_value();
}

void MacroPanel::layOut(const std::vector<session::MacroRow>& rows) {
  QStringList wanted;
  for (const auto& row : rows) {
    if (offered(row)) wanted << row.name;
  }
  if (wanted == m_laid_out) return;
  m_laid_out = wanted;
  for (const auto& [name, each] : m_buttons) each->setVisible(wanted.contains(name));
  for (int i = 1; i < wanted.size(); ++i) setTabOrder(button(wanted[i - 1]), button(wanted[i]));
  place();
  if (!wanted.contains(m_chosen)) choose({});
}

void MacroPanel::place() {
  for (const auto& [name, each] : m_buttons) m_grid->removeWidget(each);
  m_columns = columnsThatFit();
  for (int i = 0; i < kMostColumns; ++i) m_grid->setColumnStretch(i, i < m_columns ? 1 : 0);
  for (int i = 0; i < m_laid_out.size(); ++i) m_grid->addWidget(button(m_laid_out[i]), i / m_columns, i % m_columns);
}

int MacroPanel::columnsThatFit() const {
  int widest = 1;
  for (const auto& name : m_laid_out) widest = std::max(widest, button(name)->sizeHint().width() + kForSigns);
  return std::clamp((width() - 7) / (widest + 5), 1, kMostColumns);
}

void MacroPanel::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  if (columnsThatFit() != m_columns) place();
}

void MacroPanel::choose(const QString& macro) {
  m_chosen = macro;
  std::optional<session::MacroRow> chosen;
  for (auto& row : m_bench.plans().macros()) {
    if (row.name == macro) chosen = row;
  }
  m_form->setMacro(chosen);
}

void MacroPanel::replanIfShown(const QString& macro) {
  const auto& record = m_bench.document().plan();
  const auto& play = m_bench.play().state();
  if (record && record->macro == macro.toStdString() && !play.loaded && !play.playing && m_bench.whyNotPlan().isEmpty()) m_replan.start();
}

QString MacroPanel::whatHappens() const {
  return m_bench.autoPlay() && !m_bench.hand().holdToRun()
             ? tr("Auto-play is on: the arm moves as soon as a motion is found.")
             : tr("Plans and shows; nothing moves before Play.");
}

void MacroPanel::showButton(const session::MacroRow& row) {
  const QString busy = m_bench.whyNotPlan();
  const QString why = busy.isEmpty() ? row.reason : busy;
  QPushButton* shown = button(row.name);
  shown->setEnabled(why.isEmpty());
  showReachOf(row);
  const auto reach = m_bench.reach().answer(row.name);
  QStringList tip{row.description};
  if (!row.advice.isEmpty()) tip << row.advice;
  if (!row.accuracy.isEmpty()) tip << row.accuracy;
  if (!reach.reason.empty()) tip << QString::fromStdString(reach.reason);
  if (reach.level != Level::kUnknown && reach.level != Level::kNot) tip << tr("At a glance it can be reached, the tool rolled by %1\u00b0.").arg(QString::number(reach.roll * 180 / M_PI, 'f', 0));
  tip << (why.isEmpty() ? whatHappens() : tr("Not now: %1").arg(why));
  shown->setToolTip(tip.join(QLatin1Char('\n')).toHtmlEscaped().replace(QLatin1Char('\n'), QLatin1String("<br>")));
  const auto action = actionsOfMacros().find(row.name);
  if (action != actionsOfMacros().end()) m_actions.setWhyNot(action->second, why);
}

// Green, amber, red, and a sign for those who do not tell them apart.
void MacroPanel::showReachOf(const session::MacroRow& row) {
  QPushButton* shown = button(row.name);
  const auto level = m_bench.reach().answer(row.name).level;
  const char* reach = level == Level::kReached ? "reached" : level == Level::kStrained ? "strained" : level == Level::kNot ? "not" : "";
  const QString sign = level == Level::kReached ? QStringLiteral("\u2713 ") : level == Level::kStrained ? QStringLiteral("~ ")
                       : level == Level::kNot ? QStringLiteral("\u2717 ") : QString();
  shown->setText(sign + row.title + mark(row));
  if (shown->property("reach").toString() == QLatin1String(reach)) return;
  shown->setProperty("reach", QLatin1String(reach));
  shown->style()->unpolish(shown);
  shown->style()->polish(shown);
}

void MacroPanel::showReach() {
  for (const auto& row : m_bench.plans().macros()) {
    if (m_laid_out.contains(row.name)) showButton(row);
  }
}

void MacroPanel::refresh() {
  const auto rows = m_bench.plans().macros();
  bool same = rows.size() == m_buttons.size();
  for (const auto& row : rows) same = same && button(row.name) != nullptr;
  if (!same) rebuild(rows);
  for (const auto& [macro, id] : actionsOfMacros()) {
    if (button(macro) == nullptr) m_actions.setWhyNot(id, tr("This workcell has no such motion."));
  }
  for (const auto& row : rows) showButton(row);
  layOut(rows);
  const auto* item = m_bench.document().item(m_bench.document().selection().primary);
  m_target->setText(item != nullptr ? tr("With the selected %1 \u201c%2\u201d:")
                                          .arg(QString::fromLatin1(vision::toString(item->kind)), QString::fromStdString(item->name))
                                    : tr("Nothing is selected: canned motions. Select a feature to see what can be done with it."));
  refreshPlan();
}

void MacroPanel::refreshPlan() {
  const bool planning = m_bench.plans().state() == session::PlanController::State::kPlanning;
  m_actions.setWhyNot(ActionId::kCancelPlanning, planning ? QString() : tr("Nothing is being planned."));
  const auto& record = m_bench.document().plan();
  const QString none = record ? QString() : tr("There is no plan.");
  m_actions.setWhyNot(ActionId::kDiscardPlan, m_bench.play().state().playing ? tr("The arm is moving along it.") : none);
  m_actions.setWhyNot(ActionId::kReplan, none.isEmpty() ? m_bench.whyNotPlan() : none);
  const QString one = m_bench.plans().whyNotOtherWay();
  m_actions.setWhyNot(ActionId::kOtherWay, one.isEmpty() ? m_bench.whyNotPlan() : one);
  if (!record || planning) {
    m_outcome->setText(planning ? tr("Planning %1 ...").arg(m_bench.plans().planning()) : whatHappens());
    return;
  }
  m_outcome->setText(told(record->plan).join(QLatin1Char('\n')));
  m_outcome->setToolTip(m_outcome->text().toHtmlEscaped().replace(QLatin1Char('\n'), QLatin1String("<br>")));
}

QStringList MacroPanel::told(const planning::Plan& plan) const {
  QStringList lines;
  if (!plan.ok()) {
    const QString code = QString::fromLatin1(planning::toString(plan.status)).replace(QLatin1Char('_'), QLatin1Char(' '));
    const QString stage = plan.failed_stage.empty() ? QString() : tr(" in stage \u201c%1\u201d").arg(QString::fromStdString(plan.failed_stage));
    lines << tr("Refused, %1%2: %3").arg(code, stage, QString::fromStdString(plan.reason));
    if (!plan.advice.empty()) lines << tr("What would help:");
    for (const auto& advice : plan.advice) lines << QStringLiteral("\u2022 ") + QString::fromStdString(advice);
    return lines;
  }
  const double least = plan.clearance.empty() ? plan.min_clearance : planning::leastClearance(plan.clearance).distance;
  lines << tr("%1 s, clearance %2, planned in %3 s.").arg(QString::number(plan.trajectory.duration(), 'f', 1), widgets::clearanceText(least),
      QString::number(plan.planning_seconds, 'f', 2));
  QStringList stages;
  for (const auto& stage : plan.stages) stages << tr("%1 %2 s").arg(QString::fromStdString(stage.name), QString::number(stage.end_s - stage.start_s, 'f', 1));
  lines << stages.join(QStringLiteral(" \u2192 "));
  if (plan.go != "go") lines << QString::fromStdString(plan.accuracy_note);
  for (const auto& note : plan.notes) lines << QString::fromStdString(note);
  return lines;
}

void MacroPanel::applyTheme() {
  for (const auto& [name, each] : m_buttons) each->setIcon(widgets::icon(each->property("action_icon").toString(), m_appearance.theme()));
}

}  // namespace longarm::ui
