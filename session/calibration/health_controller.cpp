#include "session/calibration/health_controller.h"

#include <cmath>
#include <filesystem>

#include <Eigen/Geometry>

#include "core/clock.h"

namespace longarm::session {

using calibration::CameraHealth;
using calibration::HealthLevel;
using calibration::MissSample;

namespace {

constexpr double kStep = 1e-4;             // of numeric derivatives, in sigmas' natural units
constexpr double kLandmark_px = 1.5;       // a corner clicked by hand on a robot whose joints are a little off

struct Sight {
  Eigen::Vector3d from, along;
};

std::optional<Sight> sightOf(const vision::View& view, const Eigen::Vector2d& pixel) {
  const auto ray = view.camera.rayOfPixel(pixel);
  if (!ray) return std::nullopt;
  return Sight{view.X_WC.translation(), view.X_WC.linear() * *ray};
}

struct Passing {
  double miss_m = 0, range_a = 0, range_b = 0;
};

std::optional<Passing> passing(const Sight& a, const Sight& b) {
  const Eigen::Vector3d normal = a.along.cross(b.along), between = b.from - a.from;
  const double n2 = normal.squaredNorm();
  if (n2 < 1e-8) return std::nullopt;
  Passing out;
  out.miss_m = between.dot(normal) / std::sqrt(n2);
  out.range_a = between.cross(b.along).dot(normal) / n2;
  out.range_b = between.cross(a.along).dot(normal) / n2;
  return out.range_a > 0 && out.range_b > 0 ? std::optional<Passing>(out) : std::nullopt;
}

// What a view's stated mount uncertainty adds to the miss [m^2], by small turns and shifts.
double mountVariance(const vision::View& view, const Sight& sight, const Sight& other, double miss, bool first) {
  if (view.pose_covariance.isZero(0)) return 0;
  Vector6d gradient;
  for (int i = 0; i < 6; ++i) {
    Sight moved = sight;
    if (i < 3) moved.along = expSO3(kStep * Eigen::Vector3d::Unit(i)) * sight.along;
    else moved.from += kStep * Eigen::Vector3d::Unit(i - 3);
    const auto at = first ? passing(moved, other) : passing(other, moved);
    gradient[i] = at ? (at->miss_m - miss) / kStep : 0;
  }
  return gradient.dot(view.pose_covariance * gradient);
}

}  // namespace

std::optional<MissSample> missOf(const vision::View& a, const Eigen::Vector2d& pixel_a, const vision::View& b, const Eigen::Vector2d& pixel_b) {
  const auto sight_a = sightOf(a, pixel_a), sight_b = sightOf(b, pixel_b);
  const auto at = sight_a && sight_b ? passing(*sight_a, *sight_b) : std::nullopt;
  if (!at) return std::nullopt;
  const double metres_a = at->range_a / a.camera.fx, metres_b = at->range_b / b.camera.fx;   // per pixel there
  const double per_pixel = std::min(metres_a, metres_b);
  double variance = std::pow(a.sigma_px * metres_a, 2) + std::pow(b.sigma_px * metres_b, 2);
  variance += mountVariance(a, *sight_a, *sight_b, at->miss_m, true) + mountVariance(b, *sight_b, *sight_a, at->miss_m, false);
  return MissSample{a.name, b.name, at->miss_m / per_pixel, std::sqrt(variance) / per_pixel};
}

HealthController::HealthController(Document& document, CalibrationController& calibration, PoseController& pose, QObject* parent)
    : QObject(parent), m_document(document), m_calibration(calibration), m_pose(pose) {
  m_observer = m_document.observe([this](const Change& change) {
    if (change.kind != ChangeKind::kPlanChanged && change.kind != ChangeKind::kSelectionChanged && change.kind != ChangeKind::kPaneChanged) judge();
  });
  connect(&m_pose, &PoseController::changed, this, &HealthController::judge);
}

HealthController::~HealthController() { m_document.unobserve(m_observer); }

bool HealthController::counts(const vision::Snapshot& snapshot) const {
  if (snapshot.source != "live") return false;
  const auto record = m_calibration.recordInUse(snapshot.view.name);
  return !record || snapshot.wall_time_s >= record->wall_time_s;
}

void HealthController::addMisses(const SketchItem& item, std::vector<MissSample>* out) const {
  if (item.pipe || item.edge) return;      // its picks are other places in every picture
  for (int vertex = 0; vertex < vision::vertexCount(item.kind); ++vertex) {
    std::vector<std::pair<SnapshotPtr, Eigen::Vector2d>> seen;
    for (const auto& [id, picks] : item.picks) {
      const auto* pick = item.pick(id, vertex);
      const auto snapshot = m_document.snapshot(id);
      const bool free = pick != nullptr && (pick->state == PickState::kFree || pick->state == PickState::kReleased);
      if (free && snapshot && counts(*snapshot)) seen.emplace_back(snapshot, pick->pixel);
    }
    for (std::size_t i = 0; i < seen.size(); ++i) {
      for (std::size_t j = i + 1; j < seen.size(); ++j) {
        if (seen[i].first->view.name == seen[j].first->view.name) continue;
        const auto miss = missOf(seen[i].first->view, seen[i].second, seen[j].first->view, seen[j].second);
        if (miss) out->push_back(*miss);
      }
    }
  }
}

void HealthController::judge() {
  std::vector<MissSample> misses;
  for (const auto& item : m_document.items()) addMisses(item, &misses);
  std::vector<calibration::LandmarkSample> landmarks;
  if (m_pose.unknown() == PoseController::Unknown::kExt) {
    for (const auto& offset : m_pose.offsetsInUse()) landmarks.push_back({m_pose.camera(), offset, kLandmark_px});
  }
  auto now = calibration::healthOf(misses, landmarks);
  bool same = now.size() == m_cameras.size();
  for (const auto& [camera, health] : now) {
    const auto before = m_cameras.find(camera);
    same = same && before != m_cameras.end() && before->second.level == health.level && before->second.why == health.why &&
           before->second.samples == health.samples;
  }
  m_cameras = std::move(now);
  if (!same) Q_EMIT changed();
}

CameraHealth HealthController::of(const std::string& camera) const {
  const auto found = m_cameras.find(camera);
  return found == m_cameras.end() ? CameraHealth{} : found->second;
}

HealthLevel HealthController::level() const {
  HealthLevel worst = HealthLevel::kUnknown;
  for (const auto& [camera, health] : m_cameras) worst = std::max(worst, health.level);
  return worst;
}

QString HealthController::worstCamera() const {
  QString name;
  HealthLevel worst = HealthLevel::kGood;
  for (const auto& [camera, health] : m_cameras) {
    if (health.level <= worst) continue;
    worst = health.level;
    name = QString::fromStdString(camera);
  }
  return name;
}

double HealthController::ageDays(const std::string& camera) const {
  double since_s = -1;
  if (const auto record = m_calibration.recordInUse(camera)) {
    since_s = wallTime_s() - record->wall_time_s;
  } else if (m_document.workcell() && m_document.workcell()->camera(camera) != nullptr) {
    std::error_code error;
    const auto written = std::filesystem::last_write_time(m_document.workcell()->camera(camera)->calibration, error);
    if (!error) since_s = std::chrono::duration<double>(std::filesystem::file_time_type::clock::now() - written).count();
  }
  return since_s < 0 ? -1 : since_s / 86400;
}

QString HealthController::whyNotTrust(FeatureId feature) const {
  const auto* item = m_document.item(feature);
  if (item == nullptr) return {};
  for (const auto& [id, picks] : item->picks) {
    const auto snapshot = m_document.snapshot(id);
    if (snapshot && counts(*snapshot) && of(snapshot->view.name).level == HealthLevel::kKnocked) return QString::fromStdString(of(snapshot->view.name).why);
  }
  return {};
}

}  // namespace longarm::session
