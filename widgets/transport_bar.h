#pragma once

/// @file
/// TransportBar: the VCR's buttons, speed and time bar.

#include <vector>

#include <QWidget>

#include "widgets/theme.h"
#include "widgets/time_bar.h"

class QLabel;
class QSlider;
class QToolButton;

namespace longarm::widgets {

/// What the transport shows; a value.
struct TransportState {
  bool loaded = false;             ///< There is a motion to play.
  bool playing = false;
  bool can_play = false, can_back_up = false;
  QString why_not;                 ///< Shown when can_play is false.
  QString why_not_back_up;         ///< Tooltip when can_back_up is false.
  bool can_scrub = false;
  double cursor_s = 0, duration_s = 0;
  double speed = 1;                ///< Wanted factor, -2 ... 2.
  double rate = 0;                 ///< Actual.
  QString caption;                 ///< "Grab Pipe, 12.3 s, clearance 34 mm"
};

/// Speeds are steps of 10 %.  Emits what the operator wants; shows only what setState says.
class TransportBar final : public QWidget {
  Q_OBJECT

 public:
  explicit TransportBar(QWidget* parent = nullptr);
  void setTheme(const Theme& theme);
  void setState(const TransportState& state);
  const TransportState& state() const { return m_state; }
  void setStages(std::vector<TimeStage> stages, double duration_s);
  /// Asks for the next slower or faster step.
  void stepSpeed(int steps);
  TimeBar* timeBar() const { return m_time; }
  QToolButton* playButton() const { return m_play; }
  QToolButton* backUpButton() const { return m_back_up; }
  QSlider* speedSlider() const { return m_speed; }

 Q_SIGNALS:
  void playWanted();               ///< Forwards at |speed|.
  void backUpWanted();             ///< Backwards at |speed|.
  void pauseWanted();
  void toStartWanted();            ///< Cursor to the start, preview only.
  void toEndWanted();
  void speedWanted(double factor);
  void scrubWanted(double t_s);

 private:
  QToolButton* button(const QString& action, const QString& text, const QString& tip);
  void showSpeed(double speed);
  void refreshIcons();

  Theme m_theme = Theme::dark();
  TransportState m_state;
  QToolButton *m_to_start, *m_back_up, *m_pause, *m_play, *m_to_end;
  QSlider* m_speed;
  QLabel *m_speed_text, *m_caption;
  TimeBar* m_time;
};

}  // namespace longarm::widgets
