#pragma once

/// @file
/// TimeBar: a motion's stages and clearance along its time, where it stands, and scrubbing.

#include <vector>

#include <QWidget>

#include "planning/motion/clearance.h"
#include "widgets/theme.h"

class QPainter;

namespace longarm::widgets {

/// One named stretch of time [s].
struct TimeStage {
  QString name;
  double start_s = 0, end_s = 0;
  QString then;                    ///< What the gripper does at its end; empty: nothing.
};

/// "34 mm", rounded down: never more room than there is; "100 mm or more" from where it is not told exactly.
QString clearanceText(double metres);

/// Takes values; GUI thread only.
class TimeBar final : public QWidget {
  Q_OBJECT

 public:
  explicit TimeBar(QWidget* parent = nullptr);
  void setTheme(const Theme& theme);
  void setStages(std::vector<TimeStage> stages, double duration_s);
  /// A strip over the stages: the higher, the more room; empty: none.
  void setClearance(planning::ClearanceProfile clearance);
  /// "5.2 s, approach: clearance 34 mm"; for a hovering mouse.
  QString textAt(double t_s) const;
  void setCursorTime(double t_s);
  double cursorTime() const { return m_cursor; }
  double duration() const { return m_duration; }
  /// Whether pressing and dragging scrubs.
  void setScrubbable(bool on);
  /// Widget x of a time.
  double xOf(double t_s) const;
  /// Time of a widget x, within the motion.
  double timeOf(double x) const;
  QSize sizeHint() const override { return {400, 56}; }
  QSize minimumSizeHint() const override { return {160, 52}; }

 Q_SIGNALS:
  void scrubbed(double t_s);

 protected:
  bool event(QEvent* event) override;
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;

 private:
  void scrubTo(double x);
  void paintClearance(QPainter& painter) const;
  void paintStages(QPainter& painter) const;
  void paintCursor(QPainter& painter) const;

  Theme m_theme = Theme::dark();
  std::vector<TimeStage> m_stages;
  planning::ClearanceProfile m_clearance;
  double m_duration = 0, m_cursor = 0;
  bool m_scrubbable = false;
};

}  // namespace longarm::widgets
