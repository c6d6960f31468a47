#include "vision/match/suggest.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "vision/match/curve_search.h"
#include "vision/match/refine.h"

namespace longarm::vision {
namespace {

using Eigen::Vector2d;
using internal::CurvePeak;
using internal::CurveSearchOptions;
using internal::RefinedMatch;

constexpr double kLeastLikeness = 0.5;      // below this two patches have nothing in common
constexpr int kHalfCore = 4;                // [px] half of what is around the pick itself
constexpr double kOffCurve = 1.5;           // [px] that calibrations are usually off, 1 sigma
constexpr double kCoreShift = 0.6;          // [px] more than this and it belongs to another surface
constexpr int kHalfSide = 5;                // [px]
constexpr double kSideDistance = 6;         // [px] from the pick to the middle of a side
constexpr double kSideShift = 0.8;          // [px] more than this and the patch shows two surfaces
constexpr double kSlope = 0.45;             // stretch and shear that surfaces seldom have
constexpr double kMisfit = 30;              // times the noise that patches of one surface seldom differ by
constexpr double kMaxSideShift = 3;         // [px]
constexpr double kSame = 1.5;               // [px] refined matches nearer than this are one
/// Two patches that differ by less than this cannot be told apart by their likeness (sampling alone makes as much).
constexpr double kLikenessNoise = 0.02;
constexpr double kWorthChecking = 0.2;     // scores below this are not offered whatever the way back says
constexpr double kSmoothing = 0.7;          // [px] sigma

double logistic(double value, double middle, double width) { return 1 / (1 + std::exp(-(value - middle) / width)); }

Status checkPicture(const View& view, const MatchPicture& picture) {
  const bool fits = (view.camera.width <= 0 || view.camera.width == picture.width()) &&
                    (view.camera.height <= 0 || view.camera.height == picture.height());
  if (fits) return {};
  return {ErrorCode::kInvalidInput, "view \"" + view.name + "\": the picture is " + std::to_string(picture.width()) + " x " +
                                        std::to_string(picture.height()) + " pixels but its camera is for " +
                                        std::to_string(view.camera.width) + " x " + std::to_string(view.camera.height)};
}

Status checkInput(const View& from, const MatchPicture& from_picture, const Vector2d& pixel, const View& to,
                  const MatchPicture& to_picture) {
  if (auto status = checkPicture(from, from_picture); !status) return status;
  if (auto status = checkPicture(to, to_picture); !status) return status;
  if (pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() <= from_picture.width() - 0.5 &&
      pixel.y() <= from_picture.height() - 0.5) {
    return {};
  }
  return {ErrorCode::kInvalidInput, "the pick (" + formatFixed(pixel.x(), 1) + ", " + formatFixed(pixel.y(), 1) +
                                        ") is off the picture of view \"" + from.name + "\" (" +
                                        std::to_string(from_picture.width()) + " x " + std::to_string(from_picture.height()) + " px)"};
}

struct Candidate {
  CurvePeak peak;
  RefinedMatch refined;
};

// Both pictures smoothed a little, the finer one to the resolution of the coarser one: noise between pixels would draw
// matches to whole pixels.
struct Pair {
  MatchPicture from, to;
  double magnification = 1;            // of `to` against `from`

