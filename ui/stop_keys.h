#pragma once

/// @file
/// StopKeys: Space and Pause are STOP in the whole program.

#include <functional>

#include <QObject>

class QWidget;

namespace longarm::ui {

/// Whether keys typed into this widget (or the one that has the focus, for null) are text.
bool takesText(const QWidget* widget);

/// An event filter of the application, so that no widget, dialog or text field can take the key first.  Pause always
/// stops.  Space stops too, but while nothing can move it still types a blank into a text field.  GUI thread only.
class StopKeys final : public QObject {
  Q_OBJECT

 public:
  /// @param armed Whether the robot could move, or does.
  explicit StopKeys(std::function<bool()> armed, QObject* parent = nullptr);
  ~StopKeys() override;

 Q_SIGNALS:
  void stopPressed();

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  bool isStop(int key, const QObject* receiver) const;

  std::function<bool()> m_armed;
};

}  // namespace longarm::ui
