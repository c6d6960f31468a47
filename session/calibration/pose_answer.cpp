// What PoseController makes of its clicks: advice, changes, words.
#include <algorithm>
#include <cmath>

#include "calibration/pose/next_point.h"
#include "session/calibration/pose_controller.h"
#include "session/calibration/pose_text.h"

namespace longarm::session {

using calibration::PoseObservation;

namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;
constexpr int kClicks = 6;                 // that an operator makes in one more picture
constexpr double kPanStep_rad = 15 / kDegrees, kTiltStep_rad = 12 / kDegrees, kPanMost_rad = 75 / kDegrees;
constexpr double kLowest_m = 0.1;          // a gripper is not sent nearer to the ground

QString part(int third, const QString& first, const QString& last) { return third < 0 ? first : third > 0 ? last : QString(); }

// "upper left", "middle"
QString placeWords(int across, int down) {
  const QStringList words{part(down, QObject::tr("upper"), QObject::tr("lower")), part(across, QObject::tr("left"), QObject::tr("right"))};
  const QString both = words.join(QLatin1Char(' ')).trimmed();
  return both.isEmpty() ? QObject::tr("middle") : both;
}

}  // namespace

// Goes on to the landmark that would help most in this picture.
void PoseController::advise() {
  const auto shown = snapshot();
  if (!shown || m_landmarks.empty() || spec() == nullptr) return;
  std::vector<PoseObservation> candidates;
  std::vector<int> index;
  for (std::size_t i = 0; i < m_landmarks.size(); ++i) {
    const bool known = std::any_of(m_picks.begin(), m_picks.end(), [&](const LandmarkPick& p) { return p.snapshot == m_snapshot && p.landmark.name == m_landmarks[i].name; });
    const auto o = known ? std::nullopt : observation(m_landmarks[i], *shown);
    if (!o) continue;
    candidates.push_back(*o);
    index.push_back(static_cast<int>(i));
  }
  const auto next = calibration::nextPoint(shown->view.camera, observed(), candidates, estimate());
  m_landmark = next ? index[*next] : -1;
  Q_EMIT changed();
}

std::vector<PoseObservation> PoseController::observed() const {
  std::vector<PoseObservation> have;
  for (const auto& pick : m_picks) {
    const auto from = m_document.snapshot(pick.snapshot);
    if (const auto o = from ? observation(pick.landmark, *from) : std::nullopt) have.push_back(*o);
  }
  return have;
}

std::vector<PoseObservation> PoseController::seenFrom(const Eigen::VectorXd& q) const {
  std::vector<PoseObservation> out;
  for (const auto& mark : m_landmarks) {
    if (const auto o = observationAt(mark, q, extNow(m_X_LC.inverse()))) out.push_back(*o);
  }
  return out;
}

// Further angles of the pan-tilt that carries the camera.
void PoseController::offerAngles(std::vector<PictureOffer>* offers) const {
  const auto& workcell = *m_document.workcell();
  for (const auto& unit : workcell.pan_tilts) {
    const auto pan = workcell.model->jointIndex(unit.pan_joint), tilt = workcell.model->jointIndex(unit.tilt_joint);
    if (unit.name != spec()->pan_tilt || !pan || !tilt) continue;
    const auto &p = workcell.model->joints()[static_cast<std::size_t>(*pan)], &t = workcell.model->joints()[static_cast<std::size_t>(*tilt)];
    for (double a = std::max(p.lower, -kPanMost_rad); a <= std::min(p.upper, kPanMost_rad); a += kPanStep_rad) {
      for (double b = std::max(t.lower, -kPanMost_rad); b <= std::min(t.upper, kPanMost_rad); b += kTiltStep_rad) {
        Eigen::VectorXd q = configurationNow();
        q[p.q_index] = a;
        q[t.q_index] = b;
        offers->push_back({tr("turn %1 to pan %2\u00b0, tilt %3\u00b0").arg(QString::fromStdString(unit.name), QString::number(kDegrees * a, 'f', 0), QString::number(kDegrees * b, 'f', 0)),
                           seenFrom(q)});
      }
    }
  }
}

// Canned poses of the arm, for a camera that the arm carries.
void PoseController::offerPoses(std::vector<PictureOffer>* offers) const {
  const auto& model = *m_document.workcell()->model;
  for (const auto& [name, joints] : m_document.workcell()->poses) {
    Eigen::VectorXd q = configurationNow();
    for (const auto& [joint, value] : joints) {
      const auto index = model.jointIndex(joint);
      if (index && model.joints()[static_cast<std::size_t>(*index)].q_index >= 0) q[model.joints()[static_cast<std::size_t>(*index)].q_index] = value;
    }
    offers->push_back({tr("bring the arm to %1").arg(QString::fromStdString(name)), seenFrom(q)});
  }
}

