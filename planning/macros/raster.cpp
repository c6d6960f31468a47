#include "planning/macros/raster.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace longarm::planning {
namespace {

constexpr double kAcceleration = 0.25;   // of the tool when it runs in and out [m/s^2]
constexpr double kSmoothing = 0.12;      // of acceleration, with some reserve [s]
constexpr int kMostPasses = 200;
constexpr int kCells = 120;              // of the coverage grid, along each edge
constexpr double kSample = 0.01;         // [s]

// The patch seen along the passes: travel and step are its edges in the wanted order and sense.
struct Frame {
  Eigen::Vector3d origin, travel, step;
  double length, width;

  Frame(const PlanePatch& patch, const RasterSpec& spec)
      : origin(patch.corner),
        travel(spec.along_v ? patch.v : patch.u),
        step(spec.along_v ? patch.u : patch.v),
        length(spec.along_v ? patch.height : patch.width),
        width(spec.along_v ? patch.width : patch.height) {
    if (spec.mirror_travel) {
      origin += length * travel;
      travel = -travel;
    }
    if (spec.mirror_step) {
      origin += width * step;
      step = -step;
    }
  }
};

int passesOf(double width, const RasterSpec& spec) {
  if (width <= spec.swath) return 1;
  return static_cast<int>(std::ceil((width - spec.swath) / (spec.swath * (1 - spec.overlap)) - 1e-9)) + 1;
}

double acrossOf(int pass, int passes, double width, double swath) {
  if (passes == 1) return 0.5 * width;
  return 0.5 * swath + pass * (width - swath) / (passes - 1);
}

}  // namespace

Result<Raster> rasterOf(const PlanePatch& patch, const RasterSpec& spec) {
  const Frame frame(patch, spec);
  Raster out;
  out.passes = passesOf(frame.width, spec);
  if (out.passes > kMostPasses || spec.first_pass >= out.passes) {
    return Error{ErrorCode::kOutOfLimits, "the scan has " + std::to_string(out.passes) + " passes, of which it should begin with number " +
                                              std::to_string(spec.first_pass) + "; there are 1 to " + std::to_string(kMostPasses)};
  }
  out.spacing = out.passes > 1 ? (frame.width - spec.swath) / (out.passes - 1) : 0;
  const double lead = spec.run_out ? spec.speed * spec.speed / (2 * kAcceleration) + kSmoothing * spec.speed : -0.5 * out.spacing;
  if (frame.length + 2 * lead <= 0) {
    return Error{ErrorCode::kOutOfLimits, "passes " + formatFixed(1e3 * out.spacing, 0) + " mm apart cannot turn within " + formatFixed(1e3 * frame.length, 0) + " mm"};
  }
  const Eigen::Vector3d z = -std::cos(spec.tilt) * patch.normal + std::sin(spec.tilt) * frame.travel;
  const Eigen::Matrix3d R = toolRotation(z, frame.travel);
  const auto over = [&](double along, int pass) {
    const double across = acrossOf(pass, out.passes, frame.width, spec.swath);
    return Eigen::Vector3d(frame.origin + along * frame.travel + across * frame.step - spec.stand_off * z);
  };
  for (int pass = spec.first_pass; pass < out.passes; ++pass) {
    const bool back = pass % 2 == 1;
    const double from = back ? frame.length + lead : -lead, to = back ? -lead : frame.length + lead;
    if (pass == spec.first_pass) out.path = ToolPath(poseAt(over(from, pass), R));
    out.path.lineTo(over(to, pass));
    if (pass + 1 == out.passes) break;
    const Eigen::Vector3d d = (back ? -1 : 1) * frame.travel;
    const Eigen::Vector3d center = out.path.end().translation() + 0.5 * out.spacing * frame.step;
    out.path.arc(center, d.cross(frame.step), M_PI, false);
  }
  return out;
}

ScanFigures scanFigures(const ArmSpace& space, const Plan& plan, double from_s, double to_s, const PlanePatch& patch,
                        const RasterSpec& spec) {
  const Frame frame(patch, spec);
  ScanFigures out;
  out.slowest = 1e9;
  std::vector<char> covered(static_cast<std::size_t>(kCells * kCells), 0);
  const auto cellOf = [](double value, double length) { return static_cast<int>(std::floor(value / length * kCells)); };
  const int samples = std::max(1, static_cast<int>(std::ceil((to_s - from_s) / kSample)));
  double last_along = 0;
  for (int i = 0; i <= samples && !space.cancelled(); ++i) {
    const TrajectoryPoint point = plan.trajectory.sample(from_s + (to_s - from_s) * i / samples);
    const Pose X = space.tip(point.positions);
    const Eigen::Vector3d z = X.linear().col(2);
    const double depth = patch.normal.dot(X.translation() - patch.corner) / -patch.normal.dot(z);
    const Eigen::Vector3d foot = X.translation() + depth * z - frame.origin;
    const double along = foot.dot(frame.travel), across = foot.dot(frame.step);
    const double before = i == 0 ? along : last_along;
    last_along = along;
    if (along < 0 || along > frame.length) continue;
    const double speed = space.toolWay(point.positions, point.velocities);
    out.slowest = std::min(out.slowest, speed);
    out.fastest = std::max(out.fastest, speed);
    // Cells whose middles the line across the tool has passed since the last sample.
    const int a0 = std::max(0, cellOf(std::min(before, along), frame.length)), a1 = std::min(kCells - 1, cellOf(std::max(before, along), frame.length));
    for (int a = a0; a <= a1; ++a) {
      for (int c = 0; c < kCells; ++c) {
        const double middle = (c + 0.5) / kCells * frame.width;
        if (std::abs(middle - across) <= 0.5 * spec.swath + 1e-4) covered[static_cast<std::size_t>(a * kCells + c)] = 1;
      }
    }
  }
  if (out.fastest == 0) out.slowest = 0;
  out.coverage = static_cast<double>(std::count(covered.begin(), covered.end(), 1)) / (kCells * kCells);
  return out;
}

}  // namespace longarm::planning
