#pragma once

/// @file
/// Finding calibration boards in pictures.

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calibration/intrinsics/board_view.h"
#include "core/result.h"

namespace longarm::calibration {

enum class BoardKind { kChessboard, kCharuco, kCircles };

/// "chessboard", "charuco" or "circles"; kInvalidInput listing them.
Result<BoardKind> boardKindFromText(const std::string& text);

/// A board as described by the operator.
struct BoardSpec {
  BoardKind kind = BoardKind::kChessboard;
  int columns = 9, rows = 6;         ///< Inner corners (or circles) along x and y.
  double square = 0.025;             ///< Distance between neighbours [m].
  double marker = 0;                 ///< Side of ChArUco markers [m]; 0: three quarters of a square.
  /// Half side of the window in which a corner is refined [px]; 0 chooses a third of the distance to the nearest
  /// neighbour.  A window that reaches the neighbours pulls corners off by pixels.
  int half_window = 0;
};
bool sameBoard(const BoardSpec& a, const BoardSpec& b);

/// The places of all corners: row by row, x along a row, z = 0.
std::vector<Eigen::Vector3d> boardPoints(const BoardSpec& spec);

/// Finds one board.  The search runs on at most 1280 pixels a side, the refinement on the full picture.
/// Chessboards and circles must be seen whole; a ChArUco board may be partly hidden.
/// @param image 8-bit grey or BGR.
/// @returns kNoSolution with what was wrong (no board, blurred), or kInvalidInput for an empty picture.  The order
///   of a chessboard's corners may start at either end.  Thread-safe.
Result<BoardView> detectBoard(const cv::Mat& image, const BoardSpec& spec, const std::string& name);

/// The same for live pictures: most hold no board, and then the answer must come soon.  A chessboard is looked for in a
/// picture of at most 320 pixels a side and then refined on the full one; where that finds nothing but the picture may
/// hold one, in the full picture.  Thread-safe.
Result<BoardView> detectBoardLive(const cv::Mat& image, const BoardSpec& spec, const std::string& name);

/// The sizes near `spec` of a chessboard that is found where `spec` is not, as a hint ("a 9x6 board was found"), or
/// empty.
std::string otherBoardHint(const cv::Mat& image, const BoardSpec& spec);

}  // namespace longarm::calibration