// Places of the gripper before a camera that stands still, as far as the arm reaches.
void PoseController::offerGripper(std::vector<PictureOffer>* offers) const {
  const auto view = viewNow();
  const auto link = view ? m_document.workcell()->model->linkIndex(spec()->link) : Result<int>(ErrorCode::kNotFound, "");
  if (!link) return;
  const auto& workcell = *m_document.workcell();
  const auto& model = *workcell.model;
  const auto base = model.linkIndex(workcell.arm.base_link);
  double reach = 0;
  for (const int joint : workcell.arm.joints) reach += model.joints()[static_cast<std::size_t>(joint)].X_PJ.translation().norm();
  const Eigen::VectorXd q = configurationNow();
  const Pose X_WL = model.forward(q, *link);
  const Eigen::Vector3d shoulder = base ? Eigen::Vector3d(model.forward(q, *base).translation()) : Eigen::Vector3d::Zero();
  for (int across = -1; across <= 1; ++across) {
    for (int down = -1; down <= 1; ++down) {
      const auto ray = view->camera.rayOfPixel({view->camera.width * (0.5 + 0.35 * across), view->camera.height * (0.5 + 0.35 * down)});
      for (const double depth : {0.5, 0.9, 1.4, 2.0}) {
        if (!ray) continue;
        const Eigen::Vector3d p_W = view->X_WC * Eigen::Vector3d(*ray * (depth / ray->z()));
        if ((p_W - shoulder).norm() > reach || p_W.z() < kLowest_m) continue;
        PoseObservation o;
        o.A = Pose::Identity();
        o.y = X_WL.inverse() * p_W;
        offers->push_back({tr("hold the gripper at the %1 of the picture, %2 m away").arg(placeWords(across, down), QString::number(depth, 'f', 1)), {o}});
      }
    }
  }
}

void PoseController::advisePicture() {
  m_next_picture.clear();
  const auto shown = snapshot();
  if (!m_outcome || !shown || spec() == nullptr || cameraToo()) return;
  std::vector<PictureOffer> offers;
  if (!spec()->pan_tilt.empty()) offerAngles(&offers);
  else if (isCarriedByArm()) offerPoses(&offers);
  else if (m_unknown == Unknown::kExt) offerGripper(&offers);
  std::vector<std::vector<PoseObservation>> candidates;
  for (const auto& offer : offers) candidates.push_back(offer.points);
  const auto next = calibration::nextPicture(shown->view.camera, observed(), candidates, estimate(), kClicks, kClick_px);
  if (!next) return;
  m_next_picture = tr("Next picture: %1. %2 known points would be in it: %3\u00b0 and %4 mm instead of %5\u00b0 and %6 mm.")
                       .arg(offers[next->index].words, QString::number(next->points), QString::number(kDegrees * next->turn_after, 'f', 3),
                            QString::number(1000 * next->shift_after, 'f', 2), QString::number(kDegrees * next->turn_before, 'f', 3),
                            QString::number(1000 * next->shift_before, 'f', 2));
}

bool PoseController::isCarriedByArm() const {
  const auto& model = *m_document.workcell()->model;
  const auto index = model.linkIndex(spec()->link);
  for (int link = index ? *index : -1; link >= 0;) {
    const int up = model.links()[static_cast<std::size_t>(link)].parent_joint;
    if (up < 0) return false;
    const auto& joints = m_document.workcell()->arm.joints;
    if (std::find(joints.begin(), joints.end(), up) != joints.end()) return true;
    link = model.joints()[static_cast<std::size_t>(up)].parent_link;
  }
  return false;
}

QString PoseController::whyNotApply() const {
  if (m_solving || m_stale) return tr("The pose is being calculated.");
  if (!m_outcome) return m_why;
  if (m_unknown == Unknown::kDev && !footOfPanTilt()) {
    return tr("what carries the pan-tilt %1 moved between the pictures: click in pictures taken with it at one place.").arg(QString::fromStdString(spec()->pan_tilt));
  }
  return {};
}

QString PoseController::whyWorse() const {
  if (!whyNotApply().isEmpty()) return {};
  const QString place = m_unknown == Unknown::kExt ? QString() : m_calibration.whyWorse(placeChange());
  const QString camera = m_unknown == Unknown::kExt || cameraToo() ? m_calibration.whyWorse(change()) : QString();
  return QStringList{place, camera}.join(QLatin1Char('\n')).trimmed();
}

CameraChange PoseController::change() const {
  CameraChange change;
  change.camera = m_camera;
  change.kind = "pose";
  const auto& result = m_outcome->result;
  change.X_LC = result.T[0].inverse();
  if (const auto from = m_document.snapshot(m_picks.front().snapshot)) change.zoom = from->view.zoom;
  const Matrix6d J = calibration::inverseIncrement(result.T[0]);
  const Eigen::Index at = m_unknown == Unknown::kExt ? 0 : 6;      // in the order of the unknowns
  change.pose_covariance = J * result.covariance.block<6, 6>(at, at) * J.transpose();
  change.rms_px = result.rms_px;
  for (const auto& o : result.observations) change.observations += o.used ? 1 : 0;
  change.raw = rawText();
  change.raw_ending = "json";
  return change;
}

