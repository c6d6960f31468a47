#pragma once

/// @file
/// BoardCollection: the pictures of an intrinsic calibration, which of them count, and what they give.

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calibration/intrinsics/board_detector.h"
#include "calibration/intrinsics/calibrate_intrinsics.h"
#include "calibration/intrinsics/coverage.h"
#include "calibration/intrinsics/lens_uncertainty.h"
#include "calibration/intrinsics/next_view.h"

namespace longarm::session {

/// One picture that was searched.
struct BoardPicture {
  std::string name;
  cv::Mat image;                                   ///< Shared; never written.
  std::optional<calibration::BoardView> view;      ///< Empty: no board was found.
  std::string why;                                 ///< Then: why not.
  bool included = true;                            ///< The operator's choice.
  std::optional<double> zoom;                      ///< Setting of the lens, 0 ... 1; empty: fixed, or not known.
};

/// Searches a picture for the board; an empty image is read from the file of this name first.
/// @param live Quickly, as detectBoardLive.  @returns as loadImage; a picture without a board is no error.
Result<BoardPicture> searchedPicture(const std::string& name, const cv::Mat& image, const calibration::BoardSpec& spec, bool live);

/// Plain value; pictures keep their order.
class BoardCollection {
 public:
  const std::vector<BoardPicture>& pictures() const { return m_pictures; }
  int width() const { return m_pictures.empty() ? 0 : m_pictures.front().image.cols; }
  int height() const { return m_pictures.empty() ? 0 : m_pictures.front().image.rows; }

  /// @returns kInvalidInput naming both sizes when the picture is not as large as the first, kOutOfLimits beyond kMost.
  Status add(BoardPicture picture);
  /// @pre index < pictures().size()
  void setIncluded(std::size_t index, bool included) { m_pictures[index].included = included; }
  void remove(std::size_t index) { m_pictures.erase(m_pictures.begin() + static_cast<std::ptrdiff_t>(index)); }
  void clear() { m_pictures.clear(); }

  /// Indices of the pictures that have a board, are included, and were taken at the newest setting of the zoom: one lens.
  std::vector<std::size_t> usable() const;
  /// Setting of the newest picture with a board that is included; empty: its lens is fixed, or there is none.
  std::optional<double> zoom() const;
  /// Whether two pictures were taken through the same lens.
  static bool sameZoom(const std::optional<double>& a, const std::optional<double>& b);
  /// Why there is nothing to solve yet; empty: there is.
  std::string whyNotReady() const;

  static constexpr std::size_t kLeast = 3, kMost = 200;

 private:
  std::vector<BoardPicture> m_pictures;
};

/// What a collection gives.
struct IntrinsicsOutcome {
  calibration::IntrinsicsResult result;
  std::optional<double> zoom;                      ///< Setting of the lens; empty: fixed, or not known.
  std::vector<std::size_t> picture;                ///< Of each view of `result`: index in the collection.
  std::vector<calibration::BoardView> views;       ///< In the same order.
  calibration::Coverage coverage;
  std::optional<calibration::NextView> next;
  calibration::LensUncertainty uncertainty;

  /// Index of the view made from a picture; empty: that picture took no part.
  std::optional<std::size_t> viewOf(std::size_t picture_index) const;
  /// Measured minus projected pixel of every corner of a view.
  std::vector<Eigen::Vector2d> residuals(std::size_t view) const;
};

/// @returns kRefused with whyNotReady(), or as calibrateIntrinsics.  Pure function; may take a second.
Result<IntrinsicsOutcome> solveBoards(const BoardCollection& boards, const calibration::LensChoice& lens);

/// The corners as corners.csv (view,x,y,z,u,v), which `calibrate intrinsics --corners` solves again.
std::string cornersText(const std::vector<calibration::BoardView>& views);

}  // namespace longarm::session
