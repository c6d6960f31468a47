#include "planning/robot/link_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "planning/world/shape_triangles.h"

namespace longarm::planning {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kNear_m = 0.02;
constexpr int kSides = 24;                 // of a cylinder: within 1 % of round
constexpr int kFiner = 2;                  // pinhole samples along a cell
constexpr int kKnot = 4;                   // cells between rays that are computed; the others are interpolated
constexpr int kMostSamples = 2048;         // along an edge of the pinhole raster
constexpr float kNothing = std::numeric_limits<float>::infinity();

/// A pinhole picture in normalised coordinates; z-buffered.
class Raster {
 public:
  Raster(const Vector2d& low, const Vector2d& high, double step)
      : m_low(low), m_step(step), m_width(samples(high.x() - low.x())), m_height(samples(high.y() - low.y())),
        m_links(static_cast<std::size_t>(m_width) * m_height, -1), m_inverse(m_links.size(), 0) {}

  /// Corners in the camera's frame, all beyond the near plane.
  void draw(const std::array<Vector3d, 3>& corners, int link, bool cull) {
    std::array<Vector2d, 3> p;
    std::array<double, 3> w;
    for (std::size_t i = 0; i < 3; ++i) {
      w[i] = 1 / corners[i].z();
      p[i] = (corners[i].head<2>() * w[i] - m_low) / m_step;
    }
    const double area = cross(p[1] - p[0], p[2] - p[0]);
    // v grows downwards: what is counter-clockwise from outside is clockwise here, and so negative, when seen from the front.
    if (area == 0 || (cull && area > 0)) return;
    const auto [u0, u1] = range(std::min({p[0].x(), p[1].x(), p[2].x()}), std::max({p[0].x(), p[1].x(), p[2].x()}), m_width);
    const auto [v0, v1] = range(std::min({p[0].y(), p[1].y(), p[2].y()}), std::max({p[0].y(), p[1].y(), p[2].y()}), m_height);
    for (int v = v0; v <= v1; ++v) {
      for (int u = u0; u <= u1; ++u) {
        const Vector2d at(u, v);
        const double a = cross(p[2] - p[1], at - p[1]) / area, b = cross(p[0] - p[2], at - p[2]) / area, c = 1 - a - b;
        if (a < 0 || b < 0 || c < 0) continue;
        const std::size_t cell = static_cast<std::size_t>(v) * m_width + u;
        const auto inverse = static_cast<float>(a * w[0] + b * w[1] + c * w[2]);   // linear in the picture
        if (inverse <= m_inverse[cell]) continue;
        m_inverse[cell] = inverse;
        m_links[cell] = static_cast<std::int16_t>(link);
      }
    }
  }
  /// Link and depth along a ray.
  std::pair<std::int16_t, float> at(const Vector2d& n) const {
    const int u = static_cast<int>(std::lround((n.x() - m_low.x()) / m_step)), v = static_cast<int>(std::lround((n.y() - m_low.y()) / m_step));
    if (u < 0 || v < 0 || u >= m_width || v >= m_height) return {-1, kNothing};
    const std::size_t cell = static_cast<std::size_t>(v) * m_width + u;
    return m_links[cell] < 0 ? std::pair<std::int16_t, float>{-1, kNothing}
                             : std::pair<std::int16_t, float>{m_links[cell], 1 / m_inverse[cell]};
  }

 private:
  static double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }
  int samples(double extent) const { return std::clamp(static_cast<int>(std::ceil(extent / m_step)) + 1, 1, kMostSamples); }
  static std::pair<int, int> range(double low, double high, int count) {
    return {static_cast<int>(std::ceil(std::clamp(low, 0.0, static_cast<double>(count)))),
            static_cast<int>(std::floor(std::clamp(high, -1.0, count - 1.0)))};
  }

  Vector2d m_low;
  double m_step;
  int m_width, m_height;
  std::vector<std::int16_t> m_links;
  std::vector<float> m_inverse;            // 1 / z; 0: nothing
};

// The part of a triangle beyond the near plane, as a fan.
void drawClipped(Raster& raster, const std::array<Vector3d, 3>& corners, int link, bool cull) {
  std::array<Vector3d, 4> kept;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d &a = corners[i], &b = corners[(i + 1) % 3];
    if (a.z() >= kNear_m) kept[count++] = a;
    if ((a.z() >= kNear_m) != (b.z() >= kNear_m)) kept[count++] = a + (kNear_m - a.z()) / (b.z() - a.z()) * (b - a);
  }
  for (std::size_t i = 2; i < count; ++i) raster.draw({kept[0], kept[i - 1], kept[i]}, link, cull);
}

/// Normalised coordinates of the middles of cells; not finite where the lens shows nothing.
class CellRays {
 public:
  CellRays(const vision::CameraModel& camera, const LinkMask& mask)
      : m_columns((mask.columns - 1) / kKnot + 2), m_rows((mask.rows - 1) / kKnot + 2) {
    for (int row = 0; row < m_rows; ++row) {
      for (int column = 0; column < m_columns; ++column) {
        const Vector2d pixel = middle(mask, column * kKnot, row * kKnot);
        const auto n = camera.normalisedOfPixel(pixel);
        m_knots.push_back(n ? *n : Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()));
        if (!n) continue;
        low = low.cwiseMin(*n);
        high = high.cwiseMax(*n);
      }
    }
  }
  Vector2d at(int column, int row) const {
    const int i = column / kKnot, k = row / kKnot;
    const double s = static_cast<double>(column % kKnot) / kKnot, t = static_cast<double>(row % kKnot) / kKnot;
    return (1 - t) * ((1 - s) * knot(i, k) + s * knot(i + 1, k)) + t * ((1 - s) * knot(i, k + 1) + s * knot(i + 1, k + 1));
  }
  static Vector2d middle(const LinkMask& mask, int column, int row) {
    return Vector2d(column, row) * mask.cell_px + Vector2d::Constant((mask.cell_px - 1) / 2.0);
  }

  Vector2d low = Vector2d::Constant(1e9), high = Vector2d::Constant(-1e9);

 private:
  const Vector2d& knot(int column, int row) const { return m_knots[static_cast<std::size_t>(row) * m_columns + column]; }

  int m_columns, m_rows;
  std::vector<Vector2d> m_knots;
};

