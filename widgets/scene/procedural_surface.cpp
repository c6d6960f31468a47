#include "widgets/scene/procedural_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>

#include <opencv2/imgproc.hpp>

namespace longarm::scene::internal {
namespace {

constexpr int kSize = 512;

/// A number in 0 ... 1 from a lattice point: the same on every machine.
double hash(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  std::uint32_t h = x * 374761393u + y * 668265263u + seed * 2246822519u;
  h = (h ^ (h >> 13)) * 1274126177u;
  return static_cast<double>((h ^ (h >> 16)) & 0xffffffu) / 0xffffff;
}

double smooth(double t) { return t * t * (3 - 2 * t); }

/// Value noise that repeats every `cells_x`, `cells_y` cells; x, y in 0 ... 1 of the tile.
double valueNoise(double x, double y, int cells_x, int cells_y, std::uint32_t seed) {
  const double px = x * cells_x, py = y * cells_y;
  const int ix = static_cast<int>(std::floor(px)), iy = static_cast<int>(std::floor(py));
  const double fx = smooth(px - ix), fy = smooth(py - iy);
  const auto at = [&](int dx, int dy) {
    return hash(static_cast<std::uint32_t>((ix + dx) % cells_x), static_cast<std::uint32_t>((iy + dy) % cells_y), seed);
  };
  const double top = at(0, 0) * (1 - fx) + at(1, 0) * fx, bottom = at(0, 1) * (1 - fx) + at(1, 1) * fx;
  return top * (1 - fy) + bottom * fy;
}

/// Octaves of value noise, 0 ... 1.
double fractal(double x, double y, int cells_x, int cells_y, std::uint32_t seed) {
  double sum = 0, weight = 0.5, total = 0;
  for (int octave = 0; octave < 4; ++octave) {
    sum += weight * valueNoise(x, y, cells_x << octave, cells_y << octave, seed + static_cast<std::uint32_t>(octave));
    total += weight;
    weight /= 2;
  }
  return sum / total;
}

using Shader = std::function<cv::Vec3d(double x, double y)>;  // BGR, 0 ... 255

cv::Mat shade(const Shader& shader) {
  cv::Mat picture(kSize, kSize, CV_8UC3);
  for (int row = 0; row < kSize; ++row) {
    for (int column = 0; column < kSize; ++column) {
      const cv::Vec3d color = shader((column + 0.5) / kSize, (row + 0.5) / kSize);
      picture.at<cv::Vec3b>(row, column) = cv::Vec3b(cv::saturate_cast<uchar>(color[0]),
                                                     cv::saturate_cast<uchar>(color[1]),
                                                     cv::saturate_cast<uchar>(color[2]));
    }
  }
  return picture;
}

cv::Vec3d grey(double level) { return {level, level, level}; }

cv::Vec3d wood(double x, double y) {
  const double board = std::floor(y * 4);
  const double warp = 0.12 * fractal(x, y, 3, 8, 7);
  const double grain = fractal(x, y + warp, 3, 48, 11 + static_cast<std::uint32_t>(board));
  const double seam = std::abs(y * 4 - std::round(y * 4)) < 0.02 ? 0.55 : 1;
  return seam * (0.62 + 0.38 * grain + 0.08 * hash(static_cast<std::uint32_t>(board), 3, 5)) * cv::Vec3d(170, 208, 240);
}

cv::Vec3d concrete(double x, double y) {
  const double patches = fractal(x, y, 4, 4, 21), grain = fractal(x, y, 64, 64, 22);
  const bool joint = x < 0.006 || y < 0.006;
  const bool stone = valueNoise(x, y, 90, 90, 23) > 0.9;
  return grey((joint ? 110 : 150 + 60 * patches + 45 * (grain - 0.5)) - (stone ? 45 : 0));
}

cv::Vec3d metal(double x, double y) {
  return grey(185 + 45 * (fractal(x, y, 2, 96, 31) - 0.5) + 30 * (fractal(x, y, 5, 5, 32) - 0.5));
}

cv::Vec3d checker(double x, double y) {
  const bool dark = (static_cast<int>(x * 4) + static_cast<int>(y * 4)) % 2 == 0;
  return grey((dark ? 70 : 225) + 20 * (fractal(x, y, 16, 16, 41) - 0.5));
}

cv::Vec3d carton(double x, double y) {
  const double fibre = fractal(x, y, 40, 6, 51), blotch = fractal(x, y, 6, 6, 52);
  return (0.78 + 0.18 * fibre + 0.14 * (blotch - 0.5)) * cv::Vec3d(190, 222, 245);
}

cv::Vec3d noise(double x, double y) { return grey(120 + 130 * fractal(x, y, 12, 12, 61)); }

// 10 x 7 squares with a white rim of one square: 40 pixels each, so that edges lie between pixels.
cv::Vec3d chessboard(double x, double y) {
  constexpr int kSquare = 40;
  // A face's texture begins at the bottom of the picture.
  const int column = static_cast<int>(x * kSize) / kSquare - 1, row = static_cast<int>((1 - y) * kSize) / kSquare - 1;
  const bool inside = column >= 0 && column < 10 && row >= 0 && row < 7;
  return grey(inside && (column + row) % 2 == 0 ? 25 : 235);
}

// 8 x 8 dots: dark discs in the middles of squares of 40 mm, 12 mm across, with soft edges.
cv::Vec3d dots(double x, double y) {
  constexpr int kCount = 8;
  constexpr double kRadius = 0.15, kEdge = 0.75 * kCount / kSize;     // in squares
  const double across = x * kCount - std::floor(x * kCount) - 0.5, up = y * kCount - std::floor(y * kCount) - 0.5;
  const double outside = std::clamp((std::hypot(across, up) - kRadius) / kEdge + 0.5, 0.0, 1.0);
  return grey(25 + 210 * outside);
}

struct Recipe {
  cv::Vec3d (*shader)(double, double);
  double tile_m;
};

}  // namespace

Surface makeSurface(const std::string& name) {
  static const std::map<std::string, Recipe> kRecipes = {
      {"wood", {wood, 0.6}},       {"concrete", {concrete, 1.5}}, {"metal", {metal, 0.25}},
      {"checker", {checker, 0.4}}, {"carton", {carton, 0.3}},     {"noise", {noise, 0.25}},
      {"chessboard", {chessboard, 0.03 * kSize / 40}}, {"dots", {dots, 8 * 0.04}}};
  const auto found = kRecipes.find(name);
  if (found == kRecipes.end()) return {};
  return {shade(found->second.shader), found->second.tile_m};
}

}  // namespace longarm::scene::internal
