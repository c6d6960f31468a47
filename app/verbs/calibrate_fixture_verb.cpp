// calibrate fixture
#include "app/verbs/calibrate_verbs.h"
#include "calibration/fixture/calibrate_fixture.h"
#include "calibration/intrinsics/corners_file.h"
#include "core/text.h"

namespace longarm::app {
namespace {

struct Options {
  std::string points, size, out, name, frame = "fixture";
  bool skew = false;
  int distortion = -1;
};

nlohmann::json perPointJson(const calibration::BoardView& points, const calibration::FixtureResult& result) {
  nlohmann::json out = nlohmann::json::array();
  for (std::size_t i = 0; i < points.corners.size(); ++i) {
    out.push_back({{"line", points.corners[i].line}, {"residual_px", result.residual_px[i]}, {"used", !result.left_out[i]}});
  }
  return out;
}

Result<Answer> answerOf(const Options& options, const calibration::BoardView& points,
                        const calibration::FixtureResult& result) {
  vision::CameraFile file{result.camera, PoseInParent{options.frame, result.X_WC}, Eigen::MatrixXd(result.covariance)};
  file.camera.name = options.name;
  if (auto status = saveCamera(options.out, file); !status) return status.error();
  nlohmann::json sigma = lensSigmaJson(result.covariance, result.estimated);
  sigma["pose"] = sigmaListJson(result.covariance.bottomRightCorner<6, 6>());
  nlohmann::json json = {{"dlt_rms_px", result.dlt_rms_px},
                         {"rms_px", result.rms_px},
                         {"sigma_px", result.sigma_px},
                         {"camera", vision::toJson(file)},
                         {"sigma", sigma},
                         {"covariance", matrixRowsJson(result.covariance)},
                         {"condition", result.linear.condition},
                         {"depth_ratio", result.linear.depth_ratio},
                         {"iterations", result.iterations},
                         {"per_point", perPointJson(points, result)},
                         {"warnings", result.warnings}};
  const Eigen::Vector3d& at = result.X_WC.translation();
  const std::string table = lensTable(result.camera, result.covariance, result.estimated) + "\ncamera at " +
                            formatFixed(at.x(), 4) + " " + formatFixed(at.y(), 4) + " " + formatFixed(at.z(), 4) + " m in " +
                            options.frame + "\nrms " + formatFixed(result.rms_px, 4) + " px (linear solution " +
                            formatFixed(result.dlt_rms_px, 4) + " px), condition " + formatFixed(result.linear.condition, 1) +
                            "\n" + warningLines(result.warnings);
  return Answer{json, table, kExitDone};
}

Result<Answer> run(const Options& options) {
  if (auto status = checkDistortion(options.distortion, false); !status) return status.error();
  const auto points = calibration::readFixturePoints(options.points);
  if (!points) return points.error();
  std::pair<int, int> size{0, 0};
  if (!options.size.empty()) {
    const auto given = sizeOption("--size", options.size, 1, 65536);
    if (!given) return given.error();
    size = *given;
  }
  calibration::LensChoice lens;
  lens.open_skew = true;
  if (options.distortion >= 0) lens.distortion = options.distortion;
  if (options.skew) lens.skew = true;
  const auto result = calibration::calibrateFixture(*points, size.first, size.second, lens);
  if (!result) return Error{result.error().code, options.points + ": " + result.error().message};
  return answerOf(options, *points, *result);
}

}  // namespace

void addFixtureVerb(Cli& cli, CLI::App& calibrate) {
  cli.addVerb<Options>(
      calibrate, "fixture", "Camera and pose from one picture of points known in 3-D, not in one plane",
      "longarm calibrate fixture --points points.csv --distortion 2 --out camera.yaml --json",
      [](CLI::App& verb, Options& options) {
        verb.add_option("--points", options.points, "Points and their pixels: x,y,z,u,v (metres, pixels)")->required();
        verb.add_option("--distortion", options.distortion,
                        "Estimate exactly 0, 2 or 4 of k1 k2 p1 p2; left out: chosen by significance");
        verb.add_flag("--skew", options.skew, "Estimate the skew too");
        verb.add_option("--size", options.size, "Size of the picture, WIDTHxHEIGHT, for the camera file");
        verb.add_option("--frame", options.frame, "Name of the fixture's frame in the camera file");
        verb.add_option("--name", options.name, "Name of the camera in the file");
        verb.add_option("--out", options.out, "Camera file to write, with pose and covariance");
      },
      run);
}

}  // namespace longarm::app
