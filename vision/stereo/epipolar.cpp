#include "vision/stereo/epipolar.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.h"
#include "vision/camera/lens.h"
#include "vision/stereo/epipolar_kernel.h"

namespace longarm::vision {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNearest = 0.05;        // z in the second camera [m]
constexpr int kProbes = 257;             // first look for what can be seen; about 5 px apart on a stereo head
constexpr int kMaxDepth = 10;            // of the subdivision
constexpr std::size_t kMaxPoints = 4096;

internal::LoopCamera loopCamera(const CameraModel& c) {
  return {c.fx, c.fy, c.skew, c.cx, c.cy, c.distortion[0], c.distortion[1], c.distortion[2], c.distortion[3],
          c.distortion[4]};
}

// The ray of the first view's pixel as the second camera sees it: p = (a + w t) / w at inverse depth w.
class Ray {
 public:
  Ray(const View& from, const Vector2d& n, const View& to) : m_camera(to.camera) {
    const Eigen::Matrix3d R_CW = to.X_WC.linear().transpose();
    m_a = R_CW * (from.X_WC.linear() * Vector3d(n.x(), n.y(), 1));
    m_t = R_CW * (from.X_WC.translation() - to.X_WC.translation());
    m_max_radius2 = internal::monotoneRadius2(to.camera);
  }

  const Vector3d& a() const { return m_a; }
  const Vector3d& t() const { return m_t; }
  double maxRadius2() const { return m_max_radius2; }

  bool isInRange(double w) const {
    const Vector3d p = m_a + w * m_t;
    return p.z() > kNearest * w && p.head<2>().squaredNorm() <= m_max_radius2 * p.z() * p.z();
  }

  bool sees(double w, Vector2d* pixel) const {
    const Vector3d p = m_a + w * m_t;
    if (!(p.z() > kNearest * w)) return false;
    const Vector2d n = p.head<2>() / p.z();
    if (!(n.squaredNorm() <= m_max_radius2)) return false;
    *pixel = m_camera.pixelOfNormalised(n);
    return m_camera.containsPixel(*pixel);
  }

 private:
  const CameraModel& m_camera;
  Vector3d m_a, m_t;
  double m_max_radius2 = 0;
};

// Probes first ... last see the curve; their neighbours do not.
struct Run {
  int first = -1, last = -1;
};

std::vector<Run> visibleRuns(const std::array<bool, kProbes>& seen) {
  std::vector<Run> runs;
  for (int i = 0; i < kProbes; ++i) {
    if (!seen[static_cast<std::size_t>(i)]) continue;
    if (runs.empty() || runs.back().last != i - 1) runs.push_back({i, i});
    runs.back().last = i;
  }
  return runs;
}

// Moves from a seen inverse depth towards a hidden one as far as the pixel can be seen.
double edgeOfSight(const Ray& ray, double seen, double hidden) {
  Vector2d pixel;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (seen + hidden);
    (ray.sees(middle, &pixel) ? seen : hidden) = middle;
  }
  return seen;
}

struct Node {
  double w;
  Vector2d pixel;
};

// Appends what lies between two nodes and the second one.  The middle of the arc must meet the middle of the
// chord: that bounds the sag and also makes inverse depth linear along the chord.
void subdivide(const Ray& ray, const Node& a, const Node& b, double tolerance, int depth, std::vector<Node>* nodes) {
  Node middle{0.5 * (a.w + b.w), Vector2d::Zero()};
  const bool split = depth < kMaxDepth && nodes->size() < kMaxPoints && ray.sees(middle.w, &middle.pixel) &&
                     (middle.pixel - 0.5 * (a.pixel + b.pixel)).squaredNorm() > tolerance * tolerance;
  if (split) {
    subdivide(ray, a, middle, tolerance, depth + 1, nodes);
    subdivide(ray, middle, b, tolerance, depth + 1, nodes);
  } else {
    nodes->push_back(b);
  }
}

// A first look along the ray, at inverse depths uniform from near to far.
struct Probes {
  Probes(const Ray& ray, double near_inverse, double far_inverse) : near_w(near_inverse), far_w(far_inverse) {
    for (int i = 0; i < kProbes; ++i) {
      const auto k = static_cast<std::size_t>(i);
      seen[k] = ray.sees(at(i), &pixels[k]);
    }
  }
  double at(int i) const { return near_w + (far_w - near_w) * i / (kProbes - 1); }

  double near_w, far_w;
  std::array<Vector2d, kProbes> pixels;
  std::array<bool, kProbes> seen{};
};

// One visible piece, from the last point in sight at its near end to the last one at its far end.
std::vector<Node> nodesOf(const Ray& ray, const Probes& probes, const Run& run, double max_sag_px) {
  const double w0 = run.first == 0 ? probes.near_w : edgeOfSight(ray, probes.at(run.first), probes.at(run.first - 1));
  const double w1 =
      run.last == kProbes - 1 ? probes.far_w : edgeOfSight(ray, probes.at(run.last), probes.at(run.last + 1));
  std::vector<Node> corners{{w0, Vector2d::Zero()}};
  const double kept = 1e-12 * probes.near_w;
  for (int i = run.first; i <= run.last; i += 8) {
    const double w = probes.at(i);
    if (w < w0 - kept && w > w1 + kept) corners.push_back({w, probes.pixels[static_cast<std::size_t>(i)]});
  }
  corners.push_back({w1, Vector2d::Zero()});
  ray.sees(w0, &corners.front().pixel);
  ray.sees(w1, &corners.back().pixel);
  std::vector<Node> nodes{corners.front()};
  for (std::size_t i = 1; i < corners.size(); ++i) subdivide(ray, corners[i - 1], corners[i], max_sag_px, 0, &nodes);
  return nodes;
}

