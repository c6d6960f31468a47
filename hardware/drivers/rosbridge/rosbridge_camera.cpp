#include "hardware/drivers/rosbridge/rosbridge_camera.h"

#include <cmath>
#include <utility>

#include "core/text.h"

namespace longarm::hardware {
namespace {

// "jpeg", or as image_transport writes it: "bgr8; jpeg compressed bgr8".
std::string formatOf(const std::string& said) {
  if (said.find("png") != std::string::npos) return "png";
  if (said.find("jp") != std::string::npos) return "jpeg";
  return {};
}

}  // namespace

RosbridgeCamera::RosbridgeCamera(std::string name, RosbridgeRobot robot, CameraSettings settings,
                                 const TopicNames& topics)
    : LinkedDevice<Camera>(name, std::move(robot)),
      m_settings(settings),
      m_image_topic(topics.image(name)),
      m_zoom(name, "zoom", topics.zoom(name), topics.zoomState(name)),
      m_focus(name, "focus", topics.focus(name), topics.focusState(name)) {
  if (!m_settings.zooms) return;
  for (const auto& topic : {topics.zoom(name), topics.focus(name)}) link().advertise(topic, rosbridge::Float64Message::kType);
}

RosbridgeCamera::~RosbridgeCamera() { close(); }

Status RosbridgeCamera::onActivate() {
  rosbridge::Subscribe what;
  what.topic = m_image_topic;
  what.type = rosbridge::CompressedImageMessage::kType;
  what.compression = "cbor";
  what.throttle_rate_ms = static_cast<int>(std::lround(1000 / m_settings.max_rate_hz));
  what.queue_length = 1;
  std::lock_guard<std::mutex> lock(m_mutex);
  if (m_subscription != 0) return {};
  m_subscription = link().subscribe(std::move(what), [this](const auto& message, double received_s) -> Status {
    if (auto status = take(message, received_s); !status) runner().trouble(status.error());
    return {};                           // no other device's matter
  });
  return {};
}

Status RosbridgeCamera::onStop() {
  std::uint64_t ended = 0;
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    std::swap(ended, m_subscription);
  }
  if (ended != 0) link().unsubscribe(ended);
  return {};
}

Status RosbridgeCamera::take(const rosbridge::Publish& message, double received_s) {
  auto read = rosbridge::readAs<rosbridge::CompressedImageMessage>(message.message);
  if (!read) return read.error();
  Frame frame;
  frame.format = formatOf(read->format);
  if (frame.format.empty()) {
    return {ErrorCode::kInvalidInput, "a picture of format \"" + read->format.substr(0, 60) + "\"; jpeg or png is expected"};
  }
  if (read->data.empty()) return {ErrorCode::kInvalidInput, "a picture without data"};
  const auto offset = joints().offset();
  frame.camera = name();
  frame.received_s = received_s;
  frame.stamp_s = offset && read->header.stamp_s != 0 ? read->header.stamp_s + *offset : received_s;
  frame.sequence = ++m_count;
  frame.data = std::move(read->data);
  m_frame.publish(std::move(frame));
  return {};
}

Status RosbridgeCamera::onOpen() {
  if (m_settings.zooms) {
    m_zoom.connect(link());
    m_focus.connect(link());
  }
  return LinkedDevice<Camera>::onOpen();
}

Status RosbridgeCamera::onClose() {
  if (m_settings.zooms) {
    m_zoom.disconnect(link());
    m_focus.disconnect(link());
  }
  return LinkedDevice<Camera>::onClose();
}

Status RosbridgeCamera::command(LensState& lens, const char* doing, double wanted) {
  if (auto status = link().requireUp(); !status) return {status.error().code, name() + ": " + status.error().message};
  return runner().configure(doing, [&] { return lens.command(link(), wanted, robot().clock->now_s()); });
}

Status RosbridgeCamera::setZoom(double zoom01) {
  if (!m_settings.zooms) return Camera::setZoom(zoom01);
  if (!(zoom01 >= 0)) return {ErrorCode::kOutOfLimits, name() + ": zoom " + formatNumber(zoom01) + " is not within 0 ... 1"};
  return command(m_zoom, "zooming", zoom01);
}

Status RosbridgeCamera::setFocus(double focus01) {
  if (!m_settings.zooms) return Camera::setFocus(focus01);
  if (!(focus01 >= 0)) return {ErrorCode::kOutOfLimits, name() + ": focus " + formatNumber(focus01) + " is not within 0 ... 1"};
  return command(m_focus, "focusing", focus01);
}

Status RosbridgeCamera::focusItself() { return m_settings.zooms ? command(m_focus, "focusing", -1) : Camera::focusItself(); }

void RosbridgeCamera::haltLens() noexcept {
  if (!m_settings.zooms) return;
  try {
    m_zoom.halt(link(), robot().clock->now_s());
    m_focus.halt(link(), robot().clock->now_s());
  } catch (const std::exception& e) {
    runner().trouble({ErrorCode::kInternal, std::string("stopping the lens: ") + e.what()});
  }
}

}  // namespace longarm::hardware
