#pragma once

/// @file
/// AutoCapture: which live picture of a board is worth keeping.

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calibration/intrinsics/board_view.h"

namespace longarm::session {

struct CaptureLimits {
  double still_px = 1.0;         ///< Largest move of a corner between two pictures, at 640 px width.
  double still_for_s = 0.35;     ///< For so long, and at least two pictures.
  double sharpness = 0.5;        ///< Of the sharpest board seen so far.
  double new_place = 0.05;       ///< Mean move of the board's extreme corners from every kept one, in picture widths.
};

/// Contrast of the finest detail over that of the whole, inside the board: independent of light.
double boardSharpness(const cv::Mat& image, const calibration::BoardView& board);

/// Watches a stream of detections.  Plain value; not thread-safe.
class AutoCapture {
 public:
  enum class Verdict { kNoBoard, kMoving, kBlurred, kKnownPlace, kKeep };

  explicit AutoCapture(const CaptureLimits& limits = {}) : m_limits(limits) {}

  /// The next picture had no board.
  Verdict offerNothing();
  /// @param width Of the picture [px].  kKeep at most once for one resting place: call kept() with what was kept.
  Verdict offer(const calibration::BoardView& board, double sharpness, int width, double stamp_s);
  void kept(const calibration::BoardView& board) { m_kept.push_back(board); }
  void reset();

 private:
  bool isNew(const calibration::BoardView& board, int width) const;

  CaptureLimits m_limits;
  calibration::BoardView m_last;
  double m_still_since_s = 0, m_last_s = 0, m_sharpest = 0;
  int m_still = 0;                                 // pictures in a row that did not move
  std::vector<calibration::BoardView> m_kept;
};
/// For the operator: "hold it still", ...
std::string toString(AutoCapture::Verdict verdict);

}  // namespace longarm::session
