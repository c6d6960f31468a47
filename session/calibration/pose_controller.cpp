#include "session/calibration/pose_controller.h"

#include <algorithm>
#include <cmath>


namespace longarm::session {

using calibration::LoopUnknown;
using vision::OverlayRole;
using vision::OverlayShape;

namespace {

constexpr double kSameZoom = 1e-3;
constexpr double kArrow = 10, kChord_px = 30;
constexpr double kSamePlace_m = 0.001;
constexpr std::size_t kLeast = 3;
constexpr calibration::KinPrior kRobot{0.05 * 3.14159265358979323846 / 180, 0.0005};

void add(vision::Overlay* overlay, OverlayShape::Kind kind, OverlayRole role, std::vector<Eigen::Vector2d> points, std::string text = {}) {
  overlay->shapes.push_back({kind, role, std::move(points), std::move(text)});
}

// An edge as the lens bends it; empty unless all of it is before the camera and some of it in the picture.
std::vector<Eigen::Vector2d> drawn(const vision::View& view, const KnownGeometry::Segment& edge) {
  const auto a = view.project(edge.first), b = view.project(edge.second);
  if (!a || !b || (!view.camera.containsPixel(*a) && !view.camera.containsPixel(*b))) return {};
  const int parts = std::clamp(static_cast<int>((*b - *a).norm() / kChord_px), 1, 12);
  std::vector<Eigen::Vector2d> line;
  for (int i = 0; i <= parts; ++i) {
    const auto at = view.project(edge.first + (edge.second - edge.first) * i / parts);
    if (!at) return {};
    line.push_back(*at);
  }
  return line;
}

}  // namespace

PoseController::PoseController(Document& document, CalibrationController& calibration, JobRunner& jobs, QObject* parent)
    : QObject(parent), m_document(document), m_calibration(calibration), m_jobs(jobs) {
  m_observer = m_document.observe([this](const Change& change) { documentChanged(change); });
  refreshGeometry();
  restart();
}

PoseController::~PoseController() { m_document.unobserve(m_observer); }

void PoseController::documentChanged(const Change& change) {
  switch (change.kind) {
    case ChangeKind::kSnapshotAdded:
      if (const auto snapshot = m_document.snapshot(SnapshotId{change.id}); snapshot && snapshot->view.name == m_camera) m_snapshot = snapshot->id;
      Q_EMIT snapshotsChanged();
      restart();
      break;
    case ChangeKind::kSnapshotRemoved:
    case ChangeKind::kReset:
      m_picks.erase(std::remove_if(m_picks.begin(), m_picks.end(), [this](const LandmarkPick& p) { return !m_document.snapshot(p.snapshot); }), m_picks.end());
      Q_EMIT snapshotsChanged();
      restart();
      break;
    case ChangeKind::kWorkcellChanged: refreshMount(); refreshGeometry(); restart(); break;
    case ChangeKind::kWorldChanged: refreshGeometry(); break;
    case ChangeKind::kItemAdded:
    case ChangeKind::kItemChanged:
    case ChangeKind::kItemRemoved: refreshLandmarks(); break;
    default: break;
  }
}

const planning::CameraSpec* PoseController::spec() const {
  return m_document.workcell() ? m_document.workcell()->camera(m_camera) : nullptr;
}

const planning::WorldObject* PoseController::objectSpec() const {
  if (!m_document.workcell()) return nullptr;
  for (const auto& object : m_document.workcell()->objects) {
    if (object.name == m_object) return &object;
  }
  return nullptr;
}

void PoseController::setCamera(const QString& camera) {
  if (camera.toStdString() == m_camera) return;
  m_camera = camera.toStdString();
  m_snapshot = {};
  if (const auto all = snapshots(); !all.empty()) m_snapshot = all.back()->id;
  refreshMount();
  m_picks.clear();
  refreshLandmarks();
  Q_EMIT snapshotsChanged();
  restart();
}

void PoseController::setUnknown(Unknown unknown) {
  if (unknown == m_unknown) return;
  m_unknown = unknown;
  m_picks.clear();
  m_guess.setZero();
  refreshLandmarks();
  restart();
}

void PoseController::setCameraToo(bool too) {
  if (too == m_camera_too) return;
  m_camera_too = too;
  restart();
}

void PoseController::setObject(const QString& object) {
  if (object.toStdString() == m_object) return;
  m_object = object.toStdString();
  if (m_unknown != Unknown::kObj) return;
  m_picks.clear();
  m_guess.setZero();
  refreshLandmarks();
  restart();
}

bool PoseController::hangsOnPanTilt(const std::string& link) const {
  const auto& workcell = *m_document.workcell();
  const auto* camera = spec();
  if (camera == nullptr || link.empty()) return false;
  const auto& model = *workcell.model;
  std::string pan_joint;
  for (const auto& unit : workcell.pan_tilts) {
    if (unit.name == camera->pan_tilt) pan_joint = unit.pan_joint;
  }
  auto at = model.linkIndex(link);
  for (int index = at ? *at : -1; index >= 0;) {
    const int joint = model.links()[static_cast<std::size_t>(index)].parent_joint;
    if (joint < 0) return false;
    if (model.joints()[static_cast<std::size_t>(joint)].name == pan_joint) return true;
    index = model.joints()[static_cast<std::size_t>(joint)].parent_link;
  }
  return false;
}

Pose PoseController::mountAt(const vision::Snapshot* snapshot) const {
  return m_calibration.mountInUse(m_camera, snapshot != nullptr ? snapshot->view.zoom : std::nullopt);
}

void PoseController::refreshMount() { m_X_LC = mountAt(snapshot().get()); }

bool PoseController::severalZooms() const {
  const auto first = m_picks.empty() ? nullptr : m_document.snapshot(m_picks.front().snapshot);
  return std::any_of(m_picks.begin(), m_picks.end(), [&](const LandmarkPick& pick) {
    const auto from = m_document.snapshot(pick.snapshot);
    return from && first && std::abs(from->view.zoom.value_or(0) - first->view.zoom.value_or(0)) > kSameZoom;
  });
}

void PoseController::refreshGeometry() {
  m_geometry = KnownGeometry(m_document.workcell(), m_document.world());
  refreshLandmarks();
}

// An object is found by its own corners; everything else by what does not move with the camera.
bool PoseController::serves(const std::string& thing, const std::string& link) const {
  if (spec() == nullptr) return false;
  if (m_unknown == Unknown::kObj) return objectSpec() != nullptr && thing == m_object;
  return link != spec()->link && !hangsOnPanTilt(link);
}

void PoseController::refreshLandmarks() {
  const std::string chosen = m_landmark >= 0 && m_landmark < static_cast<int>(m_landmarks.size()) ? m_landmarks[static_cast<std::size_t>(m_landmark)].name : std::string();
  m_landmarks.clear();
  const auto& workcell = m_document.workcell();
  if (workcell && workcell->model && spec() != nullptr) {
    auto all = landmarksOf(*workcell, m_document);
    all.insert(all.end(), m_stuck.begin(), m_stuck.end());
    for (auto& mark : all) {
      if (serves(mark.thing, mark.link)) m_landmarks.push_back(std::move(mark));
    }
  }
  m_landmark = -1;
  for (std::size_t i = 0; i < m_landmarks.size(); ++i) {
    if (m_landmarks[i].name == chosen) m_landmark = static_cast<int>(i);
  }
  if (m_landmark < 0) advise();
  Q_EMIT landmarksChanged();
}

void PoseController::setLandmark(int index) {
  m_landmark = index >= 0 && index < static_cast<int>(m_landmarks.size()) ? index : -1;
  Q_EMIT changed();
}

Eigen::VectorXd PoseController::configurationNow() const {
  const auto shown = snapshot();
  return shown ? configuration(*shown) : m_document.workcell()->model->neutral();
}

Status PoseController::stick(const Eigen::Vector3d& from, const Eigen::Vector3d& along, double snap_rad) {
  const auto& workcell = m_document.workcell();
  if (!workcell || !workcell->model || spec() == nullptr) return {ErrorCode::kNotFound, m_why.toStdString()};
  const auto found = m_geometry.pointOn(from, along, snap_rad, configurationNow(), [this](const auto& thing, const auto& link) { return serves(thing, link); });
  if (!found) {
    return {ErrorCode::kNotFound, m_unknown == Unknown::kObj ? "There is nothing of object " + m_object + " there: its own surface is what finds it."
                                                             : "There is no known surface there, or it moves with the camera."};
  }
  for (std::size_t i = 0; i < m_landmarks.size(); ++i) {
    const auto& known = m_landmarks[i];
    if (known.thing != found->landmark.thing || known.link != found->landmark.link) continue;
    if ((known.X_LO * known.xyz - found->landmark.X_LO * found->landmark.xyz).norm() > kSamePlace_m) continue;
    setLandmark(static_cast<int>(i));
    return {};
  }
  Landmark mark = found->landmark;
  const std::string stem = mark.thing + " " + toString(found->kind) + " point ";
  const auto count = std::count_if(m_stuck.begin(), m_stuck.end(), [&](const Landmark& each) { return each.name.rfind(stem, 0) == 0; });
  mark.name = stem + std::to_string(count + 1);
  m_stuck.push_back(mark);
  refreshLandmarks();
  setLandmark(static_cast<int>(m_landmarks.size()) - 1);
  return {};
}

Status PoseController::stickAtPixel(const Eigen::Vector2d& pixel, double radius_px) {
  if (const int near = landmarkNear(pixel, radius_px); near >= 0) {
    setLandmark(near);
    return {};
  }
  const auto view = viewNow();
  const auto ray = view ? view->camera.rayOfPixel(pixel) : Result<Eigen::Vector3d>(ErrorCode::kNotFound, "There is no picture.");
  if (!ray) return ray.error();
  return stick(view->X_WC.translation(), (view->X_WC.linear() * *ray).normalized(), radius_px / view->camera.fx);
}

std::vector<SnapshotPtr> PoseController::snapshots() const {
  std::vector<SnapshotPtr> out;
  for (const auto& snapshot : m_document.snapshots()) {
    if (snapshot->view.name == m_camera && !snapshot->robot_state.names.empty()) out.push_back(snapshot);
  }
  return out;
}

void PoseController::setSnapshot(SnapshotId id) {
  m_snapshot = id;
  refreshMount();
  Q_EMIT changed();
}

SnapshotPtr PoseController::snapshot() const { return m_document.snapshot(m_snapshot); }

Eigen::VectorXd PoseController::configuration(const vision::Snapshot& snapshot) const {
  const auto& model = *m_document.workcell()->model;
  Eigen::VectorXd q = model.neutral();
  model.assign(snapshot.robot_state, q);
  return q;
}

// Where the unknown stands with the calibration in use; T_obj as its inverse.
Pose PoseController::inUse() const {
  if (m_unknown == Unknown::kExt) return m_X_LC.inverse();
  if (m_unknown == Unknown::kObj) return objectSpec() != nullptr ? objectSpec()->X_WO : Pose::Identity();
  return Pose::Identity();   // T_dev: a correction of the foot, in the root
}

Pose PoseController::extNow(const Pose& in_use) const { return cameraToo() && m_outcome ? m_outcome->result.T[0] : in_use; }

Pose PoseController::inUseAt(const vision::Snapshot& snapshot) const {
  return m_unknown == Unknown::kExt ? mountAt(&snapshot).inverse() : inUse();
}

std::optional<calibration::LoopView> PoseController::loopView(const vision::Snapshot& snapshot) const {
  return loopViewAt(configuration(snapshot), std::to_string(snapshot.id.value), mountAt(&snapshot).inverse());
}

std::optional<calibration::LoopView> PoseController::loopViewAt(const Eigen::VectorXd& q, const std::string& name, const Pose& T_ext) const {
  const auto& model = *m_document.workcell()->model;
  const auto link = model.linkIndex(spec()->link);
  if (!link) return std::nullopt;
  const Pose X_WL = model.forward(q, *link);
  calibration::LoopView view;
  view.name = name;
  view.T_ext = T_ext;
  view.T_kin = X_WL.inverse();
  if (m_unknown == Unknown::kObj && objectSpec() != nullptr) {
    view.T_obj = objectSpec()->X_WO.inverse();
    if (!objectSpec()->attached_link.empty()) {
      const auto carrier = model.linkIndex(objectSpec()->attached_link);
      if (!carrier) return std::nullopt;
      view.T_dev = model.forward(q, *carrier);
    }
  }
  return view;
}

std::optional<Eigen::Vector3d> PoseController::loopPoint(const Landmark& landmark, const vision::Snapshot& snapshot) const {
  if (m_unknown == Unknown::kObj) return landmark.xyz;
  const auto in_root = landmark.inRoot(*m_document.workcell()->model, configuration(snapshot));
  return in_root ? std::optional<Eigen::Vector3d>(*in_root) : std::nullopt;
}

std::optional<calibration::PoseObservation> PoseController::observation(const Landmark& landmark, const vision::Snapshot& snapshot) const {
  return observationAt(landmark, configuration(snapshot), extNow(m_X_LC.inverse()));
}

std::optional<calibration::PoseObservation> PoseController::observationAt(const Landmark& landmark, const Eigen::VectorXd& q, const Pose& T_ext) const {
  auto view = loopViewAt(q, {}, T_ext);
  const auto point = m_unknown == Unknown::kObj ? Result<Eigen::Vector3d>(landmark.xyz) : landmark.inRoot(*m_document.workcell()->model, q);
  if (!view || !point) return std::nullopt;
  view->points.push_back({*point, {0, 0}, 0});
  calibration::LoopProblem problem;
  problem.views = {*view};
  return calibration::observationsOf(problem, m_unknown).front();
}

std::optional<Eigen::Vector2d> PoseController::projected(const Landmark& landmark, const vision::Snapshot& snapshot, const Pose& unknown) const {
  const auto o = observation(landmark, snapshot);
  if (!o) return std::nullopt;
  const auto pixel = snapshot.view.camera.project(o->A * unknown * o->y);
  return pixel ? std::optional<Eigen::Vector2d>(*pixel) : std::nullopt;
}

std::optional<Eigen::Vector2d> PoseController::projectedInUse(const Landmark& landmark, const vision::Snapshot& snapshot) const {
  const auto o = observationAt(landmark, configuration(snapshot), m_X_LC.inverse());
  if (!o) return std::nullopt;
  const auto pixel = snapshot.view.camera.project(o->A * inUseAt(snapshot) * o->y);
  return pixel ? std::optional<Eigen::Vector2d>(*pixel) : std::nullopt;
}

void PoseController::pick(const Eigen::Vector2d& pixel) {
  const auto shown = snapshot();
  if (!shown || m_landmark < 0) return;
  const Landmark& landmark = m_landmarks[static_cast<std::size_t>(m_landmark)];
  const auto same = std::find_if(m_picks.begin(), m_picks.end(), [&](const LandmarkPick& p) { return p.snapshot == m_snapshot && p.landmark.name == landmark.name; });
  if (same != m_picks.end()) same->pixel = pixel;
  else m_picks.push_back({landmark, m_snapshot, pixel});
  restart();
  advise();
}

void PoseController::remove(std::size_t pick) {
  if (pick >= m_picks.size()) return;
  m_picks.erase(m_picks.begin() + static_cast<std::ptrdiff_t>(pick));
  restart();
}

void PoseController::clear() {
  m_picks.clear();
  m_stuck.clear();
  refreshLandmarks();
  m_guess.setZero();
  restart();
}

void PoseController::setGuess(const Vector6d& increment) {
  m_guess = increment;
  restart();
}

Pose PoseController::estimate() const {
  if (m_outcome) {
    if (m_unknown == Unknown::kExt) return m_outcome->result.T[0];
    return m_unknown == Unknown::kDev ? m_outcome->result.T[1] : Pose(m_outcome->result.T[2].inverse());
  }
  const Pose at = inUse();
  // A camera turns about itself: its guess is an increment of the camera in its link.
  if (m_unknown == Unknown::kExt) return Pose(at.inverse() * calibration::moved(Pose::Identity(), m_guess)).inverse();
  return calibration::moved(at, m_guess);
}

std::optional<vision::View> PoseController::viewNow() const {
  const auto shown = snapshot();
  if (!shown || spec() == nullptr) return std::nullopt;
  vision::View view = shown->view;
  const auto loop = loopView(*shown);
  if (!loop) return view;
  const Pose T_ext = m_unknown == Unknown::kExt ? estimate() : extNow(loop->T_ext);
  const Pose T_dev = m_unknown == Unknown::kDev ? estimate() : Pose::Identity();
  view.X_WC = (T_ext * loop->T_kin * T_dev).inverse();
  return view;
}

int PoseController::landmarkNear(const Eigen::Vector2d& pixel, double radius_px) const {
  const auto shown = snapshot();
  if (!shown) return -1;
  int best = -1;
  double nearest = radius_px;
  const Pose now = estimate();
  for (std::size_t i = 0; i < m_landmarks.size(); ++i) {
    const auto at = projected(m_landmarks[i], *shown, now);
    if (!at || (*at - pixel).norm() > nearest) continue;
    nearest = (*at - pixel).norm();
    best = static_cast<int>(i);
  }
  return best;
}

std::vector<Eigen::Vector2d> PoseController::offsetsInUse() const {
  std::vector<Eigen::Vector2d> out;
  const auto record = m_calibration.recordInUse(m_camera);
  for (const auto& pick : m_picks) {
    const auto from = m_document.snapshot(pick.snapshot);
    if (!from || (record && from->wall_time_s < record->wall_time_s)) continue;
    const auto at = projectedInUse(pick.landmark, *from);
    if (at) out.push_back(pick.pixel - *at);
  }
  return out;
}

std::optional<double> PoseController::missInUse() const {
  double sum = 0;
  int count = 0;
  for (const auto& pick : m_picks) {
    const auto from = m_document.snapshot(pick.snapshot);
    const auto at = from ? projectedInUse(pick.landmark, *from) : std::nullopt;
    if (!at) continue;
    sum += (pick.pixel - *at).squaredNorm() / 2;
    ++count;
  }
  return count > 0 ? std::optional<double>(std::sqrt(sum / count)) : std::nullopt;
}

vision::Overlay PoseController::overlay() const {
  vision::Overlay overlay;
  const auto shown = snapshot();
  const auto view = viewNow();
  if (!shown || !view) return overlay;
  const Pose now = estimate();
  KnownGeometry geometry = m_geometry;
  if (m_unknown == Unknown::kObj) geometry.place(m_object, now);
  for (const auto& edge : geometry.edges(configuration(*shown), [this](const auto& thing, const auto& link) { return serves(thing, link); })) {
    const auto line = drawn(*view, edge);
    if (!line.empty()) add(&overlay, OverlayShape::Kind::kPolyline, OverlayRole::kEllipse, line);
  }
  for (std::size_t i = 0; i < m_landmarks.size(); ++i) {
    const auto at = projected(m_landmarks[i], *shown, now);
    if (!at || !shown->view.camera.containsPixel(*at)) continue;
    const bool chosen = static_cast<int>(i) == m_landmark;
    add(&overlay, OverlayShape::Kind::kMarker, chosen ? OverlayRole::kActiveHandle : OverlayRole::kDepthTick, {*at});
    if (chosen) add(&overlay, OverlayShape::Kind::kText, OverlayRole::kLabel, {*at + Eigen::Vector2d(9, -6)}, m_landmarks[i].name);
  }
  for (const auto& pick : m_picks) {
    if (pick.snapshot != m_snapshot) continue;
    add(&overlay, OverlayShape::Kind::kMarker, OverlayRole::kHandle, {pick.pixel});
    const auto at = projected(pick.landmark, *shown, now);
    if (at && m_outcome) add(&overlay, OverlayShape::Kind::kPolyline, OverlayRole::kMiss, {pick.pixel, pick.pixel + kArrow * (pick.pixel - *at)});
    else if (at) add(&overlay, OverlayShape::Kind::kPolyline, OverlayRole::kUnplaced, {*at, pick.pixel});
  }
  return overlay;
}

void PoseController::restart() {
  m_outcome.reset();
  m_chosen.reset();
  m_next_picture.clear();
  m_stale = m_picks.size() >= kLeast && !severalZooms();
  if (severalZooms()) m_why = tr("The pictures were taken at different zooms: click in pictures of one setting, and remove the others' points.");
  else if (spec() == nullptr) m_why = tr("There is no camera to calibrate: the workcell has none, or none is chosen.");
  else if (m_unknown == Unknown::kObj && objectSpec() == nullptr) m_why = tr("Choose the object whose place is unknown; it must stand in the workcell file.");
  else if (m_unknown == Unknown::kDev && spec()->pan_tilt.empty()) m_why = tr("Camera %1 hangs on no pan-tilt: its mount is T_ext.").arg(QString::fromStdString(m_camera));
  else if (snapshots().empty()) m_why = tr("Take a picture with camera %1 first.").arg(QString::fromStdString(m_camera));
  else m_why = tr("%1 of at least 3 points are clicked: choose a landmark, then click it in the picture. Five or more, well spread, are good.").arg(m_picks.size());
  solve();
  Q_EMIT changed();
}

void PoseController::takeAlternative() {
  const Pose other = m_outcome->result.alternatives.front().T;
  restart();
  m_chosen = other;
  m_stale = true;
  solve();
  Q_EMIT changed();
}

void PoseController::solve() {
  if (m_solving || !m_stale || spec() == nullptr) return;
  m_stale = false;
  const auto newest = m_document.snapshot(m_picks.front().snapshot);
  if (!newest) return;
  calibration::LoopProblem problem;
  problem.camera = newest->view.camera;
  std::vector<std::size_t> order;
  for (const auto& from : snapshots()) {
    auto view = loopView(*from);
    if (!view) continue;
    for (std::size_t i = 0; i < m_picks.size(); ++i) {
      const auto point = m_picks[i].snapshot == from->id ? loopPoint(m_picks[i].landmark, *from) : std::nullopt;
      if (!point) continue;
      view->points.push_back({*point, m_picks[i].pixel, m_picks[i].landmark.sigma_m});
      order.push_back(i);
    }
    if (!view->points.empty()) problem.views.push_back(*view);
  }
  calibration::LoopOptions options;
  options.unknowns = {m_unknown};
  const Pose start = estimate();
  options.starts[m_unknown == Unknown::kExt ? 0 : m_unknown == Unknown::kDev ? 1 : 2] = m_unknown == Unknown::kObj ? Pose(start.inverse()) : start;
  options.chosen = m_chosen;
  if (cameraToo()) {
    options.unknowns.push_back(Unknown::kExt);
    options.starts[0] = m_X_LC.inverse();
    // Between pictures the robot moved, and what it says of that is not exact.
    options.kin_prior = kRobot;
    options.sigma_px = kClick_px;
  }
  m_solving = true;
  m_jobs.run<PoseOutcome>(
      this,
      [problem, options, order]() -> Result<PoseOutcome> {
        auto result = calibration::solveLoop(problem, options);
        if (!result) return result.error();
        return PoseOutcome{std::move(*result), order};
      },
      [this](Result<PoseOutcome> outcome) {
        m_solving = false;
        if (m_stale) return solve();
        if (m_picks.size() >= kLeast) {
          if (outcome) m_outcome = std::move(*outcome);
          m_why = outcome ? QString() : QString::fromStdString(outcome.error().message);
        }
        advisePicture();
        Q_EMIT changed();
      });
}

}  // namespace longarm::session
