#pragma once

/// @file
/// CameraStrip: live thumbnails, each with its age.

#include <map>
#include <optional>
#include <vector>

#include <QImage>
#include <QWidget>

#include "widgets/status_lamp.h"
#include "widgets/theme.h"

namespace longarm::widgets {

/// One live thumbnail with name and age badge.
class CameraTile final : public QWidget {
  Q_OBJECT

 public:
  CameraTile(const QString& camera, int number, QWidget* parent = nullptr);
  void setTheme(const Theme& theme);
  void setPicture(const QImage& picture);
  /// Age of the picture [s]; nothing: never had one.
  void setAge(std::optional<double> age_s);
  std::optional<double> age() const { return m_age; }
  /// Whether its calibration can be trusted: a shape at the end of its name, and words for the tooltip.
  void setHealth(StatusLamp::Level level, const QString& words);
  StatusLamp::Level health() const { return m_health; }
  QSize sizeHint() const override { return {128, 110}; }
  QSize minimumSizeHint() const override { return {96, 64}; }

 Q_SIGNALS:
  void chosen(const QString& camera, bool right_pane);   ///< Click: left pane; right click or Shift: right pane.

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;

 private:
  QString m_camera;
  int m_number;
  Theme m_theme = Theme::dark();
  QImage m_picture;
  std::optional<double> m_age;
  StatusLamp::Level m_health = StatusLamp::Level::kOk;
};

/// A column of tiles.  Takes values; GUI thread only.
class CameraStrip final : public QWidget {
  Q_OBJECT

 public:
  explicit CameraStrip(QWidget* parent = nullptr);
  void setTheme(const Theme& theme);
  void setCameras(const std::vector<QString>& cameras);
  CameraTile* tile(const QString& camera) const;         ///< Null if there is none.

 Q_SIGNALS:
  void chosen(const QString& camera, bool right_pane);

 private:
  Theme m_theme = Theme::dark();
  std::map<QString, CameraTile*> m_tiles;
};

}  // namespace longarm::widgets
