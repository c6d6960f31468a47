#include "session/calibration/stereo_controller.h"

#include <algorithm>
#include <cmath>

#include "calibration/intrinsics/picture_pairs.h"
#include "core/text.h"
#include "session/calibration/pose_text.h"

namespace longarm::session {

using calibration::BoardSpec;
using calibration::StereoResult;

namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;
constexpr double kScale = 1.1;             // A robot's description is nearer than this to its cameras' distance.
constexpr double kSameWay = 0.97, kShortest_m = 0.01;

QString sizeText(const cv::Mat& image) { return QStringLiteral("%1 x %2").arg(image.cols).arg(image.rows); }

}  // namespace

StereoController::StereoController(Document& document, CalibrationController& calibration, JobRunner& jobs, QObject* parent)
    : QObject(parent), m_document(document), m_calibration(calibration), m_jobs(jobs) {
  connect(&m_calibration, &CalibrationController::applied, this, [this] { collectionChanged(); });
  collectionChanged();
}

void StereoController::setCameras(const QString& left, const QString& right) {
  if (left.toStdString() == m_cameras[0] && right.toStdString() == m_cameras[1]) return;
  m_cameras = {left.toStdString(), right.toStdString()};
  leaveLive();
  collectionChanged();
}

void StereoController::setBoard(const BoardSpec& board) {
  if (calibration::sameBoard(board, m_board)) return;
  m_board = board;
  leaveLive();
  std::deque<Waiting> again;
  for (const auto& pair : m_pairs) again.push_back({{pair.side[0].name, pair.side[1].name}, {pair.side[0].image, pair.side[1].image}, pair.included});
  for (auto& waiting : m_waiting) again.push_back(std::move(waiting));
  m_waiting = std::move(again);
  m_pairs.clear();
  collectionChanged();
  searchNext();
}

void StereoController::setRefine(bool refine) {
  if (refine == m_refine) return;
  m_refine = refine;
  collectionChanged();
}

Result<vision::CameraFile> StereoController::lens(int side) const { return m_calibration.fileInUse(camera(side)); }

void StereoController::addFiles(const QStringList& paths) {
  std::vector<std::string> names;
  for (const QString& path : paths) names.push_back(path.toStdString());
  const auto order = calibration::pairPictures(names);
  if (!order) {
    Q_EMIT failed(QString::fromStdString(order.error().message));
    return;
  }
  for (const auto& [left, right] : *order) m_waiting.push_back({{names[left], names[right]}, {}, true});
  searchNext();
  Q_EMIT changed();
}

void StereoController::searchNext() {
  if (m_searching || m_waiting.empty()) return;
  m_searching = true;
  const Waiting next = std::move(m_waiting.front());
  m_waiting.pop_front();
  m_jobs.run<PicturePair>(
      this,
      [next, spec = m_board]() -> Result<PicturePair> {
        PicturePair pair;
        for (std::size_t side = 0; side < 2; ++side) {
          auto picture = searchedPicture(next.name[side], next.image[side], spec, false);
          if (!picture) return picture.error();
          pair.side[side] = std::move(*picture);
        }
        return pair;
      },
      [this, included = next.included, generation = m_generation](Result<PicturePair> pair) {
        if (generation != m_generation) return;
        m_searching = false;
        take(std::move(pair), included);
        searchNext();
        Q_EMIT changed();
      });
}

void StereoController::take(Result<PicturePair> pair, bool included) {
  if (!pair) {
    Q_EMIT failed(QString::fromStdString(pair.error().message));
    return;
  }
  pair->included = included;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto file = lens(static_cast<int>(side));
    const cv::Mat& image = pair->side[side].image;
    if (!file || file->camera.width <= 0 || (image.cols == file->camera.width && image.rows == file->camera.height)) continue;
    Q_EMIT failed(tr("%1 is %2 pixels, camera %3 gives %4 x %5: choose the cameras that took the pictures.")
                      .arg(QString::fromStdString(pair->side[side].name), sizeText(image), QString::fromStdString(m_cameras[side]))
                      .arg(file->camera.width)
                      .arg(file->camera.height));
    return;
  }
  if (m_pairs.size() >= kMost) {
    Q_EMIT failed(tr("There are %1 pairs already, and more teach nothing. Remove some first.").arg(kMost));
    return;
  }
  if (pair->usable()) {
    for (std::size_t side = 0; side < 2; ++side) m_capture[side].kept(*pair->side[side].view);
  }
  m_pairs.push_back(std::move(*pair));
  collectionChanged();
}

