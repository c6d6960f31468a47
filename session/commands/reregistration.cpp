#include "session/commands/reregistration.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include "core/text.h"
#include "session/commands/world_commands.h"

namespace longarm::session {
namespace {

constexpr int kLeastMarks = 3;
constexpr double kWorstFit = 0.05;    // [m]
constexpr double kWorstTurn = 0.05;   // 1 sigma of the rotation [rad]
constexpr double kLeastSigma = 1e-4;  // [m]

void addMarks(const std::string& name, const vision::Feature& then, const vision::Feature& now,
              std::vector<MarkedTwice>& out) {
  const std::size_t n = std::min(then.vertices.size(), now.vertices.size());
  for (std::size_t i = 0; i < n; ++i) {
    out.push_back({name, then.vertices[i].xyz, now.vertices[i].xyz, then.vertices[i].covariance,
                   now.vertices[i].covariance});
  }
}

// A new item under the same name, measured from where the robot is.
const vision::Feature* namesake(const Document& document, const SketchItem& item) {
  for (const auto& other : document.items()) {
    if (other.id == item.id || other.kind != item.kind || other.pipe != item.pipe || other.name != item.name)
      continue;
    const Measurement& measured = document.measurement(other.id);
    if (measured.feature && !measured.stale) return &*measured.feature;
  }
  return nullptr;
}

Eigen::Matrix3d informationOf(const MarkedTwice& mark, const Eigen::Matrix3d& R) {
  const Eigen::Matrix3d least = kLeastSigma * kLeastSigma * Eigen::Matrix3d::Identity();
  return (mark.covariance_now + R * mark.covariance_then * R.transpose() + least).inverse();
}

struct Normal {
  Matrix6d H = Matrix6d::Zero();
  Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
  double chi2 = 0, squares = 0;
};

// r = now - (R then + p); R <- Exp(w) R, p <- p + t.
Normal normalEquations(const std::vector<MarkedTwice>& marks, const Pose& X) {
  Normal sum;
  for (const auto& mark : marks) {
    const Eigen::Vector3d turned = X.linear() * mark.then, r = mark.now - turned - X.translation();
    Eigen::Matrix<double, 3, 6> J;
    J << skew(turned), -Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d W = informationOf(mark, X.linear());
    sum.H += J.transpose() * W * J;
    sum.g += J.transpose() * W * r;
    sum.chi2 += r.dot(W * r);
    sum.squares += r.squaredNorm();
  }
  return sum;
}

std::vector<BaseState> oldPlaces(const Document& document) {
  std::vector<BaseState> places;
  const auto add = [&](const std::optional<BaseState>& base) {
    if (!base) return;
    if (std::none_of(places.begin(), places.end(), [&](const BaseState& p) { return samePlace(p, *base); }))
      places.push_back(*base);
  };
  for (const auto& snapshot : document.snapshots()) {
    if (document.stale(snapshot->id)) add(snapshot->base);
  }
  for (const auto& body : document.world()) {
    if (document.stale(body)) add(body.base);
  }
  return places;
}

// A camera placed by a motion that is not exactly known: both uncertainties add up.
SnapshotPtr moved(const vision::Snapshot& snapshot, const Registration& by, const BaseState& now) {
  auto copy = std::make_shared<vision::Snapshot>(snapshot);
  const Eigen::Vector3d turned = by.X_now_then.linear() * snapshot.view.X_WC.translation();
  Matrix6d J = Matrix6d::Identity(), turn = Matrix6d::Zero();
  J.bottomLeftCorner<3, 3>() = -skew(turned);
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = by.X_now_then.linear();
  copy->view.pose_covariance =
      turn * snapshot.view.pose_covariance * turn.transpose() + J * by.covariance * J.transpose();
  copy->view.X_WC = by.X_now_then * snapshot.view.X_WC;
  copy->base = now;
  return copy;
}

class ReplaceSnapshots final : public EditCommand {
 public:
  ReplaceSnapshots(std::vector<SnapshotPtr> before, std::vector<SnapshotPtr> after)
      : m_before(std::move(before)), m_after(std::move(after)) {}
  void apply(Document& document) override { put(document, m_after); }
  void revert(Document& document) override { put(document, m_before); }
  std::string label() const override { return "Re-register pictures"; }

