#include "calibration/intrinsics/board_detector.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/text.h"

namespace longarm::calibration {
namespace {

constexpr int kSearchSide = 1280, kLiveSide = 320;
constexpr double kBlurredVariance = 12;   // of the Laplacian, grey levels squared

// Found points with the index of their place on the board.
struct Found {
  std::vector<int> index;
  std::vector<cv::Point2f> pixels;
};

cv::Mat greyOf(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

// Shrinks a large picture for the search; `scale` is its size over the original's.
cv::Mat searchImage(const cv::Mat& grey, int side, double* scale) {
  *scale = std::min(1.0, static_cast<double>(side) / std::max(grey.cols, grey.rows));
  if (*scale >= 1) return grey;
  cv::Mat small;
  cv::resize(grey, small, cv::Size(), *scale, *scale, cv::INTER_AREA);
  return small;
}

void toFullSize(double scale, std::vector<cv::Point2f>* pixels) {
  for (auto& p : *pixels) {
    p.x = static_cast<float>((p.x + 0.5) / scale - 0.5);
    p.y = static_cast<float>((p.y + 0.5) / scale - 0.5);
  }
}

double smallestSpacing(const std::vector<cv::Point2f>& pixels) {
  double smallest = 1e9;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    for (std::size_t j = i + 1; j < pixels.size(); ++j) {
      smallest = std::min(smallest, static_cast<double>(std::hypot(pixels[i].x - pixels[j].x, pixels[i].y - pixels[j].y)));
    }
  }
  return smallest;
}

void refine(const cv::Mat& grey, int half_window, std::vector<cv::Point2f>* pixels) {
  const int chosen = half_window > 0 ? half_window : std::clamp(static_cast<int>(smallestSpacing(*pixels) / 3), 2, 10);
  cv::cornerSubPix(grey, *pixels, cv::Size(chosen, chosen), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-4));
}

std::vector<int> allIndices(std::size_t n) {
  std::vector<int> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<int>(i);
  return out;
}

Found findChessboard(const cv::Mat& grey, const BoardSpec& spec, int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE) {
  double scale = 1;
  const cv::Mat small = searchImage(grey, kSearchSide, &scale);
  Found found;
  const cv::Size size(spec.columns, spec.rows);
  if (!cv::findChessboardCorners(small, size, found.pixels, flags)) return {};
  toFullSize(scale, &found.pixels);
  refine(grey, spec.half_window, &found.pixels);
  found.index = allIndices(found.pixels.size());
  return found;
}

bool mayHoldChessboard(const cv::Mat& grey, const BoardSpec& spec, int side) {
  double scale = 1;
  return cv::checkChessboard(searchImage(grey, side, &scale), cv::Size(spec.columns, spec.rows));
}

// Most live pictures hold no board: a check on small pictures says so soon.  Those that do are mostly lit evenly:
// one threshold finds the squares sooner than one for every neighbourhood.
Found findChessboardLive(const cv::Mat& grey, const BoardSpec& spec) {
  if (!mayHoldChessboard(grey, spec, kLiveSide) && !mayHoldChessboard(grey, spec, kLiveSide * 3 / 2)) return {};
  const Found quick = findChessboard(grey, spec, 0);
  return quick.index.empty() ? findChessboard(grey, spec) : quick;
}

Found findCircles(const cv::Mat& grey, const BoardSpec& spec) {
  Found found;
  const cv::Size size(spec.columns, spec.rows);
  if (!cv::findCirclesGrid(grey, size, found.pixels, cv::CALIB_CB_SYMMETRIC_GRID) &&
      !cv::findCirclesGrid(grey, size, found.pixels, cv::CALIB_CB_SYMMETRIC_GRID | cv::CALIB_CB_CLUSTERING)) {
    return {};
  }
  found.index = allIndices(found.pixels.size());
  return found;
}

// Nobody knows which dictionary a printed board is from: the one that explains most markers.
Found findCharuco(const cv::Mat& grey, const BoardSpec& spec) {
  Found best;
  const double marker = spec.marker > 0 ? spec.marker : 0.75 * spec.square;
  for (const int name : {cv::aruco::DICT_4X4_1000, cv::aruco::DICT_5X5_1000, cv::aruco::DICT_6X6_1000,
                         cv::aruco::DICT_7X7_1000, cv::aruco::DICT_ARUCO_ORIGINAL}) {
    const auto dictionary = cv::aruco::getPredefinedDictionary(name);
    const auto board = cv::aruco::CharucoBoard::create(spec.columns + 1, spec.rows + 1, static_cast<float>(spec.square),
                                                       static_cast<float>(marker), dictionary);
    std::vector<std::vector<cv::Point2f>> corners;
    std::vector<int> ids;
    cv::aruco::detectMarkers(grey, dictionary, corners, ids);
    if (ids.size() < 4) continue;
    Found found;
    cv::aruco::interpolateCornersCharuco(corners, ids, grey, board, found.pixels, found.index);
    if (found.index.size() > best.index.size()) best = found;
  }
  return best;
}

bool isBlurred(const cv::Mat& grey) {
  cv::Mat laplacian, mean, deviation;
  cv::Laplacian(grey, laplacian, CV_64F);
  cv::meanStdDev(laplacian, mean, deviation);
  return deviation.at<double>(0) * deviation.at<double>(0) < kBlurredVariance;
}

std::string sizeText(const BoardSpec& spec) { return std::to_string(spec.columns) + "x" + std::to_string(spec.rows); }

Error notFound(const cv::Mat& grey, const BoardSpec& spec) {
  if (isBlurred(grey)) return {ErrorCode::kNoSolution, "no board found: the picture is blurred or empty; hold the board still"};
  return {ErrorCode::kNoSolution, "no " + sizeText(spec) + " board found; it must lie wholly in the picture with a white rim "
                                  "(a board of 10 x 7 squares has 9x6 inner corners)"};
}

Found find(const cv::Mat& grey, const BoardSpec& spec) {
  switch (spec.kind) {
    case BoardKind::kChessboard: return findChessboard(grey, spec);
    case BoardKind::kCharuco: return findCharuco(grey, spec);
    case BoardKind::kCircles: return findCircles(grey, spec);
  }
  return {};
}

}  // namespace

