#pragma once

/// @file
/// MainWindow: puts the panels together; nothing else.

#include <memory>

#include <QMainWindow>
#include <QSettings>

#include "ui/actions.h"
#include "ui/calibrate_page.h"
#include "ui/cameras_panel.h"
#include "ui/drive_panel.h"
#include "ui/feature_panel.h"
#include "ui/file_actions.h"
#include "ui/head_panel.h"
#include "ui/jog_panel.h"
#include "ui/macro_panel.h"
#include "ui/motion_panel.h"
#include "ui/notice_bar.h"
#include "ui/nudge_panel.h"
#include "ui/pictures_area.h"
#include "ui/recorded_panel.h"
#include "ui/scene_panel.h"
#include "ui/sketch_actions.h"
#include "ui/sketch_edits.h"
#include "ui/snapshots_panel.h"
#include "ui/status_strip.h"
#include "ui/stop_keys.h"
#include "ui/stop_panel.h"
#include "ui/task_tabs.h"
#include "ui/window_layout.h"
#include "ui/workbench.h"
#include "ui/template_panel.h"
#include "ui/world_panel.h"
#include "widgets/mode_frame.h"

class QStackedWidget;

namespace longarm::ui {

/// Everything is borrowed and outlives the window.  GUI thread only.
class MainWindow final : public QMainWindow {
  Q_OBJECT

 public:
  MainWindow(Workbench& bench, Appearance& appearance, QSettings& settings, QWidget* parent = nullptr);
  ~MainWindow() override;

  Actions& actions() { return *m_actions; }
  Workbench& bench() { return m_bench; }
  PicturesArea* pictures() const { return m_pictures; }
  ScenePanel* scene() const { return m_scene; }
  FeaturePanel* features() const { return m_features; }
  MacroPanel* macros() const { return m_macros; }
  HeadPanel* head() const { return m_head; }
  JogPanel* jog() const { return m_jog; }
  DrivePanel* drive() const { return m_drive; }
  RecordedPanel* recorded() const { return m_recorded; }
  MotionPanel* motion() const { return m_motion; }
  StopPanel* stopPanel() const { return m_stop; }
  SnapshotsPanel* snapshots() const { return m_snapshots; }
  WorldPanel* world() const { return m_world; }
  TemplatePanel* templates() const { return m_templates; }
  SketchEdits* edits() const { return m_edits; }
  CamerasPanel* cameras() const { return m_cameras; }
  StatusStrip* strip() const { return m_strip; }
  NoticeBar* notices() const { return m_notices; }
  TaskTabs* tasks() const { return m_tasks; }
  CalibratePage* calibrate() const { return m_calibrate; }
  FileActions* files() const { return m_files; }
  WindowLayout& layout() { return *m_layout; }

  /// Asks, beside everything else, whether to take back the sketch of a run that ended badly.
  void offerRecovery();
  /// The window is not to write its layout and sketch when it closes.
  void setRemembering(bool on) { m_remembering = on; }

 protected:
  void closeEvent(QCloseEvent* event) override;
  void showEvent(QShowEvent* event) override;

 private:
  void makePanels();
  void assemble();
  void sizeDocks();
  void addDock(const QString& name, const QString& title, QWidget* panel, Qt::DockWidgetArea area);
  QWidget* makeBottomBar();
  QWidget* makeTopBar();
  void makeMenus();
  void showTask(Task task);
  void connectPanels();
  void bindWindowActions();
  void applyTheme();
  void showMode();
  void showTitle();
  void showPlanNotice();
  void showAccuracyNotice();
  void showHaltNotice();
  void showLinkNotice();
  void showAbout();

  Workbench& m_bench;
  Appearance& m_appearance;
  QSettings& m_settings;
  Actions* m_actions;
  StopKeys* m_stop_keys;
  FileActions* m_files;
  SketchEdits* m_edits;
  widgets::ModeFrame* m_frame;
  TaskTabs* m_tasks;
  QStackedWidget* m_pages;
  QMainWindow* m_docks;
  CalibratePage* m_calibrate;
  std::map<QString, QMenu*> m_menus;
  QSplitter* m_middle;
  PicturesArea* m_pictures;
  ScenePanel* m_scene;
  FeaturePanel* m_features;
  NudgePanel* m_nudge;
  MacroPanel* m_macros;
  JogPanel* m_jog;
  DrivePanel* m_drive;
  RecordedPanel* m_recorded;
  HeadPanel* m_head;
  MotionPanel* m_motion;
  StopPanel* m_stop;
  CamerasPanel* m_cameras;
  SnapshotsPanel* m_snapshots;
  TemplatePanel* m_templates;
  WorldPanel* m_world;
  StatusStrip* m_strip;
  NoticeBar* m_notices;
  std::unique_ptr<WindowLayout> m_layout;
  bool m_remembering = true;
};

}  // namespace longarm::ui
