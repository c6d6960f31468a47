#include "ui/main_window.h"

#include <QApplication>
#include <QCloseEvent>
#include <QDialog>
#include <QDockWidget>
#include <QHBoxLayout>
#include <QLabel>
#include <QMenuBar>
#include <QPushButton>
#include <QScrollArea>
#include <QSplitter>
#include <QStackedWidget>
#include <QTabBar>
#include <QTimer>
#include <QVBoxLayout>

#include "ui/compare_dialog.h"
#include "ui/macro_memory.h"
#include "ui/play_settings.h"
#include "ui/shortcut_sheet.h"
#include "ui/sketch_watch.h"

namespace longarm::ui {

using vision::PaneSide;

MainWindow::MainWindow(Workbench& bench, Appearance& appearance, QSettings& settings, QWidget* parent)
    : QMainWindow(parent), m_bench(bench), m_appearance(appearance), m_settings(settings), m_actions(new Actions(appearance, this)),
      m_stop_keys(new StopKeys([&bench] { return bench.robot().armed() || bench.robot().status().moving; }, this)),
      m_files(new FileActions(bench, *m_actions, settings, this)), m_edits(new SketchEdits(bench, *m_actions, this)) {
  new MacroMemory(bench.plans(), settings, this);
  new PlaySettings(bench, *m_actions, settings, this);
  setObjectName(QStringLiteral("longarm"));
  new SketchActions(bench.targeting(), *m_actions, this);
  makePanels();
  assemble();
  makeMenus();
  connectPanels();
  bindWindowActions();
  applyTheme();
  showMode();
  showTitle();
  setMinimumSize(1024, 700);
  resize(1280, 800);
}

MainWindow::~MainWindow() = default;

namespace {

// A panel that needs more room than there is scrolls, so that the window, and STOP in it, always fits the screen.
QWidget* scrolled(QWidget* panel) {
  auto* area = new QScrollArea;
  area->setFrameShape(QFrame::NoFrame);
  area->setWidgetResizable(true);
  area->setFocusPolicy(Qt::NoFocus);
  area->setMinimumSize(200, 110);
  area->setWidget(panel);
  return area;
}

}  // namespace

void MainWindow::makePanels() {
  m_pictures = new PicturesArea(m_bench, *m_actions, m_appearance);
  m_scene = new ScenePanel(m_bench, *m_actions, m_appearance);
  m_features = new FeaturePanel(m_bench.targeting(), *m_actions, m_appearance);
  m_macros = new MacroPanel(m_bench, *m_actions, m_appearance);
  m_nudge = new NudgePanel(m_bench);
  m_head = new HeadPanel(m_bench, *m_actions, m_appearance);
  m_jog = new JogPanel(m_bench);
  m_drive = new DrivePanel(m_bench);
  m_recorded = new RecordedPanel(m_bench);
  m_motion = new MotionPanel(m_bench, *m_actions, m_appearance);
  m_stop = new StopPanel(m_bench, *m_actions, m_appearance);
  m_cameras = new CamerasPanel(m_bench, m_appearance);
  m_snapshots = new SnapshotsPanel(m_bench, m_appearance);
  m_world = new WorldPanel(m_bench, *m_actions);
  m_templates = new TemplatePanel(m_bench);
  m_strip = new StatusStrip(m_bench, *m_actions, m_appearance);
  m_notices = new NoticeBar;
  m_tasks = new TaskTabs(*m_actions);
  m_calibrate = new CalibratePage(m_bench, m_appearance);
  new SketchWatch(m_bench, *m_notices, this);
}

void MainWindow::assemble() {
  m_frame = new widgets::ModeFrame(this);
  setCentralWidget(m_frame);
  m_docks = new QMainWindow(nullptr, Qt::Widget);
  m_docks->setObjectName(QStringLiteral("docks"));
  m_docks->setContextMenuPolicy(Qt::NoContextMenu);
  m_middle = new QSplitter(Qt::Horizontal);
  m_middle->setObjectName(QStringLiteral("middle"));
  m_middle->setChildrenCollapsible(false);
  m_middle->addWidget(m_pictures);
  m_middle->addWidget(m_scene);
  m_middle->setStretchFactor(0, 2);
  m_middle->setStretchFactor(1, 1);
  m_middle->setSizes({760, 370});
  m_docks->setCentralWidget(m_middle);
  m_docks->setCorner(Qt::BottomLeftCorner, Qt::LeftDockWidgetArea);
  addDock(QStringLiteral("cameras"), tr("Cameras"), m_cameras, Qt::LeftDockWidgetArea);
  addDock(QStringLiteral("features"), tr("Features"), m_features, Qt::BottomDockWidgetArea);
  addDock(QStringLiteral("jog"), tr("Jog arm"), scrolled(m_jog), Qt::BottomDockWidgetArea);
  addDock(QStringLiteral("drive"), tr("Drive"), scrolled(m_drive), Qt::BottomDockWidgetArea);
  addDock(QStringLiteral("head"), tr("Cameras' aim and gripper"), m_head, Qt::BottomDockWidgetArea);
  addDock(QStringLiteral("macros"), tr("Motions"), scrolled(m_macros), Qt::BottomDockWidgetArea);
  addDock(QStringLiteral("snapshots"), tr("Snapshots"), m_snapshots, Qt::BottomDockWidgetArea);
  addDock(QStringLiteral("world"), tr("World"), m_world, Qt::BottomDockWidgetArea);
  addDock(QStringLiteral("templates"), tr("Templates"), scrolled(m_templates), Qt::BottomDockWidgetArea);
  addDock(QStringLiteral("recorded"), tr("Recorded"), scrolled(m_recorded), Qt::BottomDockWidgetArea);
  addDock(QStringLiteral("correction"), tr("Correction"), scrolled(m_nudge), Qt::BottomDockWidgetArea);
  const auto dock = [this](const char* name) { return m_docks->findChild<QDockWidget*>(QLatin1String(name)); };
  // Behind the list of features, so that they take no room of their own.
  for (const char* name : {"jog", "drive", "correction", "recorded", "snapshots", "world", "templates"})
    m_docks->tabifyDockWidget(dock("features"), dock(name));
  dock("features")->raise();
  // Whole words that scroll, rather than eight stumps that push the motions out of a small window.
  for (auto* tabs : m_docks->findChildren<QTabBar*>()) {
    tabs->setElideMode(Qt::ElideNone);
    tabs->setUsesScrollButtons(true);
  }
  auto* column = m_frame->content();
  m_pages = new QStackedWidget;
  m_pages->addWidget(m_docks);
  m_pages->addWidget(m_calibrate);
  column->addWidget(makeTopBar());
  column->addWidget(m_notices);
  column->addWidget(m_pages, 1);
  column->addWidget(makeBottomBar());
  m_layout = std::make_unique<WindowLayout>(*this, *m_docks, std::vector<QSplitter*>{m_middle}, m_settings, [this] { sizeDocks(); });
}

void MainWindow::sizeDocks() {
  const auto dock = [this](const char* name) { return m_docks->findChild<QDockWidget*>(QLatin1String(name)); };
  m_docks->resizeDocks({dock("cameras")}, {132}, Qt::Horizontal);
  m_docks->resizeDocks({dock("features"), dock("head"), dock("macros")}, {530, 250, 350}, Qt::Horizontal);
  m_docks->resizeDocks({dock("features"), dock("head"), dock("macros")}, {190, 190, 190}, Qt::Vertical);
}

void MainWindow::showEvent(QShowEvent* event) {
  QMainWindow::showEvent(event);
  if (!event->spontaneous()) QTimer::singleShot(0, this, [this] { m_layout->shown(); });
}

void MainWindow::addDock(const QString& name, const QString& title, QWidget* panel, Qt::DockWidgetArea area) {
  auto* dock = new QDockWidget(title, m_docks);
  dock->setObjectName(name);
  dock->setWidget(panel);
  dock->setFeatures(QDockWidget::DockWidgetMovable | QDockWidget::DockWidgetFloatable | QDockWidget::DockWidgetClosable);
  m_docks->addDockWidget(area, dock);
}

// The tabs share the strip's line: pictures need the height.
QWidget* MainWindow::makeTopBar() {
  auto* bar = new QFrame;
  bar->setObjectName(QStringLiteral("strip"));
  auto* row = new QHBoxLayout(bar);
  row->setContentsMargins(4, 2, 0, 0);
  row->setSpacing(2);
  row->addWidget(m_tasks);
  row->addWidget(m_strip, 1);
  return bar;
}

// Keys of what is not seen are silent: Del must not delete a feature behind another page.
void MainWindow::showTask(Task task) {
  m_pages->setCurrentIndex(static_cast<int>(task));
  for (const char* menu : {"Edit", "Sketch"}) {
    const auto found = m_menus.find(tr(menu));
    if (found != m_menus.end()) found->second->menuAction()->setEnabled(task == Task::kTarget);
  }
}

// STOP is no dock: nothing can cover it or take it away.
QWidget* MainWindow::makeBottomBar() {
  auto* bar = new QFrame;
  bar->setObjectName(QStringLiteral("bottomBar"));
  auto* row = new QHBoxLayout(bar);
  row->setContentsMargins(8, 4, 8, 4);
  row->setSpacing(14);
  row->addWidget(m_motion, 1);
  row->addWidget(m_stop);
  return bar;
}

void MainWindow::makeMenus() {
  std::map<QString, QMenu*>& menus = m_menus;
  for (const auto& spec : actionTable()) {
    const QString name = tr(spec.menu);
    if (menus.count(name) == 0) {
      menus[name] = menuBar()->addMenu(QLatin1Char('&') + name);
      menus[name]->setToolTipsVisible(true);
    }
    switch (spec.id) {
      case ActionId::kSaveSketch:
      case ActionId::kExportWorld:
      case ActionId::kQuit:
      case ActionId::kDelete:
      case ActionId::kSelectAll:
      case ActionId::kLiveBoth:
      case ActionId::kSceneFit:
      case ActionId::kTheme:
      case ActionId::kReplan:
      case ActionId::kPlayPause:
      case ActionId::kGripperOpen:
      case ActionId::kRestart: menus[name]->addSeparator(); break;
      default: break;
    }
    menus[name]->addAction(m_actions->at(spec.id));
    if (spec.id == ActionId::kOpenSketch) menus[name]->addMenu(m_files->recentMenu());
  }
  QMenu* panels = menus[tr("View")]->addMenu(tr("&Panels"));
  for (auto* dock : m_docks->findChildren<QDockWidget*>(QString(), Qt::FindDirectChildrenOnly)) panels->addAction(dock->toggleViewAction());
}

void MainWindow::connectPanels() {
  connect(m_stop_keys, &StopKeys::stopPressed, this, [this] { m_bench.robot().stop("operator", "the stop key was pressed"); });
  connect(m_tasks, &TaskTabs::taskChanged, this, &MainWindow::showTask);
  connect(m_drive, &DrivePanel::cameraWanted, this,
          [this](const QString& camera) { m_pictures->pane(PaneSide::kLeft)->showLive(camera); });
  connect(m_strip, &StatusStrip::healthWanted, this, [this](const QString& camera) {
    m_tasks->setTask(Task::kCalibrate);
    m_calibrate->showTool(m_calibrate->library());
    m_calibrate->library()->choose(camera);
  });
  connect(m_cameras, &CamerasPanel::chosen, this, [this](const QString& camera, PaneSide side) { m_pictures->pane(side)->showLive(camera); });
  for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
    SnapshotPane* pane = m_pictures->pane(side);
    const auto show = [this, pane] { m_scene->setPane(pane->side(), pane->view(), pane->picture()); };
    connect(pane, &SnapshotPane::shownChanged, this, show);
    connect(pane, &SnapshotPane::menuRequested, m_edits, [this, pane](const QPoint& at) { m_edits->showMenu(*pane, at); });
    show();
  }
  connect(m_snapshots, &SnapshotsPanel::compareRequested, this, [this](const vision::SnapshotPtr& a, const vision::SnapshotPtr& b) {
    auto* dialog = new CompareDialog(a, b, m_appearance.theme(), this);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->show();
  });
  connect(&m_appearance, &Appearance::changed, this, &MainWindow::applyTheme);
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, [this] { showMode(); showLinkNotice(); });
  connect(&m_bench.play(), &session::PlayController::changed, this, &MainWindow::showPlanNotice);
  connect(&m_bench.targeting(), &session::TargetingController::historyChanged, this, &MainWindow::showTitle);
  connect(m_files, &FileActions::sketchFolderChanged, this, &MainWindow::showTitle);
}

