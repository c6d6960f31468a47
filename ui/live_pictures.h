#pragma once

/// @file
/// LivePictures: the newest picture of every camera, decoded off the GUI thread.

#include <array>
#include <map>
#include <optional>

#include <QImage>
#include <QObject>
#include <QString>
#include <QStringList>
#include <opencv2/core/mat.hpp>

#include "ui/robot_session.h"
#include "vision/sketch/pointer_event.h"
#include "vision/snapshot/view.h"

namespace longarm::ui {

/// Pictures are announced together, at most 15 times a second: each repaint makes the whole window be composed anew.
/// Cameras that a pane shows are decoded with every frame, the others four times a second for their thumbnails.
/// GUI thread only.
class LivePictures final : public QObject {
  Q_OBJECT

 public:
  LivePictures(RobotSession& robot, session::JobRunner& jobs, QObject* parent = nullptr);

  /// The camera that a pane shows live; empty: none.
  void setShown(vision::PaneSide side, const QString& camera);
  /// More cameras that are looked at, by a calibration.
  void setWatched(const QStringList& cameras);
  const QStringList& watched() const { return m_watched; }
  /// The cameras as they are calibrated now.
  void setWorkcell(std::shared_ptr<const planning::Workcell> workcell) { m_workcell = std::move(workcell); }

  const cv::Mat& picture(const QString& camera) const;          ///< Empty before the first.
  QImage thumbnail(const QString& camera) const;                ///< Null before the first.
  /// Where the camera was at that picture; empty while unknown.
  std::optional<vision::View> view(const QString& camera) const;
  QString whyNoView(const QString& camera) const;               ///< A sentence while view() is empty.
  /// When that picture was exposed, on the robot's clock [s].
  double stamp_s(const QString& camera) const;
  /// Age of the newest frame that arrived [s]; empty: none ever.
  std::optional<double> age(const QString& camera) const;

 Q_SIGNALS:
  void pictureArrived(const QString& camera);
  void thumbnailArrived(const QString& camera);
  void watchedChanged();

 private:
  struct Entry {
    cv::Mat picture;
    QImage thumbnail;
    std::optional<vision::View> view;
    QString why_no_view;
    bool new_picture = false, new_thumbnail = false;
    std::uint64_t sequence = 0;
    double decoded_s = -1e9, thumbnail_s = -1e9;
    bool decoding = false;
  };
  struct Decoded {
    cv::Mat picture;
    QImage thumbnail;
  };
  bool isShown(const QString& camera) const;
  void onFrame(const QString& camera);
  void announce();
  void decode(const QString& camera, std::shared_ptr<const hardware::Frame> frame);
  void take(const QString& camera, const hardware::Frame& frame, const Decoded& decoded);

  RobotSession& m_robot;
  session::JobRunner& m_jobs;
  std::array<QString, 2> m_shown;
  QStringList m_watched;
  std::shared_ptr<const planning::Workcell> m_workcell;
  std::map<QString, Entry> m_entries;
  unsigned m_polls = 0;
};

}  // namespace longarm::ui
