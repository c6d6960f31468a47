#include "session/calibration/pose_controller.h"

#include <algorithm>
#include <cmath>

#include "calibration/pose/next_point.h"
#include "session/calibration/pose_text.h"

namespace longarm::session {

using calibration::LoopUnknown;
using vision::OverlayRole;
using vision::OverlayShape;

namespace {

constexpr double kClick_px = 0.7, kArrow = 10;
constexpr double kDegrees = 180 / 3.14159265358979323846;
constexpr std::size_t kLeast = 3;

void add(vision::Overlay* overlay, OverlayShape::Kind kind, OverlayRole role, std::vector<Eigen::Vector2d> points, std::string text = {}) {
  overlay->shapes.push_back({kind, role, std::move(points), std::move(text)});
}

}  // namespace

PoseController::PoseController(Document& document, CalibrationController& calibration, JobRunner& jobs, QObject* parent)
    : QObject(parent), m_document(document), m_calibration(calibration), m_jobs(jobs) {
  m_observer = m_document.observe([this](const Change& change) { documentChanged(change); });
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
    case ChangeKind::kWorkcellChanged: refreshLandmarks(); restart(); break;
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

void PoseController::refreshLandmarks() {
  const std::string chosen = m_landmark >= 0 && m_landmark < static_cast<int>(m_landmarks.size()) ? m_landmarks[static_cast<std::size_t>(m_landmark)].name : std::string();
  m_landmarks.clear();
  const auto& workcell = m_document.workcell();
  if (workcell && workcell->model && spec() != nullptr) {
    for (auto& mark : landmarksOf(*workcell, m_document)) {
      const bool of_object = m_unknown == Unknown::kObj;
      // An object is found by its own corners; everything else by what does not move with the camera.
      if (of_object ? mark.thing == m_object && objectSpec() != nullptr : mark.link != spec()->link && !hangsOnPanTilt(mark.link)) m_landmarks.push_back(std::move(mark));
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

std::vector<SnapshotPtr> PoseController::snapshots() const {
  std::vector<SnapshotPtr> out;
  for (const auto& snapshot : m_document.snapshots()) {
    if (snapshot->view.name == m_camera && !snapshot->robot_state.names.empty()) out.push_back(snapshot);
  }
  return out;
}

void PoseController::setSnapshot(SnapshotId id) {
  m_snapshot = id;
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
  const auto* camera = spec();
  if (camera == nullptr) return Pose::Identity();
  if (m_unknown == Unknown::kExt) {
    const auto file = m_calibration.fileInUse(m_camera);
    return file && file->pose && file->pose->parent == camera->link ? file->pose->pose.inverse() : Pose::Identity();
  }
  if (m_unknown == Unknown::kObj) return objectSpec() != nullptr ? objectSpec()->X_WO : Pose::Identity();
  return Pose::Identity();   // T_dev: a correction of the foot, in the root
}

std::optional<calibration::LoopView> PoseController::loopView(const vision::Snapshot& snapshot) const {
  const auto& model = *m_document.workcell()->model;
  const auto link = model.linkIndex(spec()->link);
  if (!link) return std::nullopt;
  const Eigen::VectorXd q = configuration(snapshot);
  const Pose X_WL = model.forward(q, *link);
  calibration::LoopView view;
  view.name = std::to_string(snapshot.id.value);
  const auto file = m_calibration.fileInUse(m_camera);
  const Pose X_LC = file && file->pose && file->pose->parent == spec()->link ? file->pose->pose : Pose::Identity();
  view.T_ext = X_LC.inverse();
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
  auto view = loopView(snapshot);
  const auto point = loopPoint(landmark, snapshot);
  if (!view || !point) return std::nullopt;
  view->points.push_back({*point, {0, 0}, 0});
  calibration::LoopProblem problem{snapshot.view.camera, {*view}};
  return calibration::observationsOf(problem, m_unknown).front();
}

std::optional<Eigen::Vector2d> PoseController::projected(const Landmark& landmark, const vision::Snapshot& snapshot, const Pose& unknown) const {
  const auto o = observation(landmark, snapshot);
  if (!o) return std::nullopt;
  const auto pixel = snapshot.view.camera.project(o->A * unknown * o->y);
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
  const Pose T_ext = m_unknown == Unknown::kExt ? estimate() : loop->T_ext;
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
    const auto at = projected(pick.landmark, *from, inUse());
    if (at) out.push_back(pick.pixel - *at);
  }
  return out;
}

std::optional<double> PoseController::missInUse() const {
  double sum = 0;
  int count = 0;
  for (const auto& pick : m_picks) {
    const auto from = m_document.snapshot(pick.snapshot);
    const auto at = from ? projected(pick.landmark, *from, inUse()) : std::nullopt;
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
  for (const auto& [a, b] : edgesOf(*m_document.workcell(), configuration(*shown))) {
    std::vector<Eigen::Vector2d> line;
    for (int i = 0; i <= 8; ++i) {
      const auto at = view->project(a + (b - a) * i / 8.0);
      if (at) line.push_back(*at);
    }
    if (line.size() == 9) add(&overlay, OverlayShape::Kind::kPolyline, OverlayRole::kEllipse, line);
  }
  const Pose now = estimate();
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
  m_stale = m_picks.size() >= kLeast;
  if (spec() == nullptr) m_why = tr("There is no camera to calibrate: the workcell has none, or none is chosen.");
  else if (m_unknown == Unknown::kObj && objectSpec() == nullptr) m_why = tr("Choose the object whose place is unknown; it must stand in the workcell file.");
  else if (m_unknown == Unknown::kDev && spec()->pan_tilt.empty()) m_why = tr("Camera %1 hangs on no pan-tilt: its mount is T_ext.").arg(QString::fromStdString(m_camera));
  else if (snapshots().empty()) m_why = tr("Take a picture with camera %1 first.").arg(QString::fromStdString(m_camera));
  else m_why = tr("%1 of at least 3 points are clicked: choose a landmark, then click it in the picture. Five or more, well spread, are good.").arg(m_picks.size());
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
        Q_EMIT changed();
      });
}

// Goes on to the landmark that would help most in this picture.
void PoseController::advise() {
  const auto shown = snapshot();
  if (!shown || m_landmarks.empty() || spec() == nullptr) return;
  std::vector<calibration::PoseObservation> have, candidates;
  std::vector<int> index;
  for (const auto& pick : m_picks) {
    const auto from = m_document.snapshot(pick.snapshot);
    if (const auto o = from ? observation(pick.landmark, *from) : std::nullopt) have.push_back(*o);
  }
  for (std::size_t i = 0; i < m_landmarks.size(); ++i) {
    const bool known = std::any_of(m_picks.begin(), m_picks.end(), [&](const LandmarkPick& p) { return p.snapshot == m_snapshot && p.landmark.name == m_landmarks[i].name; });
    const auto o = known ? std::nullopt : observation(m_landmarks[i], *shown);
    if (!o) continue;
    candidates.push_back(*o);
    index.push_back(static_cast<int>(i));
  }
  const auto next = calibration::nextPoint(shown->view.camera, have, candidates, estimate());
  m_landmark = next ? index[*next] : -1;
  Q_EMIT changed();
}

QString PoseController::whyNotApply() const {
  if (m_solving || m_stale) return tr("The pose is being calculated.");
  if (!m_outcome) return m_why;
  if (m_unknown == Unknown::kDev) return tr("the foot of a pan-tilt stands in the URDF: write the numbers above into the origin of its pan joint.");
  return {};
}

CameraChange PoseController::change() const {
  CameraChange change;
  change.camera = m_camera;
  change.kind = "pose";
  const auto& result = m_outcome->result;
  change.X_LC = result.T[0].inverse();
  const Matrix6d J = calibration::inverseIncrement(result.T[0]);
  change.pose_covariance = J * result.covariance.topLeftCorner<6, 6>() * J.transpose();
  change.rms_px = result.rms_px;
  calibration::LoopProblem problem;
  for (const auto& from : snapshots()) {
    auto view = loopView(*from);
    for (const auto& pick : m_picks) {
      const auto point = view && pick.snapshot == from->id ? loopPoint(pick.landmark, *from) : std::nullopt;
      if (point) view->points.push_back({*point, pick.pixel, pick.landmark.sigma_m});
    }
    if (view && !view->points.empty()) problem.views.push_back(*view);
  }
  for (const auto& o : result.observations) change.observations += o.used ? 1 : 0;
  change.raw = observationsText(problem, "camera.yaml", kClick_px);
  change.raw_ending = "json";
  return change;
}

Pose PoseController::solvedObjectPose() const { return m_outcome ? Pose(m_outcome->result.T[2].inverse()) : inUse(); }

QString PoseController::resultText() const {
  if (!m_outcome) return {};
  const auto& result = m_outcome->result;
  const Matrix6d C = result.covariance.topLeftCorner<6, 6>();
  const double turn = kDegrees * std::sqrt(C.topLeftCorner<3, 3>().trace()), shift = 1000 * std::sqrt(C.bottomRightCorner<3, 3>().trace());
  Pose X = result.T[0].inverse();
  QString what = tr("Camera in link %1").arg(QString::fromStdString(spec() != nullptr ? spec()->link : std::string()));
  if (m_unknown == Unknown::kObj) {
    X = solvedObjectPose();
    what = tr("Object %1 in its parent").arg(QString::fromStdString(m_object));
  } else if (m_unknown == Unknown::kDev) {
    X = result.T[1].inverse();
    what = tr("Foot of the pan-tilt, against where the URDF has it, in the root frame");
  }
  QStringList lines{what + QStringLiteral(": ") + QString::fromStdString(poseText(X)),
                    tr("rms %1 px over %2 points; sure to %3\u00b0 and %4 mm (1 sigma).")
                        .arg(QString::number(result.rms_px, 'f', 2), QString::number(result.observations.size()), QString::number(turn, 'f', 3),
                             QString::number(shift, 'f', 2)),
                    tr("Least certain: %1.").arg(QString::fromStdString(result.weakest))};
  for (const auto& warning : result.warnings) lines << QString::fromStdString(warning);
  return lines.join(QLatin1Char('\n'));
}

}  // namespace longarm::session
