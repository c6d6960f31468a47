#include "ui/task_tabs.h"

namespace longarm::ui {

TaskTabs::TaskTabs(Actions& actions, QWidget* parent) : QTabBar(parent) {
  setExpanding(false);
  setDrawBase(false);
  setFocusPolicy(Qt::TabFocus);
  setObjectName(QStringLiteral("tasks"));
  for (const auto id : {ActionId::kTaskTarget, ActionId::kTaskCalibrate}) {
    QAction* action = actions.at(id);
    const int index = addTab(action->text().remove(QLatin1Char('&')));
    setTabToolTip(index, action->toolTip());
    connect(action, &QAction::triggered, this, [this, index] { setCurrentIndex(index); });
  }
  connect(this, &QTabBar::currentChanged, this, [this](int index) { Q_EMIT taskChanged(static_cast<Task>(index)); });
}

}  // namespace longarm::ui
