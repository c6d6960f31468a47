#include "vision/match/plane_warp.h"

#include <cmath>

#include <Eigen/Dense>

namespace longarm::vision::internal {
namespace {

constexpr double kReach = 8;   // [px] half the size of the neighbourhood that the derivative is taken over

}  // namespace

double LocalWarp::magnification() const { return 1 / std::sqrt(std::max(1e-12, std::abs(from_by_to.determinant()))); }

PlaneWarp::PlaneWarp(const View& from, const Eigen::Vector2d& pixel, const View& to)
    : m_from(from), m_to(to), m_pixel(pixel) {
  const Eigen::Vector2d n = from.camera.normalisedOfPixel(pixel).value();
  m_ray = from.X_WC.linear() * Eigen::Vector3d(n.x(), n.y(), 1);
  const Eigen::Vector3d between = from.X_WC.linear().col(2) + to.X_WC.linear().col(2);
  m_normal = between.norm() > 0.2 ? Eigen::Vector3d(between.normalized()) : Eigen::Vector3d(from.X_WC.linear().col(2));
}

std::optional<Eigen::Vector2d> PlaneWarp::fromPixel(const Eigen::Vector2d& to_pixel, const Eigen::Vector3d& through) const {
  const auto ray = m_to.camera.rayOfPixel(to_pixel);
  if (!ray) return std::nullopt;
  const Eigen::Vector3d direction = m_to.X_WC.linear() * *ray, centre = m_to.X_WC.translation();
  const double along = m_normal.dot(through - centre) / m_normal.dot(direction);
  if (!(along > 0 && along < 1e9)) return std::nullopt;
  const auto pixel = m_from.project(centre + along * direction);
  if (!pixel) return std::nullopt;
  return *pixel;
}

std::optional<LocalWarp> PlaneWarp::at(double depth) const {
  LocalWarp warp;
  warp.from = m_pixel;
  const Eigen::Vector3d through = m_from.X_WC.translation() + depth * m_ray;
  const auto to = m_to.project(through);
  if (!to) return std::nullopt;
  warp.to = *to;
  for (int i = 0; i < 2; ++i) {
    const auto after = fromPixel(*to + kReach * Eigen::Vector2d::Unit(i), through);
    const auto before = fromPixel(*to - kReach * Eigen::Vector2d::Unit(i), through);
    if (!after || !before) return std::nullopt;
    warp.from_by_to.col(i) = (*after - *before) / (2 * kReach);
  }
  return warp;
}

}  // namespace longarm::vision::internal