void StereoController::offerLive(int side, const cv::Mat& picture, double stamp_s) {
  if (picture.empty()) return;
  m_newest[static_cast<std::size_t>(side)] = {picture, stamp_s};
  if (m_looking || std::abs(m_newest[0].stamp_s - m_newest[1].stamp_s) > kTogether_s) return;
  m_looking = true;
  struct Seen {
    PicturePair pair;
    std::array<double, 2> sharpness{};
  };
  m_jobs.run<Seen>(
      this,
      [newest = m_newest, spec = m_board]() -> Result<Seen> {
        Seen out;
        for (std::size_t i = 0; i < 2; ++i) {
          auto found = searchedPicture("live", newest[i].image, spec, true);
          if (!found) return found.error();
          if (found->view) out.sharpness[i] = boardSharpness(newest[i].image, *found->view);
          out.pair.side[i] = std::move(*found);
        }
        return out;
      },
      [this, stamp = std::max(m_newest[0].stamp_s, m_newest[1].stamp_s), generation = m_generation](Result<Seen> seen_pair) {
        m_looking = false;
        if (generation == m_generation && seen_pair) seen(std::move(seen_pair->pair), seen_pair->sharpness, stamp);
      });
}

void StereoController::seen(PicturePair pair, std::array<double, 2> sharpness, double stamp_s) {
  std::array<AutoCapture::Verdict, 2> verdict{};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& view = pair.side[i].view;
    verdict[i] = view ? m_capture[i].offer(*view, sharpness[i], pair.side[i].image.cols, stamp_s) : m_capture[i].offerNothing();
  }
  m_live = std::move(pair);
  using Verdict = AutoCapture::Verdict;
  const auto rests = [](Verdict v) { return v == Verdict::kKeep || v == Verdict::kKnownPlace; };
  // A place that is new to one camera is worth a pair.
  const bool keep = rests(verdict[0]) && rests(verdict[1]) && (verdict[0] == Verdict::kKeep || verdict[1] == Verdict::kKeep);
  const auto words = [&](std::size_t i) { return QString::fromStdString(toString(verdict[i])); };
  m_live_words = verdict[0] == verdict[1] ? words(0) : tr("left: %1; right: %2").arg(words(0), words(1));
  if (m_auto && keep) capture();
  Q_EMIT liveChanged();
}

QString StereoController::whyNotCapture() const {
  if (!m_live) return tr("There is no live pair.");
  if (!m_live->usable()) return tr("The board is not in both live pictures.");
  return {};
}

void StereoController::capture() {
  if (const QString why = whyNotCapture(); !why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  PicturePair pair = *m_live;
  ++m_captured;
  for (std::size_t i = 0; i < 2; ++i) {
    pair.side[i].name = (i == 0 ? "left live " : "right live ") + std::to_string(m_captured);
    pair.side[i].view->name = pair.side[i].name;
  }
  const std::size_t before = m_pairs.size();
  take(std::move(pair), true);
  if (m_pairs.size() > before) Q_EMIT captured(static_cast<int>(m_pairs.size()));
}

void StereoController::leaveLive() {
  ++m_generation;
  m_searching = false;
  m_live.reset();
  m_newest = {};
  m_live_words.clear();
  for (auto& capture : m_capture) capture.reset();
  for (const auto& pair : m_pairs) {
    if (!pair.usable()) continue;
    for (std::size_t side = 0; side < 2; ++side) m_capture[side].kept(*pair.side[side].view);
  }
  Q_EMIT liveChanged();
  searchNext();
}

void StereoController::setIncluded(std::size_t pair, bool included) {
  if (pair >= m_pairs.size() || m_pairs[pair].included == included) return;
  m_pairs[pair].included = included;
  collectionChanged();
}

void StereoController::remove(std::size_t pair) {
  if (pair >= m_pairs.size()) return;
  m_pairs.erase(m_pairs.begin() + static_cast<std::ptrdiff_t>(pair));
  collectionChanged();
}

void StereoController::clear() {
  m_pairs.clear();
  m_waiting.clear();
  leaveLive();
  collectionChanged();
}

std::vector<std::size_t> StereoController::usable() const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < m_pairs.size(); ++i) {
    if (m_pairs[i].included && m_pairs[i].usable()) out.push_back(i);
  }
  return out;
}

