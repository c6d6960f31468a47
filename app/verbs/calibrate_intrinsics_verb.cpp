// calibrate intrinsics
#include <algorithm>

#include "app/verbs/board_images.h"
#include "app/verbs/calibrate_verbs.h"
#include "calibration/intrinsics/calibrate_intrinsics.h"
#include "calibration/intrinsics/corners_file.h"
#include "calibration/intrinsics/coverage.h"
#include "calibration/intrinsics/next_view.h"
#include "core/text.h"

namespace longarm::app {
namespace {

using calibration::BoardView;
using calibration::IntrinsicsResult;

struct Options {
  BoardImageOptions board;
  std::string corners, size, out, name;
  bool skew = false, robust = false;
  int distortion = -1;
};

// What came of looking for corners.
struct Input {
  std::vector<BoardView> views;                 // those with corners
  std::vector<std::string> failed, why;         // pictures without
  int width = 0, height = 0;
};

Result<Input> cornersInput(const Options& options) {
  if (!options.board.images.empty()) {
    return Error{ErrorCode::kInvalidInput, "--corners: pictures were given too (" + options.board.images.front() + "); give one of them"};
  }
  if (options.size.empty()) return Error{ErrorCode::kInvalidInput, "--corners needs --size WIDTHxHEIGHT, the size of the pictures"};
  const auto size = sizeOption("--size", options.size, 1, 65536);
  if (!size) return size.error();
  auto views = calibration::readCornersFile(options.corners);
  if (!views) return views.error();
  return Input{std::move(*views), {}, {}, size->first, size->second};
}

Result<Input> imagesInput(const Options& options) {
  if (options.board.images.empty()) {
    return Error{ErrorCode::kInvalidInput, "give pictures of the board, or --corners with --size"};
  }
  const auto found = detectBoards(options.board);
  if (!found) return found.error();
  Input input;
  input.width = found->width;
  input.height = found->height;
  for (const auto& image : found->images) {
    if (image.view) {
      input.views.push_back(*image.view);
    } else {
      input.failed.push_back(image.path);
      input.why.push_back(image.why);
    }
  }
  return input;
}

nlohmann::json viewJson(const calibration::ViewReport& view) {
  nlohmann::json out = {{"image", view.name}, {"rms_px", view.rms_px}, {"used", view.used}, {"why", view.why},
                        {"corners", view.corners}, {"outliers", view.outliers}};
  if (view.rms_px < 0) out["rms_px"] = nullptr;
  out["pose"] = poseJson({"camera", view.X_CK});
  return out;
}

nlohmann::json perViewJson(const Input& input, const IntrinsicsResult* result) {
  nlohmann::json out = nlohmann::json::array();
  if (result != nullptr) {
    for (const auto& view : result->views) out.push_back(viewJson(view));
  }
  for (std::size_t i = 0; i < input.failed.size(); ++i) {
    out.push_back({{"image", input.failed[i]}, {"rms_px", nullptr}, {"used", false}, {"why", input.why[i]}});
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a["image"] < b["image"]; });
  return out;
}

nlohmann::json nextViewJson(const Input& input, const IntrinsicsResult& result) {
  const auto next = calibration::nextView(input.views, result);
  if (!next) return nullptr;
  nlohmann::json outline = nlohmann::json::array();
  for (const auto& p : next->outline_px) outline.push_back({p.x(), p.y()});
  return {{"pose", poseJson({"camera", next->X_CK})}, {"gain_bits", next->gain_bits}, {"outline_px", outline},
          {"advice", next->words}};
}

std::string viewsTable(const nlohmann::json& per_view) {
  std::vector<std::vector<std::string>> rows = {{"view", "rms px", "used", "why"}};
  for (const auto& view : per_view) {
    rows.push_back({view["image"].get<std::string>(),
                    view["rms_px"].is_number() ? formatFixed(view["rms_px"].get<double>(), 3) : "-",
                    view["used"].get<bool>() ? "yes" : "no", view["why"].get<std::string>()});
  }
  return tableText(rows);
}

vision::CameraFile fileOf(const IntrinsicsResult& result, const std::string& name) {
  vision::CameraFile file{result.camera, {}, Eigen::MatrixXd(result.covariance)};
  file.camera.name = name;
  return file;
}

Result<Answer> answerOf(const Options& options, const Input& input, IntrinsicsResult result) {
  const vision::CameraFile file = fileOf(result, options.name);
  if (auto status = saveCamera(options.out, file); !status) return status.error();
  const auto coverage = calibration::coverageOf(input.views, result);
  if (!input.failed.empty()) {
    result.warnings.push_back(std::to_string(input.failed.size()) + " pictures without a board; see why in per_view");
  }
  nlohmann::json json = {{"rms_px", result.rms_px},
                         {"sigma_px", result.sigma_px},
                         {"camera", vision::toJson(file)},
                         {"per_view", perViewJson(input, &result)},
                         {"sigma", lensSigmaJson(result.covariance, result.estimated)},
                         {"covariance", matrixRowsJson(result.covariance)},
                         {"coverage", coverage.picture},
                         {"tilt_range_deg", {coverage.tilt_x_deg, coverage.tilt_y_deg}},
                         {"next_view", nextViewJson(input, result)},
                         {"iterations", result.iterations},
                         {"warnings", result.warnings}};
  const std::string table = viewsTable(json["per_view"]) + "\n" + lensTable(result.camera, result.covariance, result.estimated) +
                            "\nrms " + formatFixed(result.rms_px, 4) + " px per component; corners cover " +
                            formatFixed(100 * coverage.picture, 0) + " % of the picture\n" +
                            (json["next_view"].is_object() ? "next: " + json["next_view"]["advice"].get<std::string>() + "\n" : "") +
                            warningLines(result.warnings);
  return Answer{json, table, kExitDone};
}

Result<Answer> run(const Options& options) {
  if (auto status = checkDistortion(options.distortion, true); !status) return status.error();
  auto input = options.corners.empty() ? imagesInput(options) : cornersInput(options);
  if (!input) return input.error();
  if (input->views.empty()) {
    const std::string reason = input->why.empty() ? options.corners + ": holds no corners; expected rows view,x,y,z,u,v"
                                                  : input->failed.front() + ": " + input->why.front();
    return noSolution({{"per_view", perViewJson(*input, nullptr)}}, "no_solution", reason);
  }
  calibration::IntrinsicsOptions how;
  if (options.distortion >= 0) how.lens.distortion = options.distortion;
  if (options.skew) how.lens.skew = true;
  how.robust = options.corners.empty() || options.robust;
  auto result = calibration::calibrateIntrinsics(input->views, input->width, input->height, how);
  if (!result) {
    const std::string where = options.corners.empty() ? std::string() : options.corners + ": ";
    if (result.error().code == ErrorCode::kInvalidInput) return Error{result.error().code, where + result.error().message};
    return noSolution({{"per_view", perViewJson(*input, nullptr)}}, toString(result.error().code), where + result.error().message);
  }
  return answerOf(options, *input, std::move(*result));
}

}  // namespace

void addIntrinsicsVerb(Cli& cli, CLI::App& calibrate) {
  cli.addVerb<Options>(
      calibrate, "intrinsics", "Lens and focal lengths from pictures of a board, or from corners found elsewhere",
      "longarm calibrate intrinsics --board 9x6 --square 0.025 left*.jpg --out left.yaml --json",
      [](CLI::App& verb, Options& options) {
        addBoardOptions(verb, options.board);
        verb.add_option("--corners", options.corners, "Corners found elsewhere: view,x,y,z,u,v (metres, pixels)");
        verb.add_option("--size", options.size, "Size of the pictures, WIDTHxHEIGHT, with --corners");
        verb.add_option("--distortion", options.distortion,
                        "Estimate exactly 0, 2, 4 or 5 of k1 k2 p1 p2 k3; left out: chosen by significance");
        verb.add_flag("--skew", options.skew, "Estimate the skew too");
        verb.add_flag("--robust", options.robust, "Leave out views and corners that do not belong (always so with pictures)");
        verb.add_option("--name", options.name, "Name of the camera in the file");
        verb.add_option("--out", options.out, "Camera file to write (.yaml ROS, .yml or .xml OpenCV)");
      },
      run);
}

}  // namespace longarm::app
