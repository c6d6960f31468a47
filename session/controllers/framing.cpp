#include "session/controllers/framing.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "session/controllers/calibrated_camera.h"

namespace longarm::session {
namespace {

constexpr int kRounds = 5;
constexpr double kBehind = 10;

Eigen::Vector2d middleOf(const vision::CameraModel& camera) { return {(camera.width - 1) / 2.0, (camera.height - 1) / 2.0}; }

/// A camera whose pan, tilt and zoom are tried out.
struct Trial {
  const planning::CameraSpec& spec;
  const vision::CameraCalibration& calibration;
  const AimedCamera& aimed;

  Result<vision::View> view(const PanTiltAngles& angles, std::optional<double> zoom) const {
    const auto file = calibration.at(zoom);
    if (!file) return file.error();
    vision::View out;
    out.name = spec.name;
    out.camera = file->camera;
    out.X_WC = aimed.pose(angles);
    if (file->pose && (calibration.hasTable() || file->pose->parent == spec.link)) out.X_WC = out.X_WC * file->pose->pose;
    return out;
  }
};

// A place in the middle of the outline of points that are seen, as far away as they are; else their mean.
Eigen::Vector3d middleOfOutline(const vision::View& view, const std::vector<Eigen::Vector3d>& points_W) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::AlignedBox2d outline;
  double depth = 0;
  for (const auto& p_W : points_W) {
    mean += p_W / static_cast<double>(points_W.size());
    const Eigen::Vector3d p = view.X_WC.inverse() * p_W;
    if (p.z() < 1e-3) return mean;
    outline.extend(Eigen::Vector2d(p.x() / p.z(), p.y() / p.z()));
    depth += p.z() / static_cast<double>(points_W.size());
  }
  const Eigen::Vector2d n = outline.center();
  return view.X_WC * Eigen::Vector3d(depth * n.x(), depth * n.y(), depth);
}

Result<PanTiltAngles> aim(const Trial& trial, const std::vector<Eigen::Vector3d>& points_W, std::optional<double> zoom) {
  PanTiltAngles angles = trial.aimed.now();
  Eigen::Vector3d target = Eigen::Vector3d::Zero();
  for (const auto& p : points_W) target += p / static_cast<double>(points_W.size());
  for (int round = 0; round < kRounds; ++round) {
    const auto view = trial.view(angles, zoom);
    if (!view) return view.error();
    if (round > 0) target = middleOfOutline(*view, points_W);
    const auto centre = view->camera.normalisedOfPixel(middleOf(view->camera));
    if (!centre) return centre.error();
    const auto next = trial.aimed.lookingAt(target, *centre);
    if (!next) return next.error();
    angles = *next;
  }
  return angles;
}

double spreadAt(const Trial& trial, const PanTiltAngles& angles, double zoom, const std::vector<Eigen::Vector3d>& points_W) {
  const auto view = trial.view(angles, zoom);
  return view ? spread(*view, points_W) : kBehind;
}

// As far in as the points fit.
double zoomFor(const Trial& trial, const PanTiltAngles& angles, const std::vector<Eigen::Vector3d>& points_W, double fill) {
  auto [wide, narrow] = trial.calibration.range();
  if (spreadAt(trial, angles, wide, points_W) > fill) return wide;
  if (spreadAt(trial, angles, narrow, points_W) <= fill) return narrow;
  for (int i = 0; i < 30; ++i) {
    const double middle = (wide + narrow) / 2;
    (spreadAt(trial, angles, middle, points_W) <= fill ? wide : narrow) = middle;
  }
  return wide;
}

std::string shortfallOf(const Trial& trial, const Framing& framing, const Status& limits,
                        const std::vector<Eigen::Vector3d>& points_W, const FramingWish& wish) {
  if (!limits) return limits.error().message + " It goes as far as it can.";
  const auto view = trial.view(framing.angles, framing.zoom);
  if (!view) return view.error().message;
  const double part = spread(*view, points_W);
  const std::string camera = trial.spec.name;
  if (part > 1) {
    return "That does not fit in the picture of " + camera +
           (framing.zoom ? ", not even zoomed out. Drive back, or choose less." : ", whose zoom is fixed. Drive back, or choose less.");
  }
  if (framing.zoom && wish.may_zoom && points_W.size() > 1 && part < wish.fill / 2) {
    return camera + " is zoomed in as far as it is calibrated; that takes up " + formatFixed(100 * part, 0) + " % of its picture.";
  }
  return {};
}

}  // namespace

double spread(const vision::View& view, const std::vector<Eigen::Vector3d>& points_W) {
  const Eigen::Vector2d middle = middleOf(view.camera);
  double largest = 0;
  for (const auto& p : points_W) {
    const auto pixel = view.project(p);
    if (!pixel) return kBehind;
    const Eigen::Vector2d part = (*pixel - middle).cwiseAbs().cwiseQuotient(middle);
    largest = std::max(largest, part.maxCoeff());
  }
  return largest;
}

Result<Framing> frame(const planning::Workcell& workcell, const planning::CameraSpec& camera,
                      const std::vector<Eigen::Vector3d>& points_W, const JointState& now, std::optional<double> zoom_now,
                      const FramingWish& wish) {
  if (points_W.empty()) return Error{ErrorCode::kInvalidInput, "There is nothing to look at."};
  const auto aimed = AimedCamera::make(workcell, camera, now);
  if (!aimed) return aimed.error();
  const auto calibration = calibrationOf(camera);
  if (!calibration) return calibration.error();
  const Trial trial{camera, **calibration, *aimed};
  const auto [wide, narrow] = (*calibration)->range();
  const bool zooms = zoom_now && wish.may_zoom && narrow > wide;
  auto angles = aim(trial, points_W, zooms ? std::clamp(*zoom_now, wide, narrow) : zoom_now);
  if (!angles) return angles.error();
  Framing out{aimed->clamped(*angles), zoom_now, {}};
  if (zooms) {
    // The lens' middle wanders with the zoom: aim again through the lens as it will be.
    out.zoom = zoomFor(trial, out.angles, points_W, wish.fill);
    angles = aim(trial, points_W, out.zoom);
    if (!angles) return angles.error();
    out.angles = aimed->clamped(*angles);
    out.zoom = zoomFor(trial, out.angles, points_W, wish.fill);
  }
  out.shortfall = shortfallOf(trial, out, aimed->checkLimits(*angles), points_W, wish);
  return out;
}

Result<std::vector<Eigen::Vector3d>> regionAt(const vision::View& view, const Eigen::Vector2d& corner,
                                              const Eigen::Vector2d& opposite, double distance_m) {
  std::vector<Eigen::Vector3d> out;
  for (const double u : {0.0, 0.5, 1.0}) {
    for (const double v : {0.0, 0.5, 1.0}) {
      const Eigen::Vector2d pixel = corner + Eigen::Vector2d(u, v).cwiseProduct(opposite - corner);
      const auto ray = view.camera.rayOfPixel(pixel);
      if (!ray) return ray.error();
      out.push_back(view.X_WC * Eigen::Vector3d(distance_m * *ray));
    }
  }
  return out;
}

}  // namespace longarm::session