void StereoController::collectionChanged() {
  m_outcome.reset();
  m_stale = false;
  if (m_cameras[0].empty() || m_cameras[0] == m_cameras[1]) m_why = tr("Choose the left and the right camera: two different ones.");
  else if (m_pairs.empty()) m_why = tr("There are no pairs yet: open pictures of both cameras, or show the board to both live.");
  else if (usable().size() < kLeast) m_why = tr("%1 pairs show the board on both sides; at least %2, with the board tilted differently, are needed.").arg(usable().size()).arg(kLeast);
  else m_stale = true;
  solve();
  Q_EMIT changed();
}

void StereoController::solve() {
  if (m_solving || !m_stale) return;
  m_stale = false;
  const auto left = lens(0), right = lens(1);
  if (!left || !right) {
    m_why = QString::fromStdString(left ? right.error().message : left.error().message);
    return;
  }
  m_solving = true;
  const auto order = usable();
  std::vector<calibration::BoardPair> pairs;
  for (const std::size_t i : order) pairs.push_back({*m_pairs[i].side[0].view, *m_pairs[i].side[1].view});
  calibration::StereoOptions options;
  options.refine = m_refine;
  m_jobs.run<StereoOutcome>(
      this,
      [pairs, order, options, left = *left, right = *right]() -> Result<StereoOutcome> {
        auto result = calibration::calibrateStereo(pairs, left, right, options);
        if (!result) return result.error();
        return StereoOutcome{std::move(*result), order};
      },
      [this, order](Result<StereoOutcome> outcome) {
        m_solving = false;
        if (m_stale) return solve();
        if (order == usable()) {
          if (outcome) m_outcome = std::move(*outcome);
          m_why = outcome ? QString() : QString::fromStdString(outcome.error().message);
        }
        Q_EMIT changed();
      });
}

QString StereoController::resultText() const {
  if (!m_outcome) return {};
  const StereoResult& r = m_outcome->result;
  const Matrix6d& C = r.covariance;
  QStringList lines{tr("Right in left: %1.").arg(QString::fromStdString(poseText(r.X_LR))),
                    tr("Baseline %1 mm; sure to %2\u00b0 and %3 mm (1 sigma).")
                        .arg(QString::number(1000 * r.X_LR.translation().norm(), 'f', 2), QString::number(kDegrees * std::sqrt(C.topLeftCorner<3, 3>().trace()), 'f', 3),
                             QString::number(1000 * std::sqrt(C.bottomRightCorner<3, 3>().trace()), 'f', 2)),
                    tr("rms %1 px per component over %2 pairs.")
                        .arg(QString::number(r.rms_px, 'f', 3), QString::number(std::count_if(r.pairs.begin(), r.pairs.end(), [](const auto& p) { return p.used; })))};
  for (const auto& warning : r.warnings) lines << QString::fromStdString(warning);
  if (const QString square = squareWarning(); !square.isEmpty()) lines << square;
  return lines.join(QLatin1Char('\n'));
}

// A wrong square scales the baseline and nothing else: the one place where its size shows.
QString StereoController::squareWarning() const {
  const auto now = pairInUse();
  if (!now || now->translation().norm() < kShortest_m) return {};
  const Eigen::Vector3d a = now->translation(), b = m_outcome->result.X_LR.translation();
  const double ratio = b.norm() / a.norm();
  const bool same_way = a.normalized().dot(b.normalized()) > kSameWay;
  if (!same_way || (ratio < kScale && ratio > 1 / kScale)) return {};
  return tr("The baseline points where the robot has it but is %1 mm, not %2 mm: are the squares %3 mm, not %4 mm?")
      .arg(QString::number(1000 * b.norm(), 'f', 1), QString::number(1000 * a.norm(), 'f', 1), QString::number(1000 * m_board.square / ratio, 'f', 1),
           QString::number(1000 * m_board.square, 'f', 1));
}

std::optional<Pose> StereoController::pairInUse() const {
  const auto between = betweenLinks();
  const auto left = lens(0), right = lens(1);
  if (!between || !left || !right) return std::nullopt;
  return Pose(m_calibration.mountInUse(m_cameras[0]).inverse() * *between * m_calibration.mountInUse(m_cameras[1]));
}

QString StereoController::whyNotSave() const {
  if (m_solving || m_stale) return tr("The pose is being calculated.");
  return m_outcome ? QString() : m_why;
}