namespace {

Result<BoardView> viewOf(const Found& found, const BoardSpec& spec, const std::string& name) {
  const auto points = boardPoints(spec);
  BoardView view{name, {}};
  for (std::size_t i = 0; i < found.index.size(); ++i) {
    const auto at = static_cast<std::size_t>(found.index[i]);
    if (at < points.size()) view.corners.push_back({points[at], {found.pixels[i].x, found.pixels[i].y}, 0});
  }
  return view;
}

Result<BoardView> detect(const cv::Mat& image, const BoardSpec& spec, const std::string& name, bool live) {
  if (image.empty()) return Error{ErrorCode::kInvalidInput, name + ": the picture is empty"};
  try {
    const cv::Mat grey = greyOf(image);
    const Found found = live && spec.kind == BoardKind::kChessboard ? findChessboardLive(grey, spec) : find(grey, spec);
    if (found.index.size() < 4) return notFound(grey, spec);
    return viewOf(found, spec, name);
  } catch (const std::exception& exception) {
    return Error{ErrorCode::kNoSolution, std::string("the board search failed: ") + exception.what()};
  }
}

}  // namespace

Result<BoardKind> boardKindFromText(const std::string& text) {
  if (text == "chessboard") return BoardKind::kChessboard;
  if (text == "charuco") return BoardKind::kCharuco;
  if (text == "circles") return BoardKind::kCircles;
  return Error{ErrorCode::kInvalidInput, "--board-kind: \"" + text.substr(0, 40) + "\" is unknown; expected chessboard, charuco or circles"};
}

bool sameBoard(const BoardSpec& a, const BoardSpec& b) {
  return a.kind == b.kind && a.columns == b.columns && a.rows == b.rows && a.square == b.square && a.marker == b.marker &&
         a.half_window == b.half_window;
}

std::vector<Eigen::Vector3d> boardPoints(const BoardSpec& spec) {
  std::vector<Eigen::Vector3d> out;
  for (int r = 0; r < spec.rows; ++r) {
    for (int c = 0; c < spec.columns; ++c) out.emplace_back(c * spec.square, r * spec.square, 0);
  }
  return out;
}

Result<BoardView> detectBoard(const cv::Mat& image, const BoardSpec& spec, const std::string& name) {
  return detect(image, spec, name, false);
}

Result<BoardView> detectBoardLive(const cv::Mat& image, const BoardSpec& spec, const std::string& name) {
  return detect(image, spec, name, true);
}

std::string otherBoardHint(const cv::Mat& image, const BoardSpec& spec) {
  if (spec.kind != BoardKind::kChessboard) return {};
  std::set<std::pair<int, int>> tried;
  for (const auto& [dc, dr] : {std::pair<int, int>{-1, -1}, {1, 1}, {-1, 0}, {0, -1}, {1, 0}, {0, 1}}) {
    BoardSpec other = spec;
    other.columns += dc;
    other.rows += dr;
    if (other.columns < 3 || other.rows < 3 || !tried.insert({other.columns, other.rows}).second) continue;
    if (detectBoard(image, other, "").ok()) return "a " + sizeText(other) + " board was found: --board counts inner corners";
  }
  return {};
}

}  // namespace longarm::calibration
