#include "session/tools/clearest_view.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>

#include "core/text.h"
#include "session/document/feature_rows.h"
#include "vision/stereo/triangulate.h"

namespace longarm::session {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kAround = 0.05;           // radius of the surroundings, of the picture's width
constexpr double kNearer_m = 0.02;         // a link hides the place when it is nearer by more than this
constexpr double kStep = 0.1;              // views whose hidden shares differ by less are ranked by how exact they are
constexpr double kAlike = 0.1;             // of the logarithm of sigma
constexpr double kDegree = M_PI / 180;

std::optional<Vector2d> seenAt(const vision::View& view, const Vector3d& place) {
  const auto pixel = view.project(place);
  return pixel && view.camera.containsPixel(*pixel) ? std::optional(*pixel) : std::nullopt;
}

double depthOf(const vision::View& view, const Vector3d& place) { return (view.X_WC.inverse() * place).z(); }

}  // namespace

double hiddenShare(const ViewCandidate& candidate, const Vector3d& place) {
  const auto pixel = seenAt(candidate.view, place);
  if (!pixel || !candidate.mask) return 0;
  return candidate.mask->coveredAbout(*pixel, kAround * candidate.view.camera.width, depthOf(candidate.view, place) - kNearer_m);
}

std::vector<ViewRank> rankViews(const Vector3d& place, const vision::View& kept, const std::vector<ViewCandidate>& candidates) {
  std::vector<ViewRank> ranks;
  const auto in_kept = kept.project(place);
  if (!in_kept) return ranks;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const vision::View& view = candidates[i].view;
    const auto pixel = seenAt(view, place);
    if (!pixel || view.parent != kept.parent) continue;
    const auto point = vision::triangulate({{&kept, *in_kept, 0}, {&view, *pixel, 0}});
    if (!point) continue;
    const Vector3d a = place - kept.X_WC.translation(), b = place - view.X_WC.translation();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(point->covariance, Eigen::EigenvaluesOnly);
    ranks.push_back({i, hiddenShare(candidates[i], place), std::atan2(a.cross(b).norm(), a.dot(b)),
                     std::sqrt(std::max(0.0, axes.eigenvalues()(2)))});
  }
  // Of two that are nearly alike the first stays first: a picture that is there before one that would be taken.
  const auto order = [](const ViewRank& rank) {
    return std::pair(std::floor(rank.covered / kStep + 0.5), std::floor(std::log(rank.sigma_m) / kAlike));
  };
  std::stable_sort(ranks.begin(), ranks.end(), [&](const ViewRank& a, const ViewRank& b) { return order(a) < order(b); });
  return ranks;
}

std::string rankText(const ViewRank& rank) {
  return formatFixed(100 * rank.covered, 0) + " % hidden by the robot, parallax " + formatFixed(rank.parallax / kDegree, 1) +
         "\u00b0, \u00b1 " + millimetreText(plusMinus95(rank.sigma_m));
}

}  // namespace longarm::session