void StereoController::save(const QString& left_path, const QString& right_path) {
  auto left = lens(0), right = lens(1);
  QString why = whyNotSave();
  if (why.isEmpty() && !left) why = QString::fromStdString(left.error().message);
  if (why.isEmpty() && !right) why = QString::fromStdString(right.error().message);
  if (!why.isEmpty()) {
    Q_EMIT failed(why);
    return;
  }
  const StereoResult& r = m_outcome->result;
  left->camera = r.left;
  right->camera = r.right;
  const std::string parent = m_cameras[0];
  left->pose = PoseInParent{parent, Pose::Identity()};
  right->pose = PoseInParent{parent, r.X_LR};
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(16, 16);
  if (m_refine) C.topLeftCorner<10, 10>() = r.right_covariance;
  else if (right->covariance) C.topLeftCorner<10, 10>() = right->covariance->topLeftCorner<10, 10>();
  C.bottomRightCorner<6, 6>() = r.covariance;
  right->covariance = C;
  if (m_refine) left->covariance = Eigen::MatrixXd(r.left_covariance);
  else if (left->covariance) left->covariance = Eigen::MatrixXd(left->covariance->topLeftCorner<10, 10>());
  Status written = vision::writeCameraFile(left_path.toStdString(), *left);
  if (written) written = vision::writeCameraFile(right_path.toStdString(), *right);
  if (written) Q_EMIT saved(left_path, right_path);
  else Q_EMIT failed(QString::fromStdString(written.error().message));
}

std::optional<Pose> StereoController::betweenLinks() const {
  const auto& workcell = m_document.workcell();
  const auto *a = workcell ? workcell->camera(m_cameras[0]) : nullptr, *b = workcell ? workcell->camera(m_cameras[1]) : nullptr;
  if (a == nullptr || b == nullptr || !workcell->model) return std::nullopt;
  const auto& model = *workcell->model;
  const auto left = model.linkIndex(a->link), right = model.linkIndex(b->link);
  if (!left || !right) return std::nullopt;
  const auto between = [&](const Eigen::VectorXd& q) { return Pose(model.forward(q, *left).inverse() * model.forward(q, *right)); };
  const Eigen::VectorXd q = model.neutral();
  const Pose here = between(q);
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    Eigen::VectorXd turned = q;
    turned[i] += 0.1;
    if (!between(turned).isApprox(here, 1e-9)) return std::nullopt;
  }
  return here;
}

QString StereoController::whyNotApply() const {
  if (const QString why = whyNotSave(); !why.isEmpty()) return why;
  if (!betweenLinks()) return tr("A joint between the two cameras moves: how they stand to each other is no mount. Save the pair to files.");
  return {};
}

std::string StereoController::rawText() const {
  std::string out = "pair,side,x,y,z,u,v\n";
  for (const std::size_t i : usable()) {
    for (std::size_t side = 0; side < 2; ++side) {
      for (const auto& c : m_pairs[i].side[side].view->corners) {
        out += std::to_string(i + 1) + (side == 0 ? ",left" : ",right");
        for (const double number : {c.xyz.x(), c.xyz.y(), c.xyz.z(), c.pixel.x(), c.pixel.y()}) out += "," + formatNumber(number);
        out += "\n";
      }
    }
  }
  return out;
}

std::vector<CameraChange> StereoController::changes() const {
  const StereoResult& r = m_outcome->result;
  const auto left_file = lens(0);
  const auto& link = m_document.workcell()->camera(m_cameras[0])->link;
  const Pose X_AC = left_file && left_file->pose && left_file->pose->parent == link ? left_file->pose->pose : Pose::Identity();   // left camera in its link A
  const Pose X_BC = betweenLinks()->inverse() * X_AC;
  std::vector<CameraChange> out;
  CameraChange right;
  right.camera = m_cameras[1];
  right.kind = "stereo";
  right.note = "with " + m_cameras[0];
  right.X_LC = X_BC * r.X_LR;
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = X_BC.linear();
  turn.bottomRightCorner<3, 3>() = X_BC.linear();
  right.pose_covariance = turn * r.covariance * turn.transpose();
  right.rms_px = r.rms_px;
  for (const std::size_t i : usable()) right.observations += static_cast<int>(m_pairs[i].side[0].view->corners.size() + m_pairs[i].side[1].view->corners.size());
  right.raw = rawText();
  right.raw_ending = "csv";
  if (m_refine) {
    CameraChange left = right;
    left.camera = m_cameras[0];
    left.note = "with " + m_cameras[1];
    left.X_LC.reset();
    left.lens = r.left;
    left.lens_covariance = r.left_covariance;
    right.lens = r.right;
    right.lens_covariance = r.right_covariance;
    out.push_back(left);
  }
  out.push_back(right);
  return out;
}

}  // namespace longarm::session