void MainWindow::bindWindowActions() {
  connect(m_actions->at(ActionId::kQuit), &QAction::triggered, this, &QWidget::close);
  connect(m_actions->at(ActionId::kTheme), &QAction::triggered, &m_appearance, &Appearance::toggle);
  connect(m_actions->at(ActionId::kResetLayout), &QAction::triggered, this, [this] { m_layout->reset(); });
  connect(m_actions->at(ActionId::kShortcuts), &QAction::triggered, this, [this] { (new ShortcutSheet(*m_actions, this))->show(); });
  connect(m_actions->at(ActionId::kAbout), &QAction::triggered, this, &MainWindow::showAbout);
  connect(m_actions->at(ActionId::kRestart), &QAction::triggered, &m_bench.robot(), &RobotSession::restart);
  const auto refresh = [this] { m_actions->setWhyNot(ActionId::kRestart, m_bench.robot().whyNotRestart()); };
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, refresh);
  connect(&m_bench.robot(), &RobotSession::playerChanged, this, refresh);
  refresh();
}

void MainWindow::applyTheme() {
  m_frame->setTheme(m_appearance.theme());
  m_settings.setValue(QStringLiteral("theme"), m_appearance.theme().name);
}

void MainWindow::showMode() {
  switch (m_bench.robot().status().mode) {
    case session::RobotMode::kLive: m_frame->setMode(widgets::ModeLook::kLive); break;
    case session::RobotMode::kVirtual: m_frame->setMode(widgets::ModeLook::kVirtual); break;
    case session::RobotMode::kReplay: m_frame->setMode(widgets::ModeLook::kReplay); break;
  }
  showTitle();
}

