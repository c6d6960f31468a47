// calibrate: the group and what its verbs share.
#include "app/verbs/calibrate_verbs.h"

#include <cmath>

#include "core/text.h"

namespace longarm::app {

using calibration::kLensParameters;

nlohmann::json lensSigmaJson(const Eigen::MatrixXd& covariance, const calibration::LensMask& estimated) {
  nlohmann::json out = nlohmann::json::object();
  for (const int i : estimated.indices()) out[calibration::lensParameterName(i)] = std::sqrt(std::max(0.0, covariance(i, i)));
  return out;
}

nlohmann::json matrixRowsJson(const Eigen::MatrixXd& matrix) {
  nlohmann::json out = nlohmann::json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) out.push_back(matrix(i, j));
  }
  return out;
}

nlohmann::json sigmaListJson(const Eigen::MatrixXd& covariance) {
  nlohmann::json out = nlohmann::json::array();
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) out.push_back(std::sqrt(std::max(0.0, covariance(i, i))));
  return out;
}

std::string lensTable(const vision::CameraModel& camera, const Eigen::MatrixXd& covariance,
                      const calibration::LensMask& estimated) {
  std::vector<std::vector<std::string>> rows = {{"parameter", "value", "+- (1 sigma)"}};
  const auto values = calibration::lensVector(camera);
  for (const int i : estimated.indices()) {
    const int decimals = i < calibration::kK1 ? 3 : 6;
    rows.push_back({calibration::lensParameterName(i), formatFixed(values[i], decimals),
                    formatFixed(std::sqrt(std::max(0.0, covariance(i, i))), decimals)});
  }
  return tableText(rows);
}

std::string warningLines(const std::vector<std::string>& warnings) {
  std::string out;
  for (const auto& warning : warnings) out += "warning: " + warning + "\n";
  return out;
}

Result<std::pair<int, int>> sizeOption(const std::string& option, const std::string& text, int low, int high) {
  const auto cross = text.find_first_of("xX");
  const auto first = cross == std::string::npos ? std::nullopt : parseInteger(text.substr(0, cross));
  const auto second = cross == std::string::npos ? std::nullopt : parseInteger(text.substr(cross + 1));
  if (first && second && *first >= low && *first <= high && *second >= low && *second <= high) {
    return std::pair<int, int>(static_cast<int>(*first), static_cast<int>(*second));
  }
  return Error{ErrorCode::kInvalidInput, option + ": \"" + text.substr(0, 40) + "\" is not two whole numbers from " +
                                             std::to_string(low) + " to " + std::to_string(high) +
                                             " with an x between them"};
}

Status checkDistortion(int value, bool k3) {
  if (value == -1 || value == 0 || value == 2 || value == 4 || (k3 && value == 5)) return {};
  return {ErrorCode::kInvalidInput, "--distortion: " + std::to_string(value) + " is not a number of coefficients that can be "
                                    "estimated; expected 0, 2 (k1 k2)" + (k3 ? ", 4 (and p1 p2) or 5 (and k3)" : " or 4 (and p1 p2)")};
}

Status saveCamera(const std::string& path, const vision::CameraFile& file) {
  if (path.empty()) return {};
  return vision::writeCameraFile(path, file);
}

void addCalibrateVerbs(Cli& cli) {
  CLI::App* calibrate = cli.app().add_subcommand("calibrate", "Cameras: intrinsics, fixture, stereo, pose, zoom; compare two");
  calibrate->require_subcommand(1);
  calibrate->footer("Example:\n  longarm calibrate intrinsics --board 9x6 --square 0.025 left*.jpg --out left.yaml");
  addIntrinsicsVerb(cli, *calibrate);
  addFixtureVerb(cli, *calibrate);
  addPoseVerb(cli, *calibrate);
  addStereoVerb(cli, *calibrate);
  addZoomVerb(cli, *calibrate);
  addCompareVerb(cli, *calibrate);
}

}  // namespace longarm::app
