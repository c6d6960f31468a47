// calibrate stereo
#include <algorithm>

#include "app/verbs/board_images.h"
#include "app/verbs/calibrate_verbs.h"
#include "calibration/intrinsics/picture_pairs.h"
#include "calibration/intrinsics/stereo_pair.h"
#include "core/text.h"

namespace longarm::app {
namespace {

using calibration::BoardPair;
using calibration::StereoResult;

struct Options {
  BoardImageOptions board;
  std::string left, right, left_out, right_out;
  bool refine = false;
};

bool isCameraFile(const std::string& path) {
  for (const char* ending : {".yaml", ".yml", ".xml"}) {
    const std::string e = ending;
    if (path.size() > e.size() && path.compare(path.size() - e.size(), e.size(), e) == 0) return true;
  }
  return false;
}

// Camera files may stand before the pictures instead of after --left and --right.
Status sortArguments(Options* options) {
  auto& images = options->board.images;
  for (std::string* camera : {&options->left, &options->right}) {
    if (!camera->empty()) continue;
    if (images.empty() || !isCameraFile(images.front())) {
      return {ErrorCode::kInvalidInput, std::string(camera == &options->left ? "--left" : "--right") +
                                            ": give the camera file of that side, by the option or before the pictures"};
    }
    *camera = images.front();
    images.erase(images.begin());
  }
  return {};
}

// The board's corners on both sides of each pair; those without go to `failed`.
struct Input {
  std::vector<BoardPair> pairs;
  nlohmann::json failed = nlohmann::json::array();
};

Result<BoardImages> detectSide(const Options& options, const std::vector<std::string>& images, const vision::CameraModel& camera, const std::string& file) {
  BoardImageOptions side = options.board;
  side.images = images;
  auto found = detectBoards(side);
  if (found && camera.width > 0 && (found->width != camera.width || found->height != camera.height)) {
    return Error{ErrorCode::kInvalidInput, images.front() + ": is " + std::to_string(found->width) + " x " + std::to_string(found->height) + " pixels but " +
                                               file + " is for " + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                                               "; use the camera file of these pictures"};
  }
  return found;
}

Result<Input> readPairs(const Options& options, const vision::CameraFile& left, const vision::CameraFile& right) {
  const auto& images = options.board.images;
  std::vector<std::string> lefts, rights;
  const auto index = calibration::pairPictures(images);
  if (!index) return index.error();
  for (const auto& [left_picture, right_picture] : *index) {
    lefts.push_back(images[left_picture]);
    rights.push_back(images[right_picture]);
  }
  const auto l = detectSide(options, lefts, left.camera, options.left), r = detectSide(options, rights, right.camera, options.right);
  if (!l) return l.error();
  if (!r) return r.error();
  Input input;
  for (std::size_t k = 0; k < lefts.size(); ++k) {
    if (l->images[k].view && r->images[k].view) {
      input.pairs.push_back({*l->images[k].view, *r->images[k].view});
    } else {
      const auto& missing = l->images[k].view ? r->images[k] : l->images[k];
      input.failed.push_back({{"left", lefts[k]}, {"right", rights[k]}, {"rms_px", nullptr}, {"used", false}, {"why", missing.path + ": " + missing.why}});
    }
  }
  return input;
}

nlohmann::json pairsJson(const Input& input, const StereoResult* result) {
  nlohmann::json out = input.failed;
  if (result != nullptr) {
    for (const auto& pair : result->pairs) {
      out.push_back({{"left", pair.left}, {"right", pair.right}, {"rms_px", pair.rms_px < 0 ? nlohmann::json(nullptr) : nlohmann::json(pair.rms_px)},
                     {"used", pair.used}, {"why", pair.why}});
    }
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a["left"] < b["left"]; });
  return out;
}

Status saveCameras(const Options& options, const vision::CameraFile& left, const vision::CameraFile& right, const StereoResult& result) {
  vision::CameraFile l = left, r = right;
  l.camera = result.left;
  r.camera = result.right;
  const Pose X_parent_left = left.pose ? left.pose->pose : Pose::Identity();
  const std::string parent = left.pose ? left.pose->parent : "left_camera";
  l.pose = PoseInParent{parent, X_parent_left};
  r.pose = PoseInParent{parent, X_parent_left * result.X_LR};
  if (options.refine) {
    l.covariance = Eigen::MatrixXd(result.left_covariance);
    r.covariance = Eigen::MatrixXd(result.right_covariance);
  } else if (r.covariance) {
    r.covariance = Eigen::MatrixXd(r.covariance->topLeftCorner<10, 10>());
  }
  if (auto status = saveCamera(options.left_out, l); !status) return status;
  return saveCamera(options.right_out, r);
}

Result<Answer> answerOf(const Options& options, const Input& input, const vision::CameraFile& left, const vision::CameraFile& right, const StereoResult& result) {
  if (auto status = saveCameras(options, left, right, result); !status) return status.error();
  nlohmann::json json = {{"pose", poseJson({"left_camera", result.X_LR})}, {"sigma", sigmaListJson(result.covariance)},
                         {"covariance", matrixRowsJson(result.covariance)}, {"rms_px", result.rms_px}, {"sigma_px", result.sigma_px},
                         {"iterations", result.iterations}, {"per_pair", pairsJson(input, &result)}, {"warnings", result.warnings}};
  if (options.refine) {
    json["left"] = vision::toJson({result.left, {}, Eigen::MatrixXd(result.left_covariance)});
    json["right"] = vision::toJson({result.right, {}, Eigen::MatrixXd(result.right_covariance)});
  }
  const Eigen::Vector3d t = 1e3 * result.X_LR.translation();
  std::vector<std::vector<std::string>> rows = {{"left", "right", "rms px", "used", "why"}};
  for (const auto& pair : json["per_pair"]) {
    rows.push_back({pair["left"].get<std::string>(), pair["right"].get<std::string>(), pair["rms_px"].is_number() ? formatFixed(pair["rms_px"].get<double>(), 3) : "-",
                    pair["used"].get<bool>() ? "yes" : "no", pair["why"].get<std::string>()});
  }
  const std::string table = tableText(rows) + "\nright in left: " + formatFixed(t.x(), 2) + " " + formatFixed(t.y(), 2) + " " + formatFixed(t.z(), 2) +
                            " mm, baseline " + formatFixed(t.norm(), 2) + " mm, rms " + formatFixed(result.rms_px, 4) + " px\n" + warningLines(result.warnings);
  return Answer{json, table, kExitDone};
}

Result<Answer> run(const Options& given) {
  Options options = given;
  if (auto status = sortArguments(&options); !status) return status.error();
  const auto left = vision::readCameraFile(options.left), right = vision::readCameraFile(options.right);
  if (!left) return left.error();
  if (!right) return right.error();
  const auto input = readPairs(options, *left, *right);
  if (!input) return input.error();
  calibration::StereoOptions how;
  how.refine = options.refine;
  const auto result = calibration::calibrateStereo(input->pairs, *left, *right, how);
  if (!result) return noSolution({{"per_pair", pairsJson(*input, nullptr)}}, toString(result.error().code), result.error().message);
  return answerOf(options, *input, *left, *right, *result);
}

}  // namespace

void addStereoVerb(Cli& cli, CLI::App& calibrate) {
  cli.addVerb<Options>(
      calibrate, "stereo", "Pose of the right camera in the left one, from pairs of board pictures",
      "longarm calibrate stereo left.yaml right.yaml --board 9x6 --square 0.025 left01.jpg right01.jpg left02.jpg right02.jpg --json",
      [](CLI::App& verb, Options& options) {
        verb.add_option("--left", options.left, "Camera file of the left camera (or the first file among the pictures)");
        verb.add_option("--right", options.right, "Camera file of the right camera (or the second file)");
        addBoardOptions(verb, options.board);
        verb.add_flag("--refine", options.refine, "Refine the intrinsics of both cameras too");
        verb.add_option("--left-out", options.left_out, "Camera file to write for the left camera, with its pose");
        verb.add_option("--right-out", options.right_out, "Camera file to write for the right camera, with its pose");
      },
      run);
}

}  // namespace longarm::app
