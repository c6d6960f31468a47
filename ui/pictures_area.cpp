#include "ui/pictures_area.h"

#include <QHBoxLayout>
#include <QSignalBlocker>
#include <QSplitter>
#include <QVBoxLayout>

#include "ui/elided_label.h"
#include "ui/tool_palette.h"

namespace longarm::ui {

using vision::PaneSide;

PicturesArea::PicturesArea(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent)
    : QWidget(parent), m_bench(bench), m_actions(actions) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(3);
  auto* row = new QHBoxLayout;
  row->setSpacing(3);
  column->addLayout(row, 1);
  row->addWidget(new ToolPalette(actions, this));
  m_splitter = new QSplitter(Qt::Horizontal, this);
  m_splitter->setChildrenCollapsible(false);
  m_splitter->setObjectName(QStringLiteral("panes"));
  for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
    m_panes[static_cast<int>(side)] = new SnapshotPane(side, bench, appearance, this);
    m_splitter->addWidget(pane(side));
    m_splitter->setStretchFactor(static_cast<int>(side), 1);
  }
  m_third = new ThirdPane(bench, appearance, this);
  m_splitter->addWidget(m_third);
  m_splitter->setStretchFactor(2, 1);
  row->addWidget(m_splitter, 1);
  auto* line = new QHBoxLayout;
  line->setContentsMargins(4, 0, 4, 2);
  line->setSpacing(16);
  m_hint = new ElidedLabel(this);
  m_hint->setObjectName(QStringLiteral("muted"));
  m_hint->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
  m_numbers = new ElidedLabel(this);
  line->addWidget(m_hint, 1);
  line->addWidget(m_numbers);
  column->addLayout(line);
  bind();
  refreshLine();
  refreshLive();
}

void PicturesArea::bind() {
  auto& targeting = m_bench.targeting();
  connect(&targeting, &session::TargetingController::hintChanged, this, &PicturesArea::refreshLine);
  connect(&targeting, &session::TargetingController::liveMeasureChanged, this, &PicturesArea::refreshLine);
  for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
    SnapshotPane* each = pane(side);
    connect(each, &SnapshotPane::shownChanged, this, &PicturesArea::refreshLive);
    connect(each, &SnapshotPane::undistortedChanged, this, &PicturesArea::refreshLive);
    connect(m_actions.at(ActionId::kFitPictures), &QAction::triggered, each->canvas(), &widgets::ImageCanvas::fit);
    connect(m_actions.at(ActionId::kFullSize), &QAction::triggered, each->canvas(), &widgets::ImageCanvas::zoomTo100);
    connect(m_actions.at(ActionId::kUndistort), &QAction::triggered, each, &SnapshotPane::setUndistorted);
  }
  connect(m_actions.at(ActionId::kLiveBoth), &QAction::triggered, this, [this](bool live) {
    for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
      if (live) pane(side)->showLive(m_bench.paneCamera(side));
      else pane(side)->showSnapshot();
    }
  });
  connect(m_actions.at(ActionId::kMaximise), &QAction::toggled, this, &PicturesArea::toggleMaximised);
}

void PicturesArea::toggleMaximised(bool on) {
  const bool right = pane(PaneSide::kRight)->isAncestorOf(focusWidget()) || pane(PaneSide::kRight)->canvas()->hasFocus();
  pane(PaneSide::kLeft)->setVisible(!on || !right);
  pane(PaneSide::kRight)->setVisible(!on || right);
}

void PicturesArea::refreshLine() {
  const auto measure = m_bench.targeting().liveMeasure();
  // Before there are numbers the hint says what to do, and needs the room.
  const QString numbers = measure && measure->xyz && !measure->refused ? QString::fromStdString(measure->text()) : QString();
  m_numbers->setVisible(!numbers.isEmpty());
  m_numbers->setFullText(numbers);
  const bool refused = measure && measure->refused;
  m_hint->setFullText(refused ? QString::fromStdString(measure->text()) : m_bench.targeting().hint());
}

void PicturesArea::refreshLive() {
  const bool live = pane(PaneSide::kLeft)->live() && pane(PaneSide::kRight)->live();
  m_actions.at(ActionId::kLiveBoth)->setChecked(live);
  m_actions.at(ActionId::kUndistort)->setChecked(pane(PaneSide::kLeft)->undistorted() && pane(PaneSide::kRight)->undistorted());
}

}  // namespace longarm::ui
