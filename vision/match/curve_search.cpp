#include "vision/match/curve_search.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace longarm::vision::internal {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kStep = 0.5;                 // [px] along the curve
constexpr double kApart = 3;                  // [px] peaks nearer than this to a higher one are its shoulders
constexpr double kMaxShapeError = 0.8;        // [px] at the patch's corner, within one group of hypotheses
constexpr std::size_t kMaxSteps = 20000;

struct Station {
  Vector2d pixel, tangent;
  double depth;
};

// A visible piece of the curve, walked in equal steps of arc length.
std::vector<std::vector<Station>> stationsOf(const EpipolarCurve& curve) {
  std::vector<std::vector<Station>> pieces;
  double due = 0;   // arc length from the last corner to the next station
  std::size_t count = 0;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    if (i == 0 || curve.points[i].begins_piece) {
      pieces.emplace_back();
      due = 0;
      continue;
    }
    const auto& a = curve.points[i - 1];
    const auto& b = curve.points[i];
    const Vector2d chord = b.pixel - a.pixel;
    const double length = chord.norm();
    for (; due <= length && length > 0 && count < kMaxSteps; due += kStep, ++count) {
      const double s = due / length;
      pieces.back().push_back({a.pixel + s * chord, chord / length, 1 / ((1 - s) / a.depth + s / b.depth)});
    }
    due = std::max(0.0, due - length);
  }
  return pieces;
}

// One piece of the curve straightened: columns are half pixels along it, rows pixels across it.
class Strip {
 public:
  Strip(const std::vector<Station>& stations, const MatchPicture& picture, const CurveSearchOptions& options)
      : m_stations(stations), m_margin(static_cast<int>(options.half_along / kStep)), m_reach(options.half_across + options.across) {
    m_pixels.create(2 * m_reach + 1, static_cast<int>(stations.size()) + 2 * m_margin, CV_32F);
    for (int column = 0; column < m_pixels.cols; ++column) {
      const Station at = station(column - m_margin);
      for (int row = 0; row < m_pixels.rows; ++row) {
        const Vector2d p = at.pixel + (row - m_reach) * Vector2d(-at.tangent.y(), at.tangent.x());
        m_pixels.at<float>(row, column) = picture.linear(static_cast<float>(p.x()), static_cast<float>(p.y()));
      }
    }
  }

  /// What the patches around stations first ... last - 1 are cut from.
  cv::Mat around(int first, int last) const { return m_pixels.colRange(first, last + 2 * m_margin); }

 private:
  // Straight on beyond both ends.
  Station station(int index) const {
    const int last = static_cast<int>(m_stations.size()) - 1;
    Station at = m_stations[static_cast<std::size_t>(std::clamp(index, 0, last))];
    at.pixel += (index - std::clamp(index, 0, last)) * kStep * at.tangent;
    return at;
  }

  const std::vector<Station>& m_stations;
  int m_margin, m_reach;
  cv::Mat m_pixels;
};

// The pick's neighbourhood as the strip would show it.
cv::Mat patchOf(const MatchPicture& picture, const LocalWarp& warp, const Vector2d& tangent, const CurveSearchOptions& options) {
  const int half_columns = static_cast<int>(options.half_along / kStep);
  cv::Mat patch(2 * options.half_across + 1, 2 * half_columns + 1, CV_32F);
  const Vector2d along = warp.from_by_to * tangent * kStep, across = warp.from_by_to * Vector2d(-tangent.y(), tangent.x());
  for (int row = 0; row < patch.rows; ++row) {
    for (int column = 0; column < patch.cols; ++column) {
      const Vector2d p = warp.from + (column - half_columns) * along + (row - options.half_across) * across;
      patch.at<float>(row, column) = picture.linear(static_cast<float>(p.x()), static_cast<float>(p.y()));
    }
  }
  return patch;
}

bool sameShape(const LocalWarp& a, const LocalWarp& b, const Vector2d& tangent_a, const Vector2d& tangent_b,
               const CurveSearchOptions& options) {
  const double reach = options.half_along;
  return (a.from_by_to - b.from_by_to).norm() * reach < kMaxShapeError && (tangent_a - tangent_b).norm() * reach < kMaxShapeError;
}

