#include "session/calibration/auto_capture.h"

#include <algorithm>
#include <limits>

#include <opencv2/imgproc.hpp>

namespace longarm::session {

using calibration::BoardView;

namespace {

// Corners of both views at the same place of the board; a chessboard's numbering may start at either end.
template <typename Fold>
double overCorners(const BoardView& a, const BoardView& b, bool turned, Fold fold) {
  double value = 0;
  for (std::size_t i = 0; i < a.corners.size(); ++i) {
    const std::size_t j = turned ? b.corners.size() - 1 - i : i;
    value = fold(value, (a.corners[i].pixel - b.corners[j].pixel).norm());
  }
  return value;
}

// Boards of which not the same corners are seen are taken for different.
double largestMove(const BoardView& a, const BoardView& b) {
  if (a.corners.size() != b.corners.size() || a.corners.empty()) return std::numeric_limits<double>::infinity();
  const auto largest = [](double so_far, double next) { return std::max(so_far, next); };
  return std::min(overCorners(a, b, false, largest), overCorners(a, b, true, largest));
}

double meanMove(const BoardView& a, const BoardView& b) {
  if (a.corners.size() != b.corners.size() || a.corners.empty()) return std::numeric_limits<double>::infinity();
  const auto sum = [](double so_far, double next) { return so_far + next; };
  return std::min(overCorners(a, b, false, sum), overCorners(a, b, true, sum)) / static_cast<double>(a.corners.size());
}

cv::Rect boundsOf(const BoardView& board, const cv::Size& picture) {
  Eigen::Vector2d low = board.corners.front().pixel, high = low;
  for (const auto& c : board.corners) {
    low = low.cwiseMin(c.pixel);
    high = high.cwiseMax(c.pixel);
  }
  const cv::Rect box(static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(high.x() - low.x()) + 1,
                     static_cast<int>(high.y() - low.y()) + 1);
  return box & cv::Rect({0, 0}, picture);
}

}  // namespace

double boardSharpness(const cv::Mat& image, const BoardView& board) {
  if (image.empty() || board.corners.empty()) return 0;
  const cv::Rect box = boundsOf(board, image.size());
  if (box.width < 8 || box.height < 8) return 0;
  cv::Mat grey, fine, mean, deviation, fine_deviation;
  if (image.channels() == 1) grey = image(box);
  else cv::cvtColor(image(box), grey, cv::COLOR_BGR2GRAY);
  cv::Laplacian(grey, fine, CV_32F);
  cv::meanStdDev(grey, mean, deviation);
  cv::meanStdDev(fine, mean, fine_deviation);
  return deviation.at<double>(0) > 1 ? fine_deviation.at<double>(0) / deviation.at<double>(0) : 0;
}

void AutoCapture::reset() { *this = AutoCapture(m_limits); }

AutoCapture::Verdict AutoCapture::offerNothing() {
  m_still = 0;
  m_last = {};
  return Verdict::kNoBoard;
}

bool AutoCapture::isNew(const BoardView& board, int width) const {
  return std::all_of(m_kept.begin(), m_kept.end(),
                     [&](const BoardView& kept) { return meanMove(board, kept) > m_limits.new_place * width; });
}

AutoCapture::Verdict AutoCapture::offer(const BoardView& board, double sharpness, int width, double stamp_s) {
  const bool still = largestMove(board, m_last) <= m_limits.still_px * width / 640;
  m_last = board;
  m_still = still ? m_still + 1 : 0;
  if (!still) m_still_since_s = stamp_s;
  // The sharpest so far fades slowly: far boards are never as sharp as near ones.
  m_sharpest = std::max(sharpness, 0.995 * m_sharpest);
  if (!isNew(board, width)) return Verdict::kKnownPlace;
  if (m_still < 1 || stamp_s - m_still_since_s < m_limits.still_for_s) return Verdict::kMoving;
  return sharpness < m_limits.sharpness * m_sharpest ? Verdict::kBlurred : Verdict::kKeep;
}

std::string toString(AutoCapture::Verdict verdict) {
  switch (verdict) {
    case AutoCapture::Verdict::kNoBoard: return "no board in the picture";
    case AutoCapture::Verdict::kMoving: return "hold the board still";
    case AutoCapture::Verdict::kBlurred: return "not sharp: hold it still, or nearer to where the lens focuses";
    case AutoCapture::Verdict::kKnownPlace: return "this place is known: move or tilt the board";
    case AutoCapture::Verdict::kKeep: return "kept";
  }
  return {};
}

}  // namespace longarm::session