void MainWindow::showTitle() {
  const QString mode = QString::fromLatin1(session::toString(m_bench.robot().status().mode));
  const QString sketch = m_files->sketchFolder().isEmpty() ? tr("unsaved sketch") : m_files->sketchFolder();
  setWindowTitle(tr("%1[*] - Longarm - %2").arg(sketch, mode));
  setWindowModified(!m_bench.targeting().isClean());
}

void MainWindow::showPlanNotice() {
  const QString key = QStringLiteral("plan");
  const auto& state = m_bench.play().state();
  showAccuracyNotice();
  showHaltNotice();
  if (!state.stale || !state.has_plan) return m_notices->clear(key);
  if (m_notices->has(key)) return;
  m_notices->post(key, state.why_not_play, {{tr("Plan again"), [this] { m_bench.replan(); }},
                                            {tr("Discard plan"), [this] { m_bench.plans().discard(); }}});
}

void MainWindow::showAccuracyNotice() {
  const QString key = QStringLiteral("accuracy");
  const auto& state = m_bench.play().state();
  if (!state.ask) return m_notices->clear(key);
  if (m_notices->has(key)) return;
  m_notices->post(key, state.why_not_play, {{tr("Go on with care"), [this] { m_bench.play().acceptAccuracy(); }},
                                            {tr("Discard plan"), [this] { m_bench.plans().discard(); }}});
}

