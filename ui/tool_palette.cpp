#include "ui/tool_palette.h"

#include <QToolButton>
#include <QVBoxLayout>

namespace longarm::ui {

ToolPalette::ToolPalette(Actions& actions, QWidget* parent) : QFrame(parent) {
  setObjectName(QStringLiteral("panel"));
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(3, 4, 3, 4);
  column->setSpacing(4);
  const auto add = [&](ActionId id) {
    auto* button = new QToolButton(this);
    button->setDefaultAction(actions.at(id));
    button->setIconSize({26, 26});
    button->setMinimumSize(38, 36);
    button->setFocusPolicy(Qt::TabFocus);
    column->addWidget(button);
  };
  add(ActionId::kTakePair);
  column->addSpacing(10);
  for (const auto id : {ActionId::kToolSelect, ActionId::kToolPoint, ActionId::kToolLine, ActionId::kToolPipe, ActionId::kToolPlane, ActionId::kToolTriad,
                        ActionId::kToolMeasure}) add(id);
  column->addSpacing(10);
  add(ActionId::kAddToWorld);
  column->addSpacing(10);
  for (const auto id : {ActionId::kUndo, ActionId::kRedo, ActionId::kDelete}) add(id);
  column->addStretch(1);
  setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Preferred);
}

}  // namespace longarm::ui