 private:
  static void put(Document& document, const std::vector<SnapshotPtr>& snapshots) {
    for (const auto& snapshot : snapshots) document.replaceSnapshot(snapshot);
  }
  std::vector<SnapshotPtr> m_before, m_after;
};

WorldItem moved(WorldItem body, const Registration& by, const BaseState& now) {
  body.X_WO = by.X_now_then * body.X_WO;
  for (auto& point : body.points) point = by.X_now_then * point;
  body.base = now;
  return body;
}

}  // namespace

std::vector<MarkedTwice> markedTwice(const Document& document, const BaseState& then) {
  std::vector<MarkedTwice> out;
  for (const auto& item : document.items()) {
    const Measurement before = document.measureFrom(item, then);
    if (!before.feature) continue;
    const Measurement& now = document.measurement(item.id);
    if (now.feature && !now.stale) {
      addMarks(item.name, *before.feature, *now.feature, out);
    } else if (const vision::Feature* again = namesake(document, item)) {
      addMarks(item.name, *before.feature, *again, out);
    }
  }
  return out;
}

Result<Registration> fitMarks(const std::vector<MarkedTwice>& marks) {
  const int n = static_cast<int>(marks.size());
  if (n < kLeastMarks) {
    return Error{
        ErrorCode::kRefused,
        "Mark at least three corners of stale features again in new pictures, under the same names: " +
            std::to_string(n) + " of 3 so far."};
  }
  Eigen::Matrix3Xd then(3, n), now(3, n);
  for (int i = 0; i < n; ++i) {
    then.col(i) = marks[static_cast<std::size_t>(i)].then;
    now.col(i) = marks[static_cast<std::size_t>(i)].now;
  }
  Registration out;
  out.X_now_then.matrix() = Eigen::umeyama(then, now, false);
  out.marks = n;
  for (int i = 0; i < 10; ++i) {
    const Normal normal = normalEquations(marks, out.X_now_then);
    const Eigen::Matrix<double, 6, 1> step = -normal.H.ldlt().solve(normal.g);
    if (!step.allFinite()) break;
    out.X_now_then.linear() = expSO3(step.head<3>()) * out.X_now_then.linear();
    out.X_now_then.translation() += step.tail<3>();
    if (step.norm() < 1e-12) break;
  }
  const Normal normal = normalEquations(marks, out.X_now_then);
  // By its axes: a decomposition without pivots would take what is not determined for certain.
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(normal.H);
  out.covariance = axes.eigenvectors() * axes.eigenvalues().cwiseMax(1e-300).cwiseInverse().asDiagonal() * axes.eigenvectors().transpose();
  out.residual_rms = std::sqrt(normal.squares / n);
  const double worst_turn =
      out.covariance.topLeftCorner<3, 3>().selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff();
  if (!(worst_turn >= 0 && worst_turn <= kWorstTurn * kWorstTurn)) {
    return Error{ErrorCode::kDegenerate,
                 "The corners that were marked again lie nearly in a line: mark one that lies beside it."};
  }
  if (out.residual_rms > kWorstFit) {
    return Error{ErrorCode::kNoSolution, "The corners that were marked again miss each other by " +
                                             formatFixed(out.residual_rms * 1000, 0) +
                                             " mm: at least one is not the same spot."};
  }
  out.covariance *= std::max(1.0, normal.chi2 / (3 * n - 6));
  return out;
}

Result<Registration> findRegistration(const Document& document) {
  const auto places = oldPlaces(document);
  if (places.empty())
    return Error{ErrorCode::kRefused, "Nothing is stale: the base stands where the pictures were taken."};
  const BaseState* best = &places.front();
  std::vector<MarkedTwice> marks;
  for (const auto& place : places) {
    auto found = markedTwice(document, place);
    if (found.size() <= marks.size()) continue;
    marks = std::move(found);
    best = &place;
  }
  auto out = fitMarks(marks);
  if (!out) return out;
  out->then = *best;
  for (const auto& item : document.items()) {
    if (document.measurement(item.id).stale && document.measureFrom(item, *best).feature) ++out->features;
  }
  return out;
}

CommandPtr applyRegistration(const Document& document, const Registration& registration) {
  if (!document.base()) return nullptr;
  std::vector<SnapshotPtr> before, after;
  for (const auto& snapshot : document.snapshots()) {
    if (!document.stale(snapshot->id) || !samePlace(*snapshot->base, registration.then)) continue;
    before.push_back(snapshot);
    after.push_back(moved(*snapshot, registration, *document.base()));
  }
  std::vector<CommandPtr> commands;
  if (!before.empty())
    commands.push_back(std::make_unique<ReplaceSnapshots>(std::move(before), std::move(after)));
  for (const auto& body : document.world()) {
    if (!document.stale(body) || !samePlace(*body.base, registration.then)) continue;
    commands.push_back(replaceWorldItem(document, moved(body, registration, *document.base())));
  }
  return composite("Re-register after driving", std::move(commands));
}

}  // namespace longarm::session
