#pragma once

/// @file
/// CalibratePage: the task Calibrate: the tools on the left, the chosen one beside them.

#include <QWidget>

#include "ui/calibrate_fixture_panel.h"
#include "ui/calibrate_intrinsics_panel.h"
#include "ui/calibrate_lens_panel.h"
#include "ui/calibrate_library_panel.h"
#include "ui/calibrate_pose_panel.h"
#include "ui/calibrate_stereo_panel.h"
#include "ui/calibrate_zoom_panel.h"

class QListWidget;
class QStackedWidget;

namespace longarm::ui {

/// GUI thread only.
class CalibratePage final : public QWidget {
  Q_OBJECT

 public:
  CalibratePage(Workbench& bench, Appearance& appearance, QWidget* parent = nullptr);

  CalibrateIntrinsicsPanel* intrinsics() const { return m_intrinsics; }
  CalibrateStereoPanel* stereo() const { return m_stereo; }
  CalibrateLensPanel* lens() const { return m_lens; }
  CalibrateFixturePanel* fixture() const { return m_fixture; }
  CalibratePosePanel* pose() const { return m_pose; }
  CalibrateZoomPanel* zoom() const { return m_zoom; }
  CalibrateLibraryPanel* library() const { return m_library; }
  void showTool(QWidget* panel);

 private:
  void addTool(const QString& name, const QString& tip, QWidget* panel);

  QListWidget* m_list;
  QStackedWidget* m_stack;
  CalibrateIntrinsicsPanel* m_intrinsics;
  CalibrateStereoPanel* m_stereo;
  CalibrateLensPanel* m_lens;
  CalibrateFixturePanel* m_fixture;
  CalibratePosePanel* m_pose;
  CalibrateZoomPanel* m_zoom;
  CalibrateLibraryPanel* m_library;
};

}  // namespace longarm::ui
