#pragma once

/// @file
/// The stereo photographs of a chessboard with 30 mm squares, and their corners.

#include <algorithm>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "vision/snapshot/image_file.h"

namespace longarm::tests {

constexpr int kBoardColumns = 9, kBoardRows = 6;   ///< Inner corners.
constexpr double kSquare = 0.030;                  ///< [m]

inline const std::vector<std::string>& chessboardPairs() {
  static const std::vector<std::string> numbers = {"01", "02", "03", "04", "05", "06", "07",
                                                   "08", "09", "11", "12", "13", "14"};
  return numbers;
}

/// Corners row by row, found at a pixel and refined below it; empty where the board is not found.
inline std::vector<Eigen::Vector2d> chessboardCorners(const std::string& path) {
  const auto image = vision::loadImage(path);
  if (!image) return {};
  cv::Mat grey = *image;
  if (grey.channels() == 3) cv::cvtColor(*image, grey, cv::COLOR_BGR2GRAY);
  std::vector<cv::Point2f> found;
  if (!cv::findChessboardCorners(grey, {kBoardColumns, kBoardRows}, found)) return {};
  // A half-window of 5 px: 11 px, as often seen, reaches the next corner in picture 02.
  cv::cornerSubPix(grey, found, {5, 5}, {-1, -1}, {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4});
  std::vector<Eigen::Vector2d> corners;
  for (const auto& point : found) corners.emplace_back(point.x, point.y);
  return corners;
}

/// The corners of a pair in the same order: either picture's list may start at the board's other end.
inline void alignCorners(const std::vector<Eigen::Vector2d>& left, std::vector<Eigen::Vector2d>* right) {
  const Eigen::Vector2d a = left.back() - left.front(), b = right->back() - right->front();
  if (a.dot(b) < 0) std::reverse(right->begin(), right->end());
}

}  // namespace longarm::tests