// The arm holds; these are the ways on.
void MainWindow::showHaltNotice() {
  const QString key = QStringLiteral("halt");
  const auto& state = m_bench.play().state();
  const bool latched = m_bench.robot().status().gate.stopped;
  if (!state.halted || state.stale || (latched && state.halt_reason.isEmpty())) return m_notices->clear(key);
  if (m_notices->has(key)) return;
  auto& hand = m_bench.hand();
  using Order = session::PlayHand::Order;
  const QString text = state.halt_reason.isEmpty()
                           ? tr("The motion was stopped; the arm holds on its path.")
                           : tr("The arm holds: %1. Reset STOP if it is latched, then choose a way on.")
                                 .arg(state.halt_reason);
  m_notices->post(key, text,
                  {{tr("Go on"), [&hand] { hand.click(Order::kPlay); }},
                   {tr("Back up"), [&hand] { hand.click(Order::kBackUp); }},
                   {tr("Plan again"), [this] { m_bench.replan(); }},
                   {tr("Discard plan"), [this] { m_bench.plans().discard(); }}});
}

void MainWindow::showLinkNotice() {
  const QString key = QStringLiteral("link");
  const auto& status = m_bench.robot().status();
  const bool gone = status.link == session::LinkState::kLost || status.link == session::LinkState::kClosed;
  if (!gone || m_bench.robot().busy() || !m_bench.robot().whyNotRestart().isEmpty()) return m_notices->clear(key);
  if (m_notices->has(key)) return;
  m_notices->post(key, tr("The robot is gone: %1. Pictures and sketch are kept.").arg(QString::fromStdString(status.link_text)),
                  {{tr("Restart robot"), [this] { m_bench.robot().restart(); }}, {tr("Work without it"), {}}});
}