  Pair back() const { return {to, from, 1 / magnification}; }
};

Pair pairOf(const View& from, const MatchPicture& from_picture, const Vector2d& pixel, const View& to,
            const MatchPicture& to_picture, const MatchOptions& options) {
  const internal::PlaneWarp warps(from, pixel, to);
  double magnification = 1;
  for (const double depth : {options.max_depth, 2 / (1 / options.min_depth + 1 / options.max_depth), options.min_depth}) {
    if (const auto warp = warps.at(depth)) {
      magnification = std::clamp(warp->magnification(), 0.125, 8.0);
      break;
    }
  }
  const auto sigma = [](double scale) { return std::sqrt(kSmoothing * kSmoothing + 0.25 * (std::max(1.0, scale * scale) - 1)); };
  return {from_picture.blurred(sigma(1 / magnification)), to_picture.blurred(sigma(magnification)), magnification};
}

// Patches are measured in the second picture: larger where that is finer.
MatchOptions scaled(MatchOptions options, double magnification) {
  const double factor = std::clamp(magnification, 1.0, 2.0);
  options.half_along = static_cast<int>(std::lround(factor * options.half_along));
  options.half_across = static_cast<int>(std::lround(factor * options.half_across));
  return options;
}

internal::RefineOptions refineOptions(const MatchOptions& options) {
  internal::RefineOptions out;
  out.half_along = options.half_along;
  out.half_across = options.half_across;
  return out;
}

// The highest peaks, refined, each place once.
std::vector<Candidate> candidatesOf(const std::vector<CurvePeak>& peaks, const Pair& pair, const MatchOptions& options,
                                    std::size_t most) {
  std::vector<Candidate> out;
  for (const auto& peak : peaks) {
    if (out.size() >= most || peak.zncc < 0.6 * kLeastLikeness) break;
    const auto refined = refineMatch(pair.from, peak.warp, peak.tangent, pair.to, refineOptions(options));
    if (!refined) continue;
    const bool known = std::any_of(out.begin(), out.end(), [&](const auto& c) { return (c.refined.pixel - refined->pixel).norm() < kSame; });
    if (!known) out.push_back({peak, *refined});
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.refined.zncc > b.refined.zncc; });
  return out;
}

CurveSearchOptions searchOptions(const MatchOptions& options) {
  CurveSearchOptions out;
  out.min_depth = options.min_depth;
  out.max_depth = options.max_depth;
  out.half_along = options.half_along;
  out.half_across = options.half_across;
  out.across = options.across;
  return out;
}

// Distance of the pick from where the match leads back to [px]; large when it leads nowhere.
double missOfTheWayBack(const View& from, const Vector2d& pixel, const View& to, const Pair& pair, const Vector2d& match,
                        const MatchOptions& options) {
  const auto ray = to.camera.normalisedOfPixel(match);
  if (!ray) return 1e3;
  const MatchOptions backwards = scaled(options, 1 / pair.magnification);
  const auto peaks = searchCurve(to, pair.to, match, from, pair.from, searchOptions(backwards));
  if (!peaks || peaks->empty()) return 1e3;
  const auto back = candidatesOf(*peaks, pair.back(), backwards, 1);
  return back.empty() ? 1e3 : (back.front().refined.pixel - pixel).norm();
}

// How much the best of the others looks like it: 1 if just as much.
double ambiguityOf(const std::vector<Candidate>& candidates, std::size_t which) {
  double rival = -1;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (i != which) rival = std::max(rival, candidates[i].refined.zncc);
  }
  const double own = candidates[which].refined.zncc;
  return std::min(1.0, (1 - own + kLikenessNoise) / (1 - std::max(0.0, rival) + kLikenessNoise));
}

// Whether the few pixels around the pick itself agree with the large patch.  They do not where another surface fills most
// of the patch: at depth edges.
struct CoreCheck {
  double agreement = 0;                       // 0 ... 1
  Vector2d shift = Vector2d::Constant(1e3);   // [px]
};

CoreCheck checkCore(const Candidate& candidate, const Pair& pair) {
  internal::RefineOptions options;
  options.half_along = options.half_across = static_cast<int>(std::lround(kHalfCore * std::clamp(pair.magnification, 1.0, 2.0)));
  options.slope_sigma = 0.02;
  internal::LocalWarp warp = candidate.peak.warp;
  warp.to = candidate.refined.pixel;
  const auto core = refineMatch(pair.from, warp, candidate.peak.tangent, pair.to, options, candidate.refined.slope);
  if (!core) return {};
  const Vector2d shift = core->pixel - candidate.refined.pixel;
  const double alike = std::max(logistic(core->zncc, 0.8, 0.04), logistic(-core->misfit, -1.6, 0.15));
  return {alike * logistic(-core->sigma_along, -0.4, 0.05) * std::exp(-std::pow(shift.norm() / kCoreShift, 2)), shift};
}

