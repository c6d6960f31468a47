#pragma once

/// @file
/// ZoomDrive: zoom and focus of a camera, by held buttons or keys, a slider or a number.

#include <memory>
#include <optional>
#include <string>

#include <QObject>
#include <QString>
#include <QTimer>

#include "planning/world/workcell.h"
#include "session/controllers/robot_feed.h"

namespace longarm::session {

/// GUI thread only.  At most 20 commands a second.
class ZoomDrive final : public QObject {
  Q_OBJECT

 public:
  explicit ZoomDrive(QObject* parent = nullptr);

  /// Borrowed; null: no camera to zoom.
  void setFeed(RobotFeed* feed);
  void setWorkcell(std::shared_ptr<const planning::Workcell> workcell);

  /// Empty when this camera's zoom can be commanded; else why not.
  QString whyNot(const QString& camera) const;
  bool zooms(const QString& camera) const;
  /// Newest settings, 0 ... 1; empty while unknown.
  std::optional<double> zoom(const QString& camera) const;
  std::optional<double> focus(const QString& camera) const;
  /// The zoom of a camera that has one, when a picture was exposed.  @param stamp_s On the robot's clock.
  std::optional<double> zoomAt(const QString& camera, double stamp_s) const;
  /// How much larger things are than at the wide end; empty outside the calibrated settings.
  std::optional<double> magnification(const QString& camera) const;

  void setZoom(const QString& camera, double zoom01);
  void setFocus(const QString& camera, double focus01);
  void focusItself(const QString& camera);
  /// Zooms in (+1) or out (-1), or focuses farther or nearer, until release().
  void holdZoom(const QString& camera, int direction);
  void holdFocus(const QString& camera, int direction);
  /// Stands still where it is.
  void release();

 Q_SIGNALS:
  void commanded(const QString& camera);
  void failed(const QString& sentence);

 private:
  enum class Held { kNothing, kZoom, kFocus };
  void hold(Held what, const QString& camera, int direction);
  void tick();
  bool sent(const QString& camera, const Status& status);
  const planning::CameraSpec* spec(const QString& camera) const;
  void warnOutside(const QString& camera, double zoom01);

  RobotFeed* m_feed = nullptr;
  std::shared_ptr<const planning::Workcell> m_workcell;
  QTimer m_timer;
  Held m_held = Held::kNothing;
  QString m_camera;
  int m_direction = 0;
  double m_wanted = 0, m_last_s = 0;
};

}  // namespace longarm::session
