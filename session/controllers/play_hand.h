#pragma once

/// @file
/// PlayHand: the operator's finger on Play, Back up or a step: when it must hold, and what letting go does.

#include <optional>

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <QTimer>

#include "session/controllers/play_controller.h"

namespace longarm::session {

/// Three ways a press becomes motion:
///   a virtual robot        at once;
///   a live robot           after kConfirm_ms of holding, and then it goes on by itself;
///   hold to run, any robot at once, and only as long as it is held.
/// GUI thread only.
class PlayHand final : public QObject {
  Q_OBJECT

 public:
  enum class Order { kPlay, kBackUp, kStage, kStageBack };
  static constexpr int kConfirm_ms = 600;

  explicit PlayHand(PlayController& play, QObject* parent = nullptr);

  void setHoldToRun(bool on);
  bool holdToRun() const { return m_play.onlyHeld(); }
  void setLive(bool live) { m_live = live; }
  /// Whether a press must be held for anything to happen; empty when a click will do.
  QString whyHold() const;

  void press(Order order);
  void release();
  bool held() const { return m_held.has_value(); }
  /// Press and release in one, as a menu does.
  void click(Order order);

 Q_SIGNALS:
  void changed();  ///< held() or holdToRun().
  void said(const QString& sentence);

 private:
  void act();
  void tick();

  PlayController& m_play;
  bool m_live = false;
  std::optional<Order> m_held;
  bool m_acted = false;
  QElapsedTimer m_since;
  QTimer m_timer;
};

}  // namespace longarm::session
