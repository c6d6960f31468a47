#include "planning/macros/tool_directions.h"

#include <cmath>

#include "core/pose.h"

namespace longarm::planning {

std::vector<ToolDirection> directionsAround(const Eigen::Vector3d& axis, double most, double step) {
  std::vector<ToolDirection> out{{axis.normalized(), 0}};
  const Eigen::Matrix3d R = rotationWithZ(axis);
  for (int ring = 1; ring * step <= most + 1e-9; ++ring) {
    for (int k = 0; k < 8; ++k) {
      const double azimuth = k * M_PI / 4, tilt = ring * step;
      out.push_back({R * Eigen::Vector3d(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)), ring});
    }
  }
  return out;
}

std::vector<double> anglesAround(double most, double step) {
  std::vector<double> out{0};
  for (int i = 1; i * step <= most + 1e-9; ++i) {
    out.push_back(i * step);
    out.push_back(-i * step);
  }
  return out;
}

}  // namespace longarm::planning
