#pragma once

/// @file
/// Pictures of boards, as several verbs take them.

#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "calibration/intrinsics/board_detector.h"
#include "core/result.h"

namespace longarm::app {

struct BoardImageOptions {
  std::string board, kind = "chessboard";
  double square = 0, marker = 0;
  int half_window = 0;
  std::vector<std::string> images;
};

/// One picture and what was found in it.
struct BoardImage {
  std::string path;
  std::optional<calibration::BoardView> view;
  std::string why;                   ///< Of a picture without a board.
};

struct BoardImages {
  std::vector<BoardImage> images;    ///< In the order given.
  int width = 0, height = 0;
};

/// --board, --square, --board-kind, --marker, --half-window and the pictures.
void addBoardOptions(CLI::App& verb, BoardImageOptions& options);
/// @returns kInvalidInput naming the option.
Result<calibration::BoardSpec> boardSpec(const BoardImageOptions& options);
/// Opens every picture and looks for the board, on all cores.
/// @returns kInvalidInput: options, a picture that cannot be read, or pictures of different sizes.
Result<BoardImages> detectBoards(const BoardImageOptions& options);

}  // namespace longarm::app
