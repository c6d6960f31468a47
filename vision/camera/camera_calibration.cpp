#include "vision/camera/camera_calibration.h"

#include <algorithm>
#include <cmath>

#include "core/require.h"
#include "core/text.h"

namespace longarm::vision {
namespace {

constexpr Eigen::Index kPixels = 5;                // fx fy skew cx cy: the first numbers of a camera file's covariance

}  // namespace

CameraModel enlarged(const CameraModel& camera, double factor) {
  LONGARM_REQUIRE(factor > 0 && camera.width > 0 && camera.height > 0, "an enlargement needs a factor and a picture's size");
  CameraModel out = camera;
  const double u = (camera.width - 1) / 2.0, v = (camera.height - 1) / 2.0;
  out.fx *= factor;
  out.fy *= factor;
  out.skew *= factor;
  out.cx = u + factor * (camera.cx - u);
  out.cy = v + factor * (camera.cy - v);
  return out;
}

Result<CameraCalibration> CameraCalibration::read(const std::string& path, const DigitalZoom& digital, int width,
                                                  int height) {
  CameraCalibration out;
  out.m_path = path;
  out.m_digital = digital;
  out.m_width = width;
  out.m_height = height;
  auto file = readCameraFile(path);
  if (file) {
    out.m_file = std::move(*file);
    return out;
  }
  auto table = readZoomFile(path);
  if (!table || table->cameras.empty()) return file.error();
  if (table->cameras.front().nodes.empty()) return Error{ErrorCode::kInvalidInput, path + ": has no <SR_zoom> setting"};
  out.m_table = table->cameras.front();
  out.m_predictions = predictFromOthers(*out.m_table);
  return out;
}

std::pair<double, double> CameraCalibration::range() const {
  if (!m_table) return {0, m_digital.factor > 1 && m_digital.from <= 0 ? 1 : 0};
  const auto [low, high] = std::minmax_element(m_table->nodes.begin(), m_table->nodes.end(),
                                               [](const ZoomNode& a, const ZoomNode& b) { return a.zoom < b.zoom; });
  const bool digital = m_digital.from < 1 && high->zoom >= m_digital.from;
  return {low->zoom, digital ? 1 : high->zoom};
}

Error CameraCalibration::outside(double setting) const {
  const auto [low, high] = range();
  const std::string where = m_path + ": zoom " + formatFixed(setting, 3);
  if (!m_table) {
    return {ErrorCode::kOutOfLimits, where + " is not calibrated: the file has one setting only, 0. Zoom out fully, or "
                                             "calibrate the camera at more settings"};
  }
  return {ErrorCode::kOutOfLimits, where + " is outside the calibrated settings " + formatFixed(low, 3) + " to " +
                                       formatFixed(high, 3) + ". Zoom back, or calibrate the camera there"};
}

Result<CameraFile> CameraCalibration::tableAt(double setting) const {
  const auto node = zoomAt(*m_table, setting);
  if (!node) return outside(setting);
  auto file = cameraFileOf(*m_table, *node);
  if (file) {
    file->camera.width = m_width;
    file->camera.height = m_height;
    file->covariance = lensDoubt(m_predictions, *node);
  }
  return file;
}

Result<CameraFile> CameraCalibration::at(std::optional<double> setting) const {
  if (m_table && !setting) {
    return Error{ErrorCode::kNotFound, m_path + ": is a zoom camera's, and the setting of its zoom is not known yet"};
  }
  const double zoom = setting.value_or(0);
  const bool digital = m_digital.factor > 1 && zoom > m_digital.from;
  if (m_file && zoom != 0 && !(digital && m_digital.from <= 0)) return outside(zoom);
  if (zoom > 1) return outside(zoom);
  auto file = m_file ? Result<CameraFile>(*m_file) : tableAt(digital ? m_digital.from : zoom);
  if (!file || !digital || file->camera.width <= 0) return file;
  const double factor = std::pow(m_digital.factor, (zoom - m_digital.from) / (1 - m_digital.from));
  file->camera = enlarged(file->camera, factor);
  // Focal lengths, skew and principal point are in pixels; distortion is not.
  if (file->covariance) {
    file->covariance->topRows<kPixels>() *= factor;
    file->covariance->leftCols<kPixels>() *= factor;
  }
  return file;
}

std::optional<double> CameraCalibration::magnification(double setting) const {
  const auto wide = at(range().first), here = at(setting);
  if (!wide || !here) return {};
  return here->camera.fx / wide->camera.fx;
}

}  // namespace longarm::vision
