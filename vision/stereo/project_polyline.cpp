#include "vision/stereo/project_polyline.h"

#include <cmath>

namespace longarm::vision {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Pieces = std::vector<std::vector<Vector2d>>;

constexpr int kMaxDepth = 12;
constexpr std::size_t kMaxPoints = 200000;

class Projector {
 public:
  Projector(const View& view, const ProjectionOptions& options)
      : m_camera(view.camera), m_options(options), m_max_radius(0.999 * view.camera.monotoneRadius()) {}

  // Adds the segment a-b (camera frame): first cut at the near plane, then bent as the lens bends it.
  void addSegment(Vector3d a, Vector3d b) {
    const double near_m = m_options.near_m;
    if (a.z() < near_m && b.z() < near_m) return breakPiece();
    if (a.z() < near_m) {
      breakPiece();
      a += (b - a) * ((near_m - a.z()) / (b.z() - a.z()));
    }
    const bool leaves = b.z() < near_m;
    if (leaves) b = a + (b - a) * ((near_m - a.z()) / (b.z() - a.z()));
    const double depth_a = a.z();
    if (depth_a <= 0) return breakPiece();
    subdivide(sample(a), sample(b), 0);
    if (leaves) breakPiece();
  }

  Pieces take() {
    breakPiece();
    return std::move(m_pieces);
  }

 private:
  struct Sample {
    Vector3d p;
    Vector2d pixel;
    bool seen;
  };

  Sample sample(const Vector3d& p) const {
    const Vector2d n = p.head<2>() / p.z();
    if (!(n.norm() <= m_max_radius)) return {p, Vector2d::Zero(), false};
    const Vector2d pixel = m_camera.pixelOfNormalised(n);
    return {p, pixel, m_camera.containsPixel(pixel, m_options.margin_px)};
  }

  // The point of the segment that a picture shows half way: linear in x/z, y/z, not in space.
  static Vector3d middleInPicture(const Vector3d& a, const Vector3d& b) {
    const double s = a.z() / (a.z() + b.z());
    return a + s * (b - a);
  }

  void subdivide(const Sample& a, const Sample& b, int depth) {
    const Sample middle = sample(middleInPicture(a.p, b.p));
    const Vector2d chord = b.pixel - a.pixel;
    const double length = chord.norm();
    bool split = depth < 3;   // a hidden middle between hidden ends may still hide a visible part
    if (a.seen && b.seen && middle.seen) {
      const Vector2d off = middle.pixel - a.pixel;
      const double sag = length > 1e-9 ? std::abs(off.x() * chord.y() - off.y() * chord.x()) / length : off.norm();
      split = sag > m_options.max_sag_px || length > 64;
    } else if (a.seen || b.seen || middle.seen) {
      split = true;
    }
    if (split && depth < kMaxDepth && m_count < kMaxPoints) {
      subdivide(a, middle, depth + 1);
      subdivide(middle, b, depth + 1);
      return;
    }
    if (!a.seen || !b.seen) return breakPiece();
    if (m_piece.empty()) m_piece.push_back(a.pixel);
    m_piece.push_back(b.pixel);
    ++m_count;
  }

  void breakPiece() {
    if (m_piece.size() >= 2) m_pieces.push_back(std::move(m_piece));
    m_piece.clear();
  }

  const CameraModel& m_camera;
  ProjectionOptions m_options;
  double m_max_radius;
  std::vector<Vector2d> m_piece;
  Pieces m_pieces;
  std::size_t m_count = 0;
};

}  // namespace

Pieces projectPolyline(const View& view, const std::vector<Vector3d>& points_W, const ProjectionOptions& options) {
  Projector projector(view, options);
  const Eigen::Matrix3d R_CW = view.X_WC.linear().transpose();
  const auto inCamera = [&](const Vector3d& p) -> Vector3d { return R_CW * (p - view.X_WC.translation()); };
  for (std::size_t i = 1; i < points_W.size(); ++i) {
    if (!points_W[i - 1].allFinite() || !points_W[i].allFinite()) continue;
    projector.addSegment(inCamera(points_W[i - 1]), inCamera(points_W[i]));
  }
  return projector.take();
}

}  // namespace longarm::vision
