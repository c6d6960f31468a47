#include "calibration/health/miss_watch.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/text.h"

namespace longarm::calibration {
namespace {

// Upper quantile of the normal distribution (Abramowitz and Stegun, 26.2.23, refined by one Newton step).
double normalLimit(double probability) {
  const double t = std::sqrt(-2 * std::log(probability));
  double z = t - (2.515517 + 0.802853 * t + 0.010328 * t * t) / (1 + 1.432788 * t + 0.189269 * t * t + 0.001308 * t * t * t);
  const double tail = 0.5 * std::erfc(z / std::sqrt(2.0)), density = std::exp(-0.5 * z * z) / std::sqrt(2 * 3.14159265358979323846);
  return z + (tail - probability) / density;
}

// Offsets of one camera or pair: their weighted mean and their sum of squares in sigmas.
struct Tally {
  int samples = 0, dof = 0;
  double weight = 0, squares = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int axes = 1;

  void add(const Eigen::Vector2d& offset, double sigma, int offset_axes) {
    const double w = 1 / (sigma * sigma);
    ++samples;
    axes = offset_axes;
    dof += axes;
    weight += w;
    sum += w * offset;
    squares += w * offset.squaredNorm();
  }
  double mean() const { return (sum / weight).norm(); }
  HealthLevel level(const HealthLimits& limits) const {
    if (samples < limits.least_samples) return HealthLevel::kUnknown;
    const double of_mean = sum.squaredNorm() / weight;
    // Two tests at half the chance each.
    const auto beyond = [&](double chance) { return of_mean > chiSquareLimit(axes, chance / 2) || squares > chiSquareLimit(dof, chance / 2); };
    if (beyond(limits.knocked) && std::max(mean(), std::sqrt(squares / weight)) >= limits.least_px) return HealthLevel::kKnocked;
    return beyond(limits.doubtful) ? HealthLevel::kDoubtful : HealthLevel::kGood;
  }
};

void raise(CameraHealth* health, const Tally& tally, HealthLevel level, const std::string& why) {
  health->samples += tally.samples;
  if (level < health->level) return;
  if (level == health->level && tally.mean() < health->off_px) return;
  health->level = level;
  health->off_px = tally.mean();
  health->why = level >= HealthLevel::kDoubtful ? why : std::string();
}

std::string missText(const std::string& a, const std::string& b, const Tally& tally) {
  return "Lines of sight of " + a + " and " + b + " pass each other by " + formatFixed(tally.mean(), 1) + " px on average over " +
         std::to_string(tally.samples) + " picks: one of the two was knocked. Calibrate the pose of the one that moved.";
}

std::string landmarkText(const std::string& camera, const Tally& tally) {
  return "Known points appear " + formatFixed(tally.mean(), 1) + " px beside their places in " + camera + " (" + std::to_string(tally.samples) +
         " picks): it was knocked, or the points moved. Calibrate its pose.";
}

}  // namespace

double chiSquareLimit(int dof, double probability) {
  const double z = normalLimit(probability);
  if (dof == 1) {
    const double two_sided = normalLimit(probability / 2);
    return two_sided * two_sided;
  }
  if (dof == 2) return -2 * std::log(probability);
  const double k = 2.0 / (9.0 * dof);
  return dof * std::pow(1 - k + z * std::sqrt(k), 3);
}

std::map<std::string, CameraHealth> healthOf(const std::vector<MissSample>& misses, const std::vector<LandmarkSample>& landmarks,
                                             const HealthLimits& limits) {
  std::map<std::string, CameraHealth> out;
  std::map<std::string, Tally> known;
  for (const auto& s : landmarks) known[s.camera].add(s.residual_px, s.sigma_px, 2);
  for (const auto& [camera, tally] : known) raise(&out[camera], tally, tally.level(limits), landmarkText(camera, tally));
  std::map<std::pair<std::string, std::string>, Tally> pairs;
  for (const auto& s : misses) {
    const bool ordered = s.camera_a < s.camera_b;
    // The sign of a miss changes with the order of the two.
    pairs[ordered ? std::pair(s.camera_a, s.camera_b) : std::pair(s.camera_b, s.camera_a)].add({ordered ? s.miss_px : -s.miss_px, 0}, s.sigma_px, 1);
  }
  // Known points say which of the two it is not.
  std::set<std::string> sound;
  for (const auto& [camera, health] : out) {
    if (health.level == HealthLevel::kGood) sound.insert(camera);
  }
  for (const auto& [cameras, tally] : pairs) {
    const auto& [a, b] = cameras;
    const HealthLevel level = tally.level(limits);
    const bool alarm = level >= HealthLevel::kDoubtful;
    for (const auto& camera : {a, b}) {
      const std::string& other = camera == a ? b : a;
      const bool cleared = alarm && sound.count(camera) != 0 && sound.count(other) == 0;
      raise(&out[camera], tally, cleared ? HealthLevel::kGood : level, missText(a, b, tally));
    }
  }
  return out;
}

}  // namespace longarm::calibration
