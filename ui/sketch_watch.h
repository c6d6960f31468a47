#pragma once

/// @file
/// SketchWatch: tells the operator, beside everything else, when picks speak against the calibration or lie on the
/// robot itself, or a pair of pictures can measure little.

#include <QObject>

#include "ui/notice_bar.h"
#include "ui/workbench.h"

namespace longarm::ui {

/// A notice answered with "Understood" comes back when what it says has changed.  GUI thread only.
class SketchWatch final : public QObject {
  Q_OBJECT

 public:
  /// Borrowed; both outlive this.
  SketchWatch(Workbench& bench, NoticeBar& notices, QObject* parent = nullptr);

 private:
  void refresh();
  void refreshBaseline();
  void refreshOnRobot();
  void refreshStale();

  Workbench& m_bench;
  NoticeBar& m_notices;
  QString m_baseline_said, m_on_robot_said, m_stale_said;
  QString m_said;                          // Shown, or answered.
};

}  // namespace longarm::ui
