#include "planning/player/path_table.h"

#include <algorithm>
#include <cmath>

namespace longarm::planning::internal {
namespace {

// Coefficients of the quintic Hermite piece that Trajectory::sample() follows between two points.
std::array<double, 6> quinticBetween(const TrajectoryPoint& a, const TrajectoryPoint& b, Eigen::Index j) {
  const double h = b.t - a.t;
  const double d = b.positions[j] - a.positions[j] - h * (a.velocities[j] + 0.5 * h * a.accelerations[j]);
  const double dv = (b.velocities[j] - a.velocities[j] - a.accelerations[j] * h) * h;
  const double da = (b.accelerations[j] - a.accelerations[j]) * h * h;
  const double h3 = h * h * h;
  return {a.positions[j],
          a.velocities[j],
          0.5 * a.accelerations[j],
          (10 * d - 4 * dv + 0.5 * da) / h3,
          (-15 * d + 7 * dv - da) / (h3 * h),
          (6 * d - 3 * dv + 0.5 * da) / (h3 * h * h)};
}

}  // namespace

PathTable::PathTable(const Trajectory& trajectory, const MotionLimits& limits)
    : m_max_velocity(limits.max_velocity.data(), limits.max_velocity.data() + limits.max_velocity.size()),
      m_max_acceleration(limits.max_acceleration.data(),
                         limits.max_acceleration.data() + limits.max_acceleration.size()) {
  const auto& points = trajectory.points;
  for (const auto& p : points) m_times.push_back(p.t);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    for (Eigen::Index j = 0; j < points[i].positions.size(); ++j) {
      m_segments.push_back(quinticBetween(points[i], points[i + 1], j));
    }
  }
}

std::size_t PathTable::segmentOf(double tau) const {
  const auto next = std::upper_bound(m_times.begin(), m_times.end(), tau);
  const auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, next - m_times.begin() - 1));
  return std::min(i, m_times.size() - 2);
}

bool PathTable::keepsLimits(double tau, double r, double u, double share) const {
  if (m_times.size() < 2) return true;
  const std::size_t segment = segmentOf(tau);
  const double s = std::clamp(tau, 0.0, duration()) - m_times[segment];
  const std::size_t n = m_max_velocity.size();
  const Quintic* c = &m_segments[segment * n];
  for (std::size_t j = 0; j < n; ++j, ++c) {
    const auto& k = *c;
    const double d1 = k[1] + s * (2 * k[2] + s * (3 * k[3] + s * (4 * k[4] + s * 5 * k[5])));
    const double d2 = 2 * k[2] + s * (6 * k[3] + s * (12 * k[4] + s * 20 * k[5]));
    if (std::abs(d1 * r) > share * m_max_velocity[j]) return false;
    if (std::abs(d2 * r * r + d1 * u) > share * m_max_acceleration[j]) return false;
  }
  return true;
}

}  // namespace longarm::planning::internal
