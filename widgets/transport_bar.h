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
  QString why_not_stage,
      why_not_stage_back;          ///< Tooltips of the two steps when they cannot be made; empty: they can.
  QString badge;                   ///< How a press acts where that is not the usual way, e.g. "HOLD TO RUN".
  bool only_held = false;          ///< The button that moves the arm stays pressable while it moves.
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
  void setClearance(planning::ClearanceProfile clearance);
  enum class Key { kPlay, kBackUp, kStage, kStageBack };
  QToolButton* keyButton(Key key) const;
  /// Asks for the next slower or faster step.
  void stepSpeed(int steps);
  TimeBar* timeBar() const { return m_time; }
  QToolButton* playButton() const { return m_play; }
  QToolButton* backUpButton() const { return m_back_up; }
  QToolButton* pauseButton() const { return m_pause; }
  QSlider* speedSlider() const { return m_speed; }

 Q_SIGNALS:
  void pressed(longarm::widgets::TransportBar::Key key);  ///< Of a button that moves the arm; at |speed|.
  void released();                                        ///< Of the same button.
  void pauseWanted();
  void toStartWanted();            ///< Cursor to the start, preview only.
  void toEndWanted();
  void speedWanted(double factor);
  void scrubWanted(double t_s);

 private:
  QToolButton* button(const QString& action, const QString& text, const QString& tip);
  QToolButton* moving(const QString& action, const QString& text, Key key);
  void showSpeed(double speed);
  void refreshIcons();

  Theme m_theme = Theme::dark();
  TransportState m_state;
  QToolButton *m_to_start, *m_back_up, *m_pause, *m_play, *m_to_end, *m_stage, *m_stage_back;
  QSlider* m_speed;
  QLabel *m_speed_text, *m_caption, *m_badge;
  TimeBar* m_time;
};

}  // namespace longarm::widgets
