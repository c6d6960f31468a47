#pragma once

/// @file
/// Reads a scene of the Middlebury 2014 stereo data (by others, found by LONGARM_DATA).

#include <algorithm>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/text.h"
#include "tests/vision/stereo_rig.h"

namespace longarm::tests {

/// One scene of the Middlebury 2014 stereo data: rectified pair with true disparity of the left picture.
struct MiddleburyData {
  double f = 0, cx0 = 0, cx1 = 0, cy = 0, doffs = 0, baseline = 0;   // [px], [m]
  int width = 0, height = 0;
  std::vector<float> disparity;                                      // top row first; inf: unknown

  float at(int u, int v) const { return disparity[static_cast<std::size_t>(v * width + u)]; }
  vision::View view(bool right) const {
    vision::CameraModel camera;
    camera.name = right ? "right" : "left";
    camera.width = width;
    camera.height = height;
    camera.fx = camera.fy = f;
    camera.cx = right ? cx1 : cx0;
    camera.cy = cy;
    return viewOf(camera, {right ? baseline : 0, 0, 0});
  }
  Eigen::Vector3d truth(int u, int v) const {
    const double z = baseline * f / (at(u, v) + doffs);
    return {(u - cx0) * z / f, (v - cy) * z / f, z};
  }
};

inline MiddleburyData loadMiddlebury(const std::string& folder) {
  MiddleburyData scene;
  std::ifstream calibration(folder + "/calib.txt");
  for (std::string line; std::getline(calibration, line);) {
    const auto equals = line.find('=');
    if (equals == std::string::npos) continue;
    const std::string key(trimmed(line.substr(0, equals)));
    std::string values = line.substr(equals + 1);
    std::replace_if(values.begin(), values.end(), [](char c) { return std::strchr("[];\r", c) != nullptr; }, ' ');
    const auto numbers = parseNumbers(values);
    if (!numbers || numbers->empty()) continue;
    if (key == "cam0") {
      scene.f = (*numbers)[0];
      scene.cx0 = (*numbers)[2];
      scene.cy = (*numbers)[5];
    }
    if (key == "cam1") scene.cx1 = (*numbers)[2];
    if (key == "doffs") scene.doffs = (*numbers)[0];
    if (key == "baseline") scene.baseline = 1e-3 * (*numbers)[0];
    if (key == "width") scene.width = static_cast<int>((*numbers)[0]);
    if (key == "height") scene.height = static_cast<int>((*numbers)[0]);
  }
  const auto pfm = readTextFile(folder + "/disp0GT.pfm", 64u << 20);
  if (!pfm) return {};
  const std::size_t size = static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height);
  if (pfm->size() < size * sizeof(float)) return {};
  std::vector<float> rows(size);      // the file has its last row first, after a short text header
  std::memcpy(rows.data(), pfm->data() + pfm->size() - size * sizeof(float), size * sizeof(float));
  scene.disparity.resize(size);
  const auto width = static_cast<std::size_t>(scene.width), height = static_cast<std::size_t>(scene.height);
  for (std::size_t v = 0; v < height; ++v) {
    std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>((height - 1 - v) * width), width,
                scene.disparity.begin() + static_cast<std::ptrdiff_t>(v * width));
  }
  return scene;
}

}  // namespace longarm::tests
