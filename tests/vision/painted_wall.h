#pragma once

/// @file
/// A painted wall before a pair of cameras, rendered through their lenses; the truth of every pixel is known.

#include <array>
#include <cmath>
#include <cstdint>

#include <Eigen/Dense>
#include <opencv2/core/mat.hpp>

#include "tests/vision/stereo_rig.h"

namespace longarm::tests {

/// A plane with paint that is a function of the place on it, smooth at the scale of a pixel.
class PaintedWall {
 public:
  /// Smooth random paint with details from 6 mm to 10 cm, never the same twice.
  static PaintedWall textured(std::uint64_t seed) { return PaintedWall(seed, 0); }
  /// Dots every `period` metres, all alike.
  static PaintedWall repeated(double period) { return PaintedWall(0, period); }

  /// Point of the wall at its own coordinates [m].
  Eigen::Vector3d at(double x, double y) const { return m_origin + x * m_x + y * m_y; }

  /// What a camera sees: 8-bit grey, 2 x 2 samples a pixel.  `noise` is a share of 255.
  cv::Mat seenBy(const vision::View& view, Dice* dice, double gain, double noise) const {
    cv::Mat image(view.camera.height, view.camera.width, CV_8UC1);
    for (int row = 0; row < image.rows; ++row) {
      for (int column = 0; column < image.cols; ++column) {
        double sum = 0;
        for (const double dv : {-0.25, 0.25}) {
          for (const double du : {-0.25, 0.25}) sum += paintSeen(view, {column + du, row + dv});
        }
        double grey = gain * 255 * sum / 4;
        if (dice != nullptr && noise > 0) grey += dice->normal(255 * noise);
        image.at<unsigned char>(row, column) = cv::saturate_cast<unsigned char>(grey);
      }
    }
    return image;
  }

 private:
  PaintedWall(std::uint64_t seed, double period) : m_period(period) {
    Dice dice(seed);
    for (auto& wave : m_phases) wave = dice.uniform(0, 1e4);
    const Eigen::Matrix3d R = expSO3({0.15, 0.3, 0.05});
    m_x = R.col(0);
    m_y = R.col(1);
    m_origin = {0.1, 0, 1.5};
  }

  double paintSeen(const vision::View& view, const Eigen::Vector2d& pixel) const {
    const auto n = view.camera.normalisedOfPixel(pixel);
    if (!n) return 0;
    const Eigen::Vector3d ray = view.X_WC.linear() * Eigen::Vector3d(n->x(), n->y(), 1), centre = view.X_WC.translation();
    const Eigen::Vector3d normal = m_x.cross(m_y);
    const Eigen::Vector3d p = centre + normal.dot(m_origin - centre) / normal.dot(ray) * ray - m_origin;
    return paint(p.dot(m_x), p.dot(m_y));
  }

  double paint(double x, double y) const {
    if (m_period > 0) {
      return 0.5 + 0.35 * std::sin(2 * M_PI * x / m_period) * std::sin(2 * M_PI * y / m_period);
    }
    return 0.5 + 0.28 * valueNoise(x / 0.05 + m_phases[0], y / 0.05 + m_phases[1]) +
           0.22 * valueNoise(x / 0.016 + m_phases[2], y / 0.016 + m_phases[3]) +
           0.12 * valueNoise(x / 0.008 + m_phases[4], y / 0.008 + m_phases[5]);
  }

  // A random value in [-1, 1] at every whole place, joined smoothly.
  static double valueNoise(double x, double y) {
    const double cx = std::floor(x), cy = std::floor(y);
    const auto smooth = [](double t) { return t * t * t * (t * (6 * t - 15) + 10); };
    const double a = smooth(x - cx), b = smooth(y - cy);
    const auto i = static_cast<std::int64_t>(cx), k = static_cast<std::int64_t>(cy);
    return (1 - b) * ((1 - a) * hashed(i, k) + a * hashed(i + 1, k)) + b * ((1 - a) * hashed(i, k + 1) + a * hashed(i + 1, k + 1));
  }

  static double hashed(std::int64_t x, std::int64_t y) {
    std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ull ^ static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4Full;
    h ^= h >> 29;
    h *= 0xBF58476D1CE4E5B9ull;
    h ^= h >> 32;
    return static_cast<double>(h & 0xFFFFFF) / 0x7FFFFF - 1;
  }

  double m_period;
  std::array<double, 6> m_phases{};
  Eigen::Vector3d m_origin, m_x, m_y;
};

}  // namespace longarm::tests