class PieceSearch {
 public:
  PieceSearch(const PlaneWarp& warps, const MatchPicture& from, const MatchPicture& to, const std::vector<Station>& stations,
              const CurveSearchOptions& options)
      : m_warps(warps), m_from(from), m_options(options), m_stations(stations), m_strip(stations, to, options),
        m_score(stations.size(), -1.0f), m_across(stations.size(), 0), m_warp(stations.size()) {
    for (std::size_t first = 0; first < stations.size();) first = scoreGroup(first);
  }

  void addPeaks(std::vector<CurvePeak>* peaks) const {
    for (std::size_t i = 0; i < m_score.size(); ++i) {
      if (!m_warp[i] || m_score[i] <= 0 || !isPeak(i)) continue;
      CurvePeak peak;
      const Station& at = m_stations[i];
      peak.warp = *m_warp[i];
      peak.warp.to = at.pixel + m_across[i] * Vector2d(-at.tangent.y(), at.tangent.x());
      peak.tangent = at.tangent;
      peak.depth = at.depth;
      peak.zncc = m_score[i];
      peaks->push_back(peak);
    }
  }

 private:
  // Scores the stations from `first` on whose patches have one shape; returns the next one.
  std::size_t scoreGroup(std::size_t first) {
    const auto warp = m_warps.at(m_stations[first].depth);
    if (!warp) return first + 1;
    std::size_t last = first + 1;
    // Warps change slowly: probe ahead in strides, then take the last one that still has the shape.
    constexpr std::size_t kStride = 16;
    while (last < m_stations.size()) {
      const std::size_t probe = std::min(last + kStride, m_stations.size()) - 1;
      const auto other = m_warps.at(m_stations[probe].depth);
      if (!other || !sameShape(*warp, *other, m_stations[first].tangent, m_stations[probe].tangent, m_options)) break;
      last = probe + 1;
    }
    const auto middle = m_warps.at(m_stations[(first + last) / 2].depth);
    const LocalWarp& used = middle ? *middle : *warp;
    const cv::Mat patch = patchOf(m_from, used, m_stations[(first + last) / 2].tangent, m_options);
    cv::Mat scores;   // rows: across, columns: along
    cv::matchTemplate(m_strip.around(static_cast<int>(first), static_cast<int>(last)), patch, scores, cv::TM_CCOEFF_NORMED);
    for (std::size_t i = first; i < last; ++i) takeBest(scores, static_cast<int>(i - first), used, i);
    return last;
  }

  void takeBest(const cv::Mat& scores, int column, const LocalWarp& warp, std::size_t station) {
    m_warp[station] = warp;
    for (int row = 0; row < scores.rows; ++row) {
      const float score = scores.at<float>(row, column);
      if (!(score > m_score[station]) || !std::isfinite(score)) continue;
      m_score[station] = score;
      m_across[station] = row - m_options.across;
    }
  }

  bool isPeak(std::size_t i) const {
    const auto reach = static_cast<std::size_t>(kApart / kStep);
    const std::size_t first = i > reach ? i - reach : 0, last = std::min(m_score.size(), i + reach + 1);
    for (std::size_t k = first; k < last; ++k) {
      if (m_score[k] > m_score[i] || (m_score[k] == m_score[i] && k < i)) return false;
    }
    return true;
  }

  const PlaneWarp& m_warps;
  const MatchPicture& m_from;
  const CurveSearchOptions& m_options;
  const std::vector<Station>& m_stations;
  Strip m_strip;
  std::vector<float> m_score;
  std::vector<int> m_across;
  std::vector<std::optional<LocalWarp>> m_warp;
};

}  // namespace

Result<std::vector<CurvePeak>> searchCurve(const View& from, const MatchPicture& from_picture, const Vector2d& pixel,
                                           const View& to, const MatchPicture& to_picture, const CurveSearchOptions& options) {
  EpipolarOptions epipolar;
  epipolar.min_depth = options.min_depth;
  epipolar.max_depth = options.max_depth;
  epipolar.max_sag_px = 0.1;
  const auto curve = epipolarCurve(from, pixel, to, epipolar);
  if (!curve) return curve.error();
  const PlaneWarp warps(from, pixel, to);
  std::vector<CurvePeak> peaks;
  for (const auto& stations : stationsOf(*curve)) {
    if (stations.empty()) continue;
    PieceSearch(warps, from_picture, to_picture, stations, options).addPeaks(&peaks);
  }
  std::stable_sort(peaks.begin(), peaks.end(), [](const auto& a, const auto& b) { return a.zncc > b.zncc; });
  return peaks;
}

}  // namespace longarm::vision::internal