std::optional<Pose> PoseController::footOfPanTilt() const {
  const auto& workcell = *m_document.workcell();
  const auto joint = panJointOf(workcell, spec()->pan_tilt);
  std::optional<Pose> foot;
  for (const auto& pick : m_picks) {
    const auto from = m_document.snapshot(pick.snapshot);
    if (!from || !joint) return std::nullopt;
    const Pose now = workcell.model->forward(configuration(*from), workcell.model->joints()[static_cast<std::size_t>(*joint)].parent_link);
    if (foot && !foot->isApprox(now, 1e-4)) return std::nullopt;
    if (!foot) foot = now;
  }
  return foot;
}

// The correction U of the root stands before the way to the pan joint: in the foot F it is X_FW U X_WF X_FJ.
Placement PoseController::footPlacement() const {
  const auto& workcell = *m_document.workcell();
  const auto& model = *workcell.model;
  const auto& result = m_outcome->result;
  const auto& joint = model.joints()[static_cast<std::size_t>(*panJointOf(workcell, spec()->pan_tilt))];
  const Pose U = result.T[1].inverse(), X_WF = *footOfPanTilt(), right = X_WF * joint.X_PJ;
  const Eigen::Matrix3d R_FW = X_WF.linear().transpose();
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = R_FW;
  J.bottomRightCorner<3, 3>() = R_FW;
  J.bottomLeftCorner<3, 3>() = -R_FW * skew(U.linear() * right.translation());
  J = (J * calibration::inverseIncrement(result.T[1])).eval();
  return {{model.links()[static_cast<std::size_t>(joint.parent_link)].name, X_WF.inverse() * U * right}, J * result.covariance.topLeftCorner<6, 6>() * J.transpose()};
}

PlaceChange PoseController::placeChange() const {
  PlaceChange change;
  const auto& result = m_outcome->result;
  if (m_unknown == Unknown::kObj) {
    change.subject = Subject::kObject;
    change.name = m_object;
    const Matrix6d J = calibration::inverseIncrement(result.T[2]);
    change.placement = {{objectSpec()->attached_link, solvedObjectPose()}, J * result.covariance.topLeftCorner<6, 6>() * J.transpose()};
  } else {
    change.subject = Subject::kPanTilt;
    change.name = spec()->pan_tilt;
    change.placement = footPlacement();
  }
  change.rms_px = result.rms_px;
  for (const auto& o : result.observations) change.observations += o.used ? 1 : 0;
  change.raw = rawText();
  change.raw_ending = "json";
  return change;
}

std::string PoseController::rawText() const {
  calibration::LoopProblem problem;
  if (const auto first = m_document.snapshot(m_picks.front().snapshot)) problem.camera = first->view.camera;
  for (const auto& from : snapshots()) {
    auto view = loopView(*from);
    for (const auto& pick : m_picks) {
      const auto point = view && pick.snapshot == from->id ? loopPoint(pick.landmark, *from) : std::nullopt;
      if (point) view->points.push_back({*point, pick.pixel, pick.landmark.sigma_m});
    }
    if (!view || view->points.empty()) continue;
    if (cameraToo()) {                     // each of the two is found again with the other as it was found
      view->T_ext = m_outcome->result.T[0];
      if (m_unknown == Unknown::kDev) view->T_dev = m_outcome->result.T[1];
      else view->T_obj = m_outcome->result.T[2];
    }
    problem.views.push_back(*view);
  }
  return observationsText(problem, kClick_px);
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
    what = tr("Foot of the pan-tilt, against where it was thought to be, in the root frame");
  }
  QStringList lines{what + QStringLiteral(": ") + QString::fromStdString(poseText(X)),
                    tr("rms %1 px over %2 points; sure to %3\u00b0 and %4 mm (1 sigma).")
                        .arg(QString::number(result.rms_px, 'f', 2), QString::number(result.observations.size()), QString::number(turn, 'f', 3),
                             QString::number(shift, 'f', 2)),
                    tr("Least certain: %1.").arg(QString::fromStdString(result.weakest))};
  if (cameraToo()) {
    const Matrix6d E = result.covariance.block<6, 6>(6, 6);
    lines.insert(1, tr("Camera in link %1: %2; sure to %3\u00b0 and %4 mm.")
                        .arg(QString::fromStdString(spec()->link), QString::fromStdString(poseText(result.T[0].inverse())),
                             QString::number(kDegrees * std::sqrt(E.topLeftCorner<3, 3>().trace()), 'f', 3), QString::number(1000 * std::sqrt(E.bottomRightCorner<3, 3>().trace()), 'f', 2)));
  }
  for (const auto& warning : result.warnings) lines << QString::fromStdString(warning);
  if (!m_next_picture.isEmpty()) lines << m_next_picture;
  return lines.join(QLatin1Char('\n'));
}

}  // namespace longarm::session
