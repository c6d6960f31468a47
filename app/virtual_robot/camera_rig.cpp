#include "app/virtual_robot/camera_rig.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "vision/camera/camera_file.h"

namespace longarm::virtual_robot {
namespace {

constexpr double kZoomSpeed = 0.5;       // of the whole range per second

bool isStereo(const planning::CameraSpec& spec) { return !spec.stereo_partner.empty(); }

}  // namespace

Result<CameraRig> CameraRig::load(const planning::Workcell& workcell) {
  CameraRig rig;
  for (const auto& spec : workcell.cameras) {
    Camera camera;
    camera.spec = spec;
    const bool ptz = spec.role == "ptz";
    camera.zoom_file = ptz && vision::readCameraFile(spec.calibration, 0.0).ok();
    const auto file = vision::readCameraFile(spec.calibration, camera.zoom_file ? std::optional<double>(0) : std::nullopt);
    if (!file) return file.error();
    camera.wide = file->camera;
    camera.wide.name = spec.name;
    if (ptz) camera.zoom.emplace(0, 0, 1, kZoomSpeed, 10 * kZoomSpeed);
    rig.m_cameras.emplace(spec.name, std::move(camera));
  }
  return rig;
}

std::vector<std::string> CameraRig::names() const {
  std::vector<std::string> out;
  for (const auto& [name, camera] : m_cameras) out.push_back(name);
  return out;
}

bool CameraRig::zooms(const std::string& camera) const { return has(camera) && m_cameras.at(camera).zoom.has_value(); }

void CameraRig::want(const std::string& name, bool on, double least_period_s) {
  const auto found = m_cameras.find(name);
  if (found == m_cameras.end()) return;
  Camera& camera = found->second;
  camera.wanted = on;
  camera.period_s = std::max(isStereo(camera.spec) ? kStereoPeriod_s : kPeriod_s, least_period_s);
}

Status CameraRig::setZoom(const std::string& camera, double zoom) {
  if (!zooms(camera)) return {ErrorCode::kNotFound, "camera \"" + camera + "\" has no zoom"};
  if (!(zoom >= 0 && zoom <= 1)) {
    return {ErrorCode::kInvalidInput, "zoom " + formatNumber(zoom) + " of camera \"" + camera +
                                          "\" is not within 0 ... 1"};
  }
  m_cameras.at(camera).zoom->moveTo(zoom);
  return {};
}

double CameraRig::zoom(const std::string& camera) const {
  return zooms(camera) ? m_cameras.at(camera).zoom->position() : 0;
}

void CameraRig::tick(double seconds) {
  for (auto& [name, camera] : m_cameras) {
    if (camera.zoom) camera.zoom->step(seconds);
  }
}

vision::CameraModel CameraRig::lens(const std::string& name) const {
  const Camera& camera = m_cameras.at(name);
  const double zoom = this->zoom(name);
  if (zoom == 0) return camera.wide;
  if (camera.zoom_file) {
    if (const auto file = vision::readCameraFile(camera.spec.calibration, zoom)) {
      vision::CameraModel lens = file->camera;
      lens.name = name;
      return lens;
    }
  }
  vision::CameraModel lens = camera.wide;
  const double factor = std::pow(kZoomFactor, zoom);
  lens.fx *= factor;
  lens.fy *= factor;
  lens.skew *= factor;
  return lens;
}

std::vector<std::string> CameraRig::takeDue(double now_s) {
  const Camera* first = nullptr;
  for (const auto& [name, camera] : m_cameras) {
    if (!camera.wanted || camera.due_s > now_s + 1e-9) continue;
    if (first == nullptr || camera.due_s < first->due_s) first = &camera;
  }
  if (first == nullptr) return {};
  std::vector<std::string> out = {first->spec.name};
  const auto partner = m_cameras.find(first->spec.stereo_partner);
  if (partner != m_cameras.end() && partner->second.wanted) out.push_back(partner->first);
  std::sort(out.begin(), out.end());
  for (const auto& name : out) {
    Camera& camera = m_cameras.at(name);
    // On a grid of its period, so that pairs stay together; what was missed is not made up for.
    camera.due_s = camera.period_s * (std::floor(now_s / camera.period_s + 1e-6) + 1);
  }
  return out;
}

}  // namespace longarm::virtual_robot
