#include "session/tools/baseline_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "core/text.h"

namespace longarm::session {

using Eigen::Vector3d;

namespace {

// Where an arm works.  Nearly parallel axes meet far beyond it, and say nothing of what will be marked.
constexpr double kNearest_m = 0.3, kFarthest_m = 3, kUsual_m = 1.5;
constexpr double kDegree = M_PI / 180;
constexpr double kRefused = 0.3 * kDegree, kPoor = 1.0 * kDegree;   // as triangulation refuses and warns
constexpr double kLittle = 0.15;             // of the picture

// Depth in a at which the optical axes come nearest to each other.
double depthOfMeeting(const vision::View& a, const vision::View& b) {
  const Vector3d u = a.X_WC.linear().col(2), v = b.X_WC.linear().col(2), w = b.X_WC.translation() - a.X_WC.translation();
  const double uv = u.dot(v), sine2 = 1 - uv * uv;
  if (sine2 < 1e-6) return kUsual_m;
  const double depth = (w.dot(u) - uv * w.dot(v)) / sine2;
  return depth >= kNearest_m && depth <= kFarthest_m ? depth : kUsual_m;
}

double overlapAt(const vision::View& a, const vision::View& b, double depth) {
  constexpr int kGrid = 9;
  int seen = 0;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const Eigen::Vector2d pixel((i % kGrid + 0.5) / kGrid * a.camera.width, (i / kGrid + 0.5) / kGrid * a.camera.height);
    const auto n = a.camera.normalisedOfPixel(pixel);
    if (!n) continue;
    const auto there = b.project(a.X_WC * Vector3d(depth * n->x(), depth * n->y(), depth));
    if (there && b.camera.containsPixel(*there)) ++seen;
  }
  return static_cast<double>(seen) / (kGrid * kGrid);
}

}  // namespace

Baseline baselineOf(const vision::View& a, const vision::View& b) {
  Baseline out;
  out.distance_m = (b.X_WC.translation() - a.X_WC.translation()).norm();
  out.depth_m = depthOfMeeting(a, b);
  const Vector3d p = a.X_WC * Vector3d(0, 0, out.depth_m);
  const Vector3d to_a = p - a.X_WC.translation(), to_b = p - b.X_WC.translation();
  out.parallax = std::atan2(to_a.cross(to_b).norm(), to_a.dot(to_b));
  // sigma_Z = Z^2 sigma_px sqrt(2) / (f b), with b across the line of sight: Z times the parallax.
  const double focal = (a.camera.fx + b.camera.fx) / 2, sigma = std::hypot(a.sigma_px, b.sigma_px);
  out.depth_sigma_m = out.parallax > 0 ? out.depth_m * sigma / (focal * out.parallax) : std::numeric_limits<double>::infinity();
  for (const double depth : {0.5, 1.0, 2.0, 4.0, out.depth_m}) out.overlap = std::max(out.overlap, overlapAt(a, b, depth));
  return out;
}

std::string baselineWarning(const vision::View& a, const vision::View& b) {
  if (a.parent != b.parent) {
    return a.name + " is placed in frame " + a.parent + ", " + b.name + " in " + b.parent +
           ": they cannot be measured together. Show two pictures of one frame.";
  }
  const Baseline found = baselineOf(a, b);
  const std::string apart = formatFixed(found.distance_m * 1000, 0) + " mm apart";
  const std::string angle = formatFixed(found.parallax / kDegree, 2) + " degrees at " + formatFixed(found.depth_m, 1) + " m";
  if (found.overlap < kLittle) {
    return a.name + " and " + b.name + " hardly show the same place: " + formatFixed(100 * found.overlap, 0) +
           " % of one is seen in the other. Turn the cameras to the same spot and take another picture.";
  }
  if (found.parallax < kRefused) {
    return a.name + " and " + b.name + " were taken from nearly the same place (" + apart + ", lines of sight differ by " + angle +
           "): nothing can be measured with them. Move a camera sideways and take another picture.";
  }
  if (found.parallax < kPoor) {
    return "Poor baseline: " + a.name + " and " + b.name + " were taken " + apart + ", lines of sight differ by " + angle +
           ", so that depth is known to \u00b1 " + formatFixed(1960 * found.depth_sigma_m, 0) +
           " mm only. Take one from further to the side, or from nearer.";
  }
  return {};
}

}  // namespace longarm::session