Status checkInput(const RobotModel& model, const Eigen::VectorXd& q, const vision::View& view, int cell_px) {
  const std::string& root = model.links()[static_cast<std::size_t>(model.rootLink())].name;
  if (view.parent != root) {
    return {ErrorCode::kInvalidInput, "view \"" + view.name + "\" is placed in \"" + view.parent + "\", the robot's links in \"" + root +
                                          "\": there the robot cannot be told from the rest"};
  }
  if (view.camera.width <= 0 || view.camera.height <= 0 || cell_px <= 0) {
    return {ErrorCode::kInvalidInput, "view \"" + view.name + "\" has no size: its camera file says no width and height"};
  }
  if (q.size() != model.dof()) {
    return {ErrorCode::kInvalidInput, "a configuration of " + std::to_string(q.size()) + " values for a robot of " +
                                          std::to_string(model.dof()) + " joints"};
  }
  return {};
}

}  // namespace

int LinkMask::cellAt(const Vector2d& pixel) const {
  if (!pixel.allFinite()) return -1;
  const int column = static_cast<int>(std::floor((pixel.x() + 0.5) / cell_px)), row = static_cast<int>(std::floor((pixel.y() + 0.5) / cell_px));
  return column < 0 || row < 0 || column >= columns || row >= rows ? -1 : row * columns + column;
}

int LinkMask::linkAt(const Vector2d& pixel) const {
  const int cell = cellAt(pixel);
  return cell < 0 ? -1 : links[static_cast<std::size_t>(cell)];
}

double LinkMask::depthAt(const Vector2d& pixel) const {
  const int cell = cellAt(pixel);
  return cell < 0 ? std::numeric_limits<double>::infinity() : depths[static_cast<std::size_t>(cell)];
}

double LinkMask::coveredAbout(const Vector2d& pixel, double radius_px, double depth) const {
  int seen = 0, covered = 0;
  const int steps = std::max(1, static_cast<int>(std::ceil(radius_px / cell_px)));
  for (int v = -steps; v <= steps; ++v) {
    for (int u = -steps; u <= steps; ++u) {
      const Vector2d off = Vector2d(u, v) * (radius_px / steps);
      const int cell = off.norm() <= radius_px ? cellAt(pixel + off) : -1;
      if (cell < 0) continue;
      ++seen;
      covered += depths[static_cast<std::size_t>(cell)] < depth ? 1 : 0;
    }
  }
  return seen == 0 ? 0 : static_cast<double>(covered) / seen;
}

LinkSilhouettes::LinkSilhouettes(std::shared_ptr<const RobotModel> model) : m_model(std::move(model)) {
  const auto& links = m_model->links();
  for (std::size_t link = 0; link < links.size(); ++link) {
    const auto& shapes = links[link].visuals.empty() ? links[link].collisions : links[link].visuals;
    for (const auto& each : shapes) {
      const bool closed = !std::holds_alternative<std::shared_ptr<const TriangleMesh>>(each.shape);
      m_parts.push_back({static_cast<int>(link), closed, trianglesOf(each.shape, kSides), each.X_LS});
    }
  }
}

Result<LinkMask> LinkSilhouettes::maskOf(const Eigen::VectorXd& q, const vision::View& view, int cell_px) const {
  if (Status fine = checkInput(*m_model, q, view, cell_px); !fine) return fine.error();
  LinkMask mask;
  mask.cell_px = cell_px;
  mask.columns = (view.camera.width + cell_px - 1) / cell_px;
  mask.rows = (view.camera.height + cell_px - 1) / cell_px;
  const CellRays rays(view.camera, mask);
  const double step = cell_px / (kFiner * std::max(view.camera.fx, view.camera.fy));
  Raster raster(rays.low, rays.high.cwiseMax(rays.low), step);
  std::vector<Pose> X_RL;
  m_model->forward(q, X_RL);
  const Pose X_CR = view.X_WC.inverse();
  std::vector<Vector3d> seen;
  for (const Part& part : m_parts) {
    const Pose X_CS = X_CR * X_RL[static_cast<std::size_t>(part.link)] * part.X_LS;
    seen.clear();
    for (const auto& vertex : part.mesh->vertices) seen.push_back(X_CS * vertex);
    for (const auto& t : part.mesh->triangles) {
      const std::array<Vector3d, 3> corners{seen[static_cast<std::size_t>(t[0])], seen[static_cast<std::size_t>(t[1])],
                                            seen[static_cast<std::size_t>(t[2])]};
      drawClipped(raster, corners, part.link, part.closed);
    }
  }
  for (int row = 0; row < mask.rows; ++row) {
    for (int column = 0; column < mask.columns; ++column) {
      const Vector2d n = rays.at(column, row);
      const auto [link, depth] = n.allFinite() ? raster.at(n) : std::pair<std::int16_t, float>{-1, kNothing};
      mask.links.push_back(link);
      mask.depths.push_back(depth);
    }
  }
  return mask;
}

}  // namespace longarm::planning