void MainWindow::offerRecovery() {
  if (!m_bench.autosave().hasRecovery()) return;
  m_notices->post(QStringLiteral("recovery"), tr("A sketch of an earlier run was not saved. Take it back?"),
                  {{tr("Take it back"),
                    [this] {
                      const Status recovered = m_bench.autosave().recover();
                      m_bench.history().clear();
                      if (!recovered) m_bench.say(QString::fromStdString(recovered.error().message));
                    }},
                   {tr("Throw it away"), [this] { m_bench.autosave().discard(); }}});
}

void MainWindow::showAbout() {
  auto* about = new QDialog(this);
  about->setWindowTitle(tr("About Longarm"));
  about->setAttribute(Qt::WA_DeleteOnClose);
  auto* column = new QVBoxLayout(about);
  auto* text = new QLabel(tr("<h3>Longarm %1</h3><p>Operator console for mobile manipulators: two snapshots, a sketch, a measured "
                             "target, a checked and previewed motion.</p><p>Apache License 2.0</p>")
                              .arg(QCoreApplication::applicationVersion()), about);
  text->setWordWrap(true);
  text->setMinimumWidth(360);
  column->addWidget(text);
  auto* close = new QPushButton(tr("Close"), about);
  connect(close, &QPushButton::clicked, about, &QDialog::close);
  column->addWidget(close, 0, Qt::AlignRight);
  about->show();
}

void MainWindow::closeEvent(QCloseEvent* event) {
  m_bench.robot().stop("operator", "the window was closed");
  m_bench.plans().cancel();
  if (m_remembering) {
    m_layout->save();
    if (m_bench.targeting().isClean()) m_bench.autosave().discard();
    else (void)m_bench.autosave().flush();
  }
  event->accept();
}

}  // namespace longarm::ui
