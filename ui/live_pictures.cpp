#include "ui/live_pictures.h"

#include <utility>

#include <opencv2/imgproc.hpp>

#include "session/controllers/snapshot_maker.h"
#include "vision/snapshot/image_file.h"
#include "widgets/picture_layer.h"

namespace longarm::ui {

namespace {

constexpr double kThumbnailEvery_s = 0.25;
constexpr int kThumbnailWidth = 240;

QImage thumbnailOf(const cv::Mat& picture) {
  cv::Mat small;
  const double scale = static_cast<double>(kThumbnailWidth) / std::max(1, picture.cols);
  cv::resize(picture, small, {}, scale, scale, cv::INTER_AREA);
  return widgets::toQImage(small);
}

}  // namespace

LivePictures::LivePictures(RobotSession& robot, session::JobRunner& jobs, QObject* parent)
    : QObject(parent), m_robot(robot), m_jobs(jobs) {
  connect(&m_robot, &RobotSession::frameArrived, this, &LivePictures::onFrame);
  connect(&m_robot, &RobotSession::polled, this, [this] {
    if (++m_polls % 2 == 0) announce();
  });
}

void LivePictures::setShown(vision::PaneSide side, const QString& camera) { m_shown[static_cast<int>(side)] = camera; }

void LivePictures::setWatched(const QStringList& cameras) {
  if (cameras == m_watched) return;
  m_watched = cameras;
  Q_EMIT watchedChanged();
}

bool LivePictures::isShown(const QString& camera) const { return m_shown[0] == camera || m_shown[1] == camera || m_watched.contains(camera); }

const cv::Mat& LivePictures::picture(const QString& camera) const {
  static const cv::Mat none;
  const auto found = m_entries.find(camera);
  return found == m_entries.end() ? none : found->second.picture;
}

QImage LivePictures::thumbnail(const QString& camera) const {
  const auto found = m_entries.find(camera);
  return found == m_entries.end() ? QImage() : found->second.thumbnail;
}

std::optional<vision::View> LivePictures::view(const QString& camera) const {
  const auto found = m_entries.find(camera);
  return found == m_entries.end() ? std::nullopt : found->second.view;
}

QString LivePictures::whyNoView(const QString& camera) const {
  const auto found = m_entries.find(camera);
  return found == m_entries.end() ? QString() : found->second.why_no_view;
}

double LivePictures::stamp_s(const QString& camera) const {
  const auto found = m_entries.find(camera);
  return found == m_entries.end() ? 0 : found->second.decoded_s;
}

std::optional<double> LivePictures::age(const QString& camera) const {
  if (m_robot.runtime() == nullptr) return {};
  const auto frame = m_robot.runtime()->cameraFrame(camera.toStdString());
  const auto found = m_entries.find(camera);
  if (!frame && found == m_entries.end()) return {};
  const double stamp_s = frame ? frame->stamp_s : found->second.decoded_s;
  return std::max(0.0, m_robot.runtime()->clock().now_s() - stamp_s);
}

void LivePictures::onFrame(const QString& camera) {
  Entry& entry = m_entries[camera];
  if (entry.decoding) return;
  const auto frame = m_robot.runtime()->cameraFrame(camera.toStdString());
  if (!frame) return;
  if (!isShown(camera) && frame->stamp_s - entry.decoded_s < kThumbnailEvery_s && frame->stamp_s >= entry.decoded_s) return;
  decode(camera, frame);
}

void LivePictures::decode(const QString& camera, std::shared_ptr<const hardware::Frame> frame) {
  Entry& entry = m_entries[camera];
  entry.decoding = true;
  const bool small = frame->stamp_s - entry.thumbnail_s >= kThumbnailEvery_s || frame->stamp_s < entry.thumbnail_s;
  m_jobs.run<Decoded>(
      this,
      [frame, small]() -> Result<Decoded> {
        auto picture = vision::decodeImage(frame->data);
        if (!picture) return picture.error();
        return Decoded{*picture, small ? thumbnailOf(*picture) : QImage()};
      },
      [this, camera, frame](Result<Decoded> decoded) {
        m_entries[camera].decoding = false;
        // A damaged frame shows as age: the picture before it grows old.
        if (decoded) take(camera, *frame, *decoded);
      });
}

void LivePictures::take(const QString& camera, const hardware::Frame& frame, const Decoded& decoded) {
  Entry& entry = m_entries[camera];
  entry.picture = decoded.picture;
  entry.decoded_s = frame.stamp_s;
  if (auto* runtime = m_robot.runtime(); runtime != nullptr) {
    auto state = runtime->jointStateAt(frame.stamp_s);
    const auto newest = runtime->jointState();
    if (!state && newest) state = *newest;
    const auto zoom = runtime->zoomAt(frame.camera, frame.stamp_s);
    auto view = !state ? Result<vision::View>(state.error())
                : !zoom ? Result<vision::View>(zoom.error())
                        : session::cameraView(m_workcell ? *m_workcell : runtime->workcell(), frame.camera, *state, *zoom);
    entry.view.reset();
    entry.why_no_view = view ? QString() : QString::fromStdString(view.error().message);
    if (view && view->camera.width <= 0) {
      view->camera.width = decoded.picture.cols;
      view->camera.height = decoded.picture.rows;
    }
    if (view) entry.view = std::move(*view);
  }
  entry.new_picture = true;
  if (decoded.thumbnail.isNull()) return;
  entry.thumbnail = decoded.thumbnail;
  entry.thumbnail_s = frame.stamp_s;
  entry.new_thumbnail = true;
}

void LivePictures::announce() {
  for (auto& [camera, entry] : m_entries) {
    if (std::exchange(entry.new_picture, false)) Q_EMIT pictureArrived(camera);
    if (std::exchange(entry.new_thumbnail, false)) Q_EMIT thumbnailArrived(camera);
  }
}

}  // namespace longarm::ui