// How far the sides of the patch disagree with it about the shift along the curve [px]: they do when the pick lies at the
// edge of something nearer.
double disagreementOfSides(const Candidate& candidate, const Pair& pair) {
  const double scale = std::clamp(pair.magnification, 1.0, 2.0);
  internal::RefineOptions options;
  options.half_along = static_cast<int>(std::lround(kHalfSide * scale));
  options.half_across = options.half_along;
  options.slope_sigma = 0.02;
  options.max_shift_px = kMaxSideShift;
  const Vector2d tangent = candidate.peak.tangent, normal(-tangent.y(), tangent.x());
  double worst = 0;
  for (const Vector2d& side : {Vector2d(1, 0), Vector2d(-1, 0), Vector2d(0, 1), Vector2d(0, -1)}) {
    const Vector2d at = kSideDistance * scale * side;
    internal::LocalWarp warp = candidate.peak.warp;
    warp.from += warp.from_by_to * (at.x() * tangent + at.y() * normal);
    warp.to = candidate.refined.pixel + (at.x() + candidate.refined.slope.dot(at)) * tangent + at.y() * normal;
    const auto found = refineMatch(pair.from, warp, tangent, pair.to, options, candidate.refined.slope);
    if (!found) {
      worst = std::max(worst, 0.5 * kMaxSideShift);
      continue;
    }
    if (found->sigma_along > 0.3 || found->texture < 2) continue;
    worst = std::max(worst, std::abs(tangent.dot(found->pixel - warp.to)));
  }
  return worst;
}

double scoreOf(const RefinedMatch& match, double ambiguity) {
  const double likeness = logistic(match.zncc, 0.75, 0.05), alone = logistic(1 / std::max(1e-3, ambiguity), 1.5, 0.2);
  const double texture = logistic(match.texture, 1.8, 0.2) * logistic(-match.sigma_along, -0.3, 0.05);
  const double plausible = std::exp(-std::pow(match.slope.cwiseAbs().maxCoeff() / kSlope, 2) - std::pow(match.misfit / kMisfit, 2));
  return likeness * alone * texture * plausible * std::exp(-0.5 * std::pow(match.off_curve / kOffCurve, 2));
}

}  // namespace

Result<std::vector<Match>> suggestMatches(const View& from, const MatchPicture& from_picture, const Vector2d& pixel,
                                          const View& to, const MatchPicture& to_picture, const MatchOptions& options) {
  if (auto status = checkInput(from, from_picture, pixel, to, to_picture); !status) return status.error();
  const auto curve = epipolarCurve(from, pixel, to, {options.min_depth, options.max_depth, 0.1});
  if (!curve) return curve.error();
  std::vector<Match> matches;
  try {
    const Pair pair = pairOf(from, from_picture, pixel, to, to_picture, options);
    const MatchOptions used = scaled(options, pair.magnification);
    const auto peaks = searchCurve(from, pair.from, pixel, to, pair.to, searchOptions(used));
    if (!peaks) return peaks.error();
    const auto candidates = candidatesOf(*peaks, pair, used, std::max<std::size_t>(3, options.max_matches));
    for (std::size_t i = 0; i < candidates.size() && matches.size() < options.max_matches; ++i) {
      const RefinedMatch& refined = candidates[i].refined;
      if (refined.zncc < kLeastLikeness || refined.texture < 1.2) continue;
      const auto on_curve = curve->nearest(refined.pixel);
      Match match{refined.pixel, on_curve ? on_curve->depth : candidates[i].peak.depth, 0, ambiguityOf(candidates, i), refined.zncc, refined.covariance};
      const CoreCheck core = checkCore(candidates[i], pair);
      match.score = core.agreement * scoreOf(refined, match.ambiguity);
      if (core.shift.norm() < 10) match.covariance += core.shift * core.shift.transpose();
      if (match.score > kWorthChecking) match.score *= logistic(-disagreementOfSides(candidates[i], pair), -kSideShift, 0.07);
      if (match.score > kWorthChecking) match.score *= std::exp(-std::pow(missOfTheWayBack(from, pixel, to, pair, refined.pixel, options), 2));
      matches.push_back(match);
    }
  } catch (const std::exception& exception) {   // OpenCV
    return Error{ErrorCode::kInternal, std::string("searching for a match failed: ") + exception.what()};
  }
  std::stable_sort(matches.begin(), matches.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
  return matches;
}

}  // namespace longarm::vision
