#include "app/virtual_robot/camera_rig.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace longarm::virtual_robot {
namespace {

constexpr double kZoomSpeed = 0.5;       // of the whole range per second
constexpr double kFocusSpeed = 1.0;
constexpr double kNearest_dioptres = 3;
constexpr double kAperture_m = 0.002;

bool isStereo(const planning::CameraSpec& spec) { return !spec.stereo_partner.empty(); }

}  // namespace

Result<CameraRig> CameraRig::load(const planning::Workcell& workcell) {
  CameraRig rig;
  for (const auto& spec : workcell.cameras) {
    auto calibration = vision::CameraCalibration::read(spec.calibration, spec.digital_zoom, spec.width, spec.height);
    if (!calibration) return calibration.error();
    const auto wide = calibration->at(calibration->range().first);
    if (!wide) return wide.error();
    Camera camera{spec, std::move(*calibration), {}, {}};
    if (spec.zooms) {
      const auto [low, high] = camera.calibration.hasTable() ? camera.calibration.range() : std::pair(0.0, 1.0);
      camera.zoom.emplace(low, low, high, kZoomSpeed, 10 * kZoomSpeed);
      camera.focus.emplace(1, 0, 1, kFocusSpeed, 10 * kFocusSpeed);
    }
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

Status CameraRig::setFocus(const std::string& name, double focus) {
  if (!zooms(name)) return {ErrorCode::kNotFound, "camera \"" + name + "\" has no focus"};
  if (!(focus <= 1)) {
    return {ErrorCode::kInvalidInput, "focus " + formatNumber(focus) + " of camera \"" + name +
                                          "\" is not within 0 ... 1, nor negative for its own"};
  }
  Camera& camera = m_cameras.at(name);
  camera.self_focusing = focus < 0;
  if (focus >= 0) camera.focus->moveTo(focus);
  return {};
}

double CameraRig::focus(const std::string& camera) const {
  return zooms(camera) ? m_cameras.at(camera).focus->position() : 1;
}

void CameraRig::see(const std::string& name, double distance_m) {
  if (!zooms(name)) return;
  Camera& camera = m_cameras.at(name);
  if (!camera.self_focusing) return;
  const double sharp = std::clamp(1 - 1 / (kNearest_dioptres * std::max(distance_m, 0.01)), 0.0, 1.0);
  if (camera.focused) {
    camera.focus->moveTo(sharp);
  } else {
    camera.focus->holdAt(sharp);
  }
  camera.focused = true;
}

// The circle of confusion of a thin lens; a disc's standard deviation is a quarter of its diameter.
double CameraRig::blur_px(const std::string& name, double distance_m) const {
  if (!zooms(name)) return 0;
  const double focused = kNearest_dioptres * (1 - focus(name));
  return lens(name).fx * kAperture_m * std::abs(focused - 1 / std::max(distance_m, 0.01)) / 4;
}

void CameraRig::tick(double seconds) {
  for (auto& [name, camera] : m_cameras) {
    if (camera.zoom) camera.zoom->step(seconds);
    if (camera.focus) camera.focus->step(seconds);
  }
}

vision::CameraModel CameraRig::lens(const std::string& name) const {
  const Camera& camera = m_cameras.at(name);
  const double zoom = this->zoom(name);
  const bool table = camera.calibration.hasTable();
  vision::CameraModel lens = camera.calibration.at(table ? zoom : 0)->camera;
  lens.name = name;
  if (table || zoom == 0) return lens;
  const double factor = std::pow(kZoomFactor, zoom);
  lens.fx *= factor;
  lens.fy *= factor;
  lens.skew *= factor;
  return lens;
}

Pose CameraRig::mount(const std::string& name) const {
  const Camera& camera = m_cameras.at(name);
  if (!camera.calibration.hasTable()) return Pose::Identity();
  return camera.calibration.at(zoom(name))->pose->pose;
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
