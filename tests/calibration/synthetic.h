#pragma once

/// @file
/// Cameras, fixtures and boards with known truth.

#include <cmath>
#include <random>
#include <vector>

#include "calibration/intrinsics/board_view.h"
#include "calibration/solve/lens_parameters.h"
#include "core/pose.h"
#include "vision/camera/camera_model.h"

namespace longarm::tests {

inline constexpr double kDegree = 3.14159265358979323846 / 180;

/// A seeded source of numbers.
class Random {
 public:
  explicit Random(unsigned seed) : m_engine(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(m_engine); }
  double normal(double sigma = 1) { return std::normal_distribution<double>(0, sigma)(m_engine); }
  Eigen::Vector3d vector(double sigma = 1) { return {normal(sigma), normal(sigma), normal(sigma)}; }
  Eigen::Vector3d direction() { return vector().normalized(); }
  Eigen::Matrix3d rotation() {
    Eigen::Vector4d q(normal(), normal(), normal(), normal());
    return poseFrom({0, 0, 0}, q).linear();
  }
  std::mt19937& engine() { return m_engine; }

 private:
  std::mt19937 m_engine;
};

inline vision::CameraModel cameraOf(double fx, double fy, double cx, double cy, int width = 640, int height = 480) {
  vision::CameraModel camera;
  camera.fx = fx;
  camera.fy = fy;
  camera.cx = cx;
  camera.cy = cy;
  camera.width = width;
  camera.height = height;
  return camera;
}

inline Eigen::Vector2d pixelOf(const vision::CameraModel& camera, const Eigen::Vector3d& p_C) {
  return camera.pixelOfNormalised(p_C.head<2>() / p_C.z());
}

inline Pose poseOf(const Eigen::Vector3d& rotvec, const Eigen::Vector3d& translation) {
  Pose X = Pose::Identity();
  X.linear() = expSO3(rotvec);
  X.translation() = translation;
  return X;
}

/// Four planes of 7 x 5 points, 0.6 x 0.4 m, spread over `depth`: the sliding panel.
inline std::vector<Eigen::Vector3d> slidingPanel(double depth = 0.3) {
  std::vector<Eigen::Vector3d> out;
  for (int plane = 0; plane < 4; ++plane) {
    for (int r = 0; r < 5; ++r) {
      for (int c = 0; c < 7; ++c) out.emplace_back(-0.3 + 0.1 * c, -0.2 + 0.1 * r, depth * plane / 3);
    }
  }
  return out;
}

inline calibration::BoardView picture(const vision::CameraModel& camera, const Pose& X_CK,
                                      const std::vector<Eigen::Vector3d>& points, Random* random = nullptr,
                                      double noise_px = 0) {
  calibration::BoardView view;
  for (const auto& p : points) {
    Eigen::Vector2d pixel = pixelOf(camera, X_CK * p);
    if (random != nullptr) pixel += Eigen::Vector2d(random->normal(noise_px), random->normal(noise_px));
    view.corners.push_back({p, pixel, static_cast<int>(view.corners.size()) + 2});
  }
  return view;
}

inline std::vector<Eigen::Vector3d> board(int columns = 9, int rows = 6, double square = 0.03) {
  std::vector<Eigen::Vector3d> out;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) out.emplace_back(c * square, r * square, 0);
  }
  return out;
}

/// A board somewhere in the picture, tilted up to `tilt` about both axes.
inline Pose boardPose(Random* random, double tilt = 0.6, double distance = 0.55) {
  const Pose X_KP = poseOf({0, 0, 0}, {0.12, 0.075, 0});
  const Pose X_CP = poseOf({random->uniform(-tilt, tilt), random->uniform(-tilt, tilt), random->uniform(-0.5, 0.5)},
                           {random->uniform(-0.08, 0.08), random->uniform(-0.06, 0.06), distance * random->uniform(0.85, 1.25)});
  return X_CP * X_KP.inverse();
}

}  // namespace longarm::tests
