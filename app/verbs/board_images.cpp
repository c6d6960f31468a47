#include "app/verbs/board_images.h"

#include <atomic>
#include <cmath>
#include <thread>

#include <CLI/Option.hpp>

#include "app/verbs/calibrate_verbs.h"
#include "vision/snapshot/image_file.h"

namespace longarm::app {
namespace {

using calibration::BoardSpec;

struct Looked {
  BoardImage image;
  cv::Size size;
  std::optional<Error> error;
};

Looked lookAt(const std::string& path, const BoardSpec& spec) {
  Looked out;
  out.image.path = path;
  const auto picture = vision::loadImage(path);
  if (!picture) {
    out.error = picture.error();
    return out;
  }
  out.size = picture->size();
  auto view = calibration::detectBoard(*picture, spec, path);
  if (view) out.image.view = std::move(*view);
  else out.image.why = view.error().message;
  return out;
}

std::string sizeText(const cv::Size& size) { return std::to_string(size.width) + " x " + std::to_string(size.height); }

// When no picture holds the board, perhaps they hold another.
void addHint(const BoardSpec& spec, BoardImages* found) {
  for (const auto& image : found->images) {
    if (image.view) return;
  }
  const auto picture = vision::loadImage(found->images.front().path);
  if (!picture) return;
  const std::string hint = calibration::otherBoardHint(*picture, spec);
  if (!hint.empty()) found->images.front().why += "; " + hint;
}

}  // namespace

void addBoardOptions(CLI::App& verb, BoardImageOptions& options) {
  verb.add_option("--board", options.board, "Inner corners (or circles) of the board, COLUMNSxROWS");
  verb.add_option("--square", options.square, "Side of a square (distance of two circles) [m]");
  verb.add_option("--board-kind", options.kind, "chessboard, charuco or circles");
  verb.add_option("--marker", options.marker, "Side of a ChArUco marker [m]; left out: three quarters of a square");
  verb.add_option("--half-window", options.half_window, "Half side of the corner refinement window [px]; 0 chooses it");
  verb.add_option("images", options.images, "Pictures of the board");
}

Result<BoardSpec> boardSpec(const BoardImageOptions& options) {
  BoardSpec spec;
  if (options.board.empty()) return Error{ErrorCode::kInvalidInput, "--board is missing: the inner corners of the board, such as 9x6"};
  const auto size = sizeOption("--board", options.board, 3, 200);
  if (!size) return size.error();
  spec.columns = size->first;
  spec.rows = size->second;
  if (!(options.square > 0 && options.square <= 100)) {
    return Error{ErrorCode::kInvalidInput, "--square: " + std::to_string(options.square) + " is not a length in metres above 0 (write 0.025 for 25 mm)"};
  }
  spec.square = options.square;
  if (!(options.marker >= 0 && options.marker < options.square)) {
    return Error{ErrorCode::kInvalidInput, "--marker: " + std::to_string(options.marker) + " must be smaller than the square"};
  }
  spec.marker = options.marker;
  if (options.half_window < 0 || options.half_window > 100) {
    return Error{ErrorCode::kInvalidInput, "--half-window: " + std::to_string(options.half_window) + " is not 0 to 100 pixels"};
  }
  spec.half_window = options.half_window;
  const auto kind = calibration::boardKindFromText(options.kind);
  if (!kind) return kind.error();
  spec.kind = *kind;
  return spec;
}

Result<BoardImages> detectBoards(const BoardImageOptions& options) {
  const auto spec = boardSpec(options);
  if (!spec) return spec.error();
  std::vector<Looked> looked(options.images.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < looked.size(); i = next++) looked[i] = lookAt(options.images[i], *spec);
  };
  std::vector<std::thread> threads;
  const std::size_t count = std::min<std::size_t>(std::max(1u, std::thread::hardware_concurrency()), looked.size());
  for (std::size_t t = 1; t < count; ++t) threads.emplace_back(work);
  work();
  for (auto& thread : threads) thread.join();
  BoardImages out;
  for (auto& one : looked) {
    if (one.error) return *one.error;
    if (out.width == 0) {
      out.width = one.size.width;
      out.height = one.size.height;
    } else if (one.size != cv::Size(out.width, out.height)) {
      return Error{ErrorCode::kInvalidInput, one.image.path + ": is " + sizeText(one.size) + " pixels but " +
                                                 options.images.front() + " is " + sizeText({out.width, out.height}) +
                                                 "; a calibration needs pictures of one size from one camera"};
    }
    out.images.push_back(std::move(one.image));
  }
  if (!out.images.empty()) addHint(*spec, &out);
  return out;
}

}  // namespace longarm::app
