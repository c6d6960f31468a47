#pragma once

/// @file
/// DeadManSwitch: a command is repeated as long as something is held, and no longer.

#include <functional>

#include <QObject>
#include <QString>
#include <QTimer>

#include "core/result.h"

namespace longarm::session {

/// Repeats a command 20 times a second until everything is let go of or a command is refused; a robot takes a command that is
/// not repeated for 200 ms as let go of.  GUI thread only.
class DeadManSwitch : public QObject {
  Q_OBJECT

 public:
  using Release = std::function<void()>;

  virtual bool held() const = 0;
  /// Lets go of everything that is held.
  void letGo();

 Q_SIGNALS:
  void refused(const QString& sentence);
  void changed();                                      ///< Held or let go of.

 protected:
  explicit DeadManSwitch(QObject* parent);
  /// Who is told when everything was let go of; lets go first.
  void setRelease(Release release);
  /// Something is held now, or something else: sends at once, and from then on repeats.
  void repeat();
  /// Sends what is held.
  virtual Status send() = 0;
  /// Nothing is held any more.
  virtual void forget() = 0;

 private:
  void tick();

  Release m_release;
  QTimer m_timer;
};

}  // namespace longarm::session
