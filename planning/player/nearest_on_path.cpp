#include "planning/player/nearest_on_path.h"

#include <algorithm>
#include <cmath>

namespace longarm::planning::internal {
namespace {

PathPlace placeAt(const Trajectory& trajectory, const Eigen::VectorXd& measured, double tau) {
  PathPlace place;
  place.tau = tau;
  place.distance = (trajectory.sample(tau).positions - measured).cwiseAbs().maxCoeff(&place.worst_joint);
  return place;
}

// Golden-section search between two times around a coarse minimum.
PathPlace refine(const Trajectory& trajectory, const Eigen::VectorXd& measured, double low, double high) {
  constexpr double kGolden = 0.6180339887498949;
  for (int i = 0; i < 40; ++i) {
    const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    const bool left = placeAt(trajectory, measured, a).distance < placeAt(trajectory, measured, b).distance;
    (left ? high : low) = left ? b : a;
  }
  return placeAt(trajectory, measured, 0.5 * (low + high));
}

// Among places within tolerance the one nearest in time, else the nearest in joints.
bool isBetter(const PathPlace& a, const PathPlace& b, double hint, double tolerance) {
  const bool a_near = a.distance <= tolerance, b_near = b.distance <= tolerance;
  if (a_near != b_near) return a_near;
  return a_near ? std::abs(a.tau - hint) < std::abs(b.tau - hint) : a.distance < b.distance;
}

}  // namespace

PathPlace nearestOnPath(const Trajectory& trajectory, const Eigen::VectorXd& measured, double hint,
                        double tolerance) {
  constexpr double kStep_s = 0.01;
  const double duration = trajectory.duration();
  const int steps = std::clamp(static_cast<int>(std::ceil(duration / kStep_s)), 1, 100000);
  std::vector<double> distance(static_cast<std::size_t>(steps) + 1);
  for (int i = 0; i <= steps; ++i) {
    distance[static_cast<std::size_t>(i)] = placeAt(trajectory, measured, duration * i / steps).distance;
  }
  PathPlace best = placeAt(trajectory, measured, 0);
  for (int i = 0; i <= steps; ++i) {
    const double here = distance[static_cast<std::size_t>(i)];
    if (i > 0 && distance[static_cast<std::size_t>(i) - 1] < here) continue;
    if (i < steps && distance[static_cast<std::size_t>(i) + 1] < here) continue;
    const auto place = refine(trajectory, measured, duration * std::max(0, i - 1) / steps,
                              duration * std::min(steps, i + 1) / steps);
    for (const auto& p : {place, placeAt(trajectory, measured, duration * i / steps)}) {
      if (isBetter(p, best, hint, tolerance)) best = p;
    }
  }
  return best;
}

}  // namespace longarm::planning::internal
