#pragma once

/// @file
/// Distorted stereo heads with known geometry, random points before them, and picks with known noise.

#include <random>
#include <string>
#include <vector>

#include "vision/snapshot/view.h"
#include "vision/stereo/triangulate.h"

namespace longarm::tests {

/// The built-in robot's kind of camera: 640x480, f = 740 px, a real lens.
inline vision::CameraModel lensCamera(const std::string& name = "test") {
  vision::CameraModel camera;
  camera.name = name;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 741.5;
  camera.fy = 738.25;
  camera.cx = 322.5;
  camera.cy = 237.25;
  camera.distortion = {-0.25, 0.08, 0.0007, -0.0004, -0.01};
  return camera;
}

/// Without lens: f = 800 px, as the worked figures of the literature have it.
inline vision::CameraModel pinhole(const std::string& name = "test") {
  vision::CameraModel camera;
  camera.name = name;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 800;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

inline vision::View viewOf(const vision::CameraModel& camera, const Eigen::Vector3d& p_WC,
                           const Eigen::Vector3d& rotvec = Eigen::Vector3d::Zero()) {
  vision::View view;
  view.name = camera.name;
  view.camera = camera;
  view.parent = "head";
  view.X_WC.translation() = p_WC;
  view.X_WC.linear() = expSO3(rotvec);
  return view;
}

/// Left at the origin looking along z of the parent, right `baseline` beside it and turned a little inwards.
struct StereoRig {
  explicit StereoRig(bool lens = true, double baseline = 0.25)
      : left(viewOf(lens ? lensCamera("left") : pinhole("left"), {0, 0, 0})),
        right(viewOf(lens ? lensCamera("right") : pinhole("right"), {baseline, 0.004, -0.003},
                     lens ? Eigen::Vector3d(0.01, -0.05, 0.02) : Eigen::Vector3d::Zero())) {
    if (!lens) right.X_WC.translation() = Eigen::Vector3d(baseline, 0, 0);
  }
  vision::View left, right;
};

/// Deterministic random numbers.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : m_rng(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(m_rng); }
  double normal(double sigma) { return sigma * std::normal_distribution<double>(0, 1)(m_rng); }
  Eigen::Vector2d normal2(double sigma) {
    const double a = normal(sigma);
    return {a, normal(sigma)};
  }
  Eigen::Vector3d normal3(double sigma) {
    const Eigen::Vector2d a = normal2(sigma);
    return {a.x(), a.y(), normal(sigma)};
  }

 private:
  std::mt19937_64 m_rng;
};

inline bool sees(const vision::View& view, const Eigen::Vector3d& p_W) {
  const auto pixel = view.project(p_W);
  return pixel.ok() && view.camera.containsPixel(*pixel);
}

/// A point that every view sees, at a depth between the two in the first one.
inline Eigen::Vector3d pointSeenByAll(const std::vector<const vision::View*>& views, double near_m, double far_m,
                                      Dice* dice) {
  while (true) {
    const double z = dice->uniform(near_m, far_m);
    const Eigen::Vector3d p = views.front()->X_WC * Eigen::Vector3d(dice->uniform(-0.45, 0.45) * z,
                                                                    dice->uniform(-0.35, 0.35) * z, z);
    bool seen = true;
    for (const auto* view : views) seen = seen && sees(*view, p);
    if (seen) return p;
  }
}

/// Exact picks of a point, moved by `noise_px` of the dice where one is given.
inline std::vector<vision::Sighting> sightingsOf(const std::vector<const vision::View*>& views,
                                                 const Eigen::Vector3d& p_W, Dice* dice = nullptr,
                                                 double noise_px = 0) {
  std::vector<vision::Sighting> sightings;
  for (const auto* view : views) {
    Eigen::Vector2d pixel = view->project(p_W).value();
    if (dice != nullptr) pixel += dice->normal2(noise_px);
    sightings.push_back({view, pixel, 0});
  }
  return sightings;
}

}  // namespace longarm::tests
