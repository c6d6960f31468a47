#pragma once

/// @file
/// TimeBar: a motion's stages along its time, where it stands, and scrubbing.

#include <vector>

#include <QWidget>

#include "widgets/theme.h"

namespace longarm::widgets {

/// One named stretch of time [s].
struct TimeStage {
  QString name;
  double start_s = 0, end_s = 0;
};

/// Takes values; GUI thread only.
class TimeBar final : public QWidget {
  Q_OBJECT

 public:
  explicit TimeBar(QWidget* parent = nullptr);
  void setTheme(const Theme& theme);
  void setStages(std::vector<TimeStage> stages, double duration_s);
  void setCursorTime(double t_s);
  double cursorTime() const { return m_cursor; }
  double duration() const { return m_duration; }
  /// Whether pressing and dragging scrubs.
  void setScrubbable(bool on);
  /// Widget x of a time.
  double xOf(double t_s) const;
  QSize sizeHint() const override { return {400, 44}; }
  QSize minimumSizeHint() const override { return {160, 40}; }

 Q_SIGNALS:
  void scrubbed(double t_s);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;

 private:
  void scrubTo(double x);

  Theme m_theme = Theme::dark();
  std::vector<TimeStage> m_stages;
  double m_duration = 0, m_cursor = 0;
  bool m_scrubbable = false;
};

}  // namespace longarm::widgets