std::vector<EpipolarPoint> ticksBetween(const Ray& ray, double near_m, double far_m) {
  std::vector<EpipolarPoint> ticks;
  for (int decade = -3; decade <= 4; ++decade) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double depth = digit * std::pow(10.0, decade);
      EpipolarPoint tick{{}, depth, false};
      if (depth >= near_m && depth <= far_m && ray.sees(1 / depth, &tick.pixel)) ticks.push_back(tick);
    }
  }
  return ticks;
}

Status checkInput(const View& from, const View& to, const EpipolarOptions& options) {
  if (from.parent != to.parent) {
    return {ErrorCode::kInvalidInput, "view \"" + from.name + "\" is placed in \"" + from.parent + "\" and view \"" +
                                          to.name + "\" in \"" + to.parent + "\"; views must share one parent frame"};
  }
  if (!(options.min_depth > 0 && options.min_depth < options.max_depth && std::isfinite(options.max_depth))) {
    return {ErrorCode::kInvalidInput, "depth range " + formatNumber(options.min_depth) + " to " +
                                          formatNumber(options.max_depth) + " m; expected 0 < min < max"};
  }
  if (!(options.max_sag_px > 0)) {
    return {ErrorCode::kInvalidInput, "max_sag_px is " + formatNumber(options.max_sag_px) + "; expected above 0"};
  }
  return {};
}

}  // namespace

std::optional<EpipolarPoint> EpipolarCurve::nearest(const Vector2d& pixel) const {
  if (points.empty()) return std::nullopt;
  EpipolarPoint best = points.front();
  double best_distance2 = (pixel - best.pixel).squaredNorm();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const EpipolarPoint& a = points[i - 1];
    const EpipolarPoint& b = points[i];
    const Vector2d chord = b.pixel - a.pixel;
    const double length2 = chord.squaredNorm();
    const double along = length2 > 0 ? std::clamp((pixel - a.pixel).dot(chord) / length2, 0.0, 1.0) : 0;
    const double s = b.begins_piece ? 1 : along;
    const Vector2d foot = a.pixel + s * chord;
    const double distance2 = (pixel - foot).squaredNorm();
    if (distance2 >= best_distance2) continue;
    best_distance2 = distance2;
    best = {foot, 1 / ((1 - s) / a.depth + s / b.depth), false};
  }
  return best;
}

bool sampleEpipolarCurve(const View& from, const Vector2d& pixel, const View& to, double near_m, double far_m, int n,
                         double* u, double* v, bool* visible) {
  Vector2d start;
  internal::Distorted at;
  if (!internal::undistortPixel(from.camera, internal::monotoneRadius2(from.camera), pixel, &start, &at)) return false;
  const Ray ray(from, start, to);
  const internal::LoopCamera camera = loopCamera(to.camera);
  internal::LoopRay samples{{ray.a().x(), ray.a().y(), ray.a().z()}, {ray.t().x(), ray.t().y(), ray.t().z()}, 1 / near_m, 0};
  samples.step = (1 / far_m - samples.first) / (n - 1);
  // Depth is linear along the ray and the radius convex along its straight ideal image: when both ends are in
  // range, so is all between them.
  if (ray.isInRange(1 / near_m) && ray.isInRange(1 / far_m)) {
    internal::projectSamples(camera, samples, n, u, v);
    std::fill(visible, visible + n, true);
    return true;
  }
  constexpr int kBlock = 128;
  double z[kBlock], r2[kBlock];
  for (int done = 0; done < n; done += kBlock) {
    const int count = std::min(kBlock, n - done);
    internal::LoopRay block = samples;
    block.first += samples.step * done;
    internal::projectSamplesWithRange(camera, block, count, u + done, v + done, z, r2);
    for (int i = 0; i < count; ++i) {
      visible[done + i] = (z[i] > kNearest * (block.first + samples.step * i)) & (r2[i] <= ray.maxRadius2());
    }
  }
  return true;
}

Result<EpipolarCurve> epipolarCurve(const View& from, const Vector2d& pixel, const View& to,
                                    const EpipolarOptions& options) {
  if (auto status = checkInput(from, to, options); !status) return status.error();
  const auto start = from.camera.normalisedOfPixel(pixel);
  if (!start) return Error{ErrorCode::kInvalidInput, "view \"" + from.name + "\": " + start.error().message};
  const Ray ray(from, *start, to);
  const Probes probes(ray, 1 / options.min_depth, 1 / options.max_depth);
  EpipolarCurve curve;
  for (const Run& run : visibleRuns(probes.seen)) {
    bool begins = !curve.points.empty();
    for (const Node& node : nodesOf(ray, probes, run, options.max_sag_px)) {
      curve.points.push_back({node.pixel, 1 / node.w, begins});
      begins = false;
    }
  }
  if (!curve.points.empty()) {
    curve.ticks = ticksBetween(ray, curve.points.front().depth, curve.points.back().depth);
  }
  return curve;
}

}  // namespace longarm::vision
