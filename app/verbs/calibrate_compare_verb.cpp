// calibrate compare
#include "app/verbs/calibrate_verbs.h"
#include "calibration/intrinsics/compare_cameras.h"
#include "core/text.h"

namespace longarm::app {
namespace {

struct Options {
  std::vector<std::string> files;
  double depth = 1;
  std::string zoom;
  bool poses = false;
};

nlohmann::json mapJson(const calibration::CameraComparison& comparison) {
  nlohmann::json out = nlohmann::json::array();
  for (const auto& d : comparison.map) {
    out.push_back({{"u", d.pixel.x()}, {"v", d.pixel.y()}, {"du_px", d.difference_px.x()}, {"dv_px", d.difference_px.y()},
                   {"difference_px", d.difference_px.norm()}, {"difference_mm", 1e3 * d.miss_m}, {"after_turn_px", d.after_turn_px}});
  }
  return out;
}

Result<Answer> run(const Options& options) {
  std::optional<double> zoom;
  if (!options.zoom.empty()) {
    zoom = parseNumber(options.zoom);
    if (!zoom) return Error{ErrorCode::kInvalidInput, "--zoom: \"" + options.zoom.substr(0, 40) + "\" is not a number from 0 to 1"};
  }
  const auto a = vision::readCameraFile(options.files[0], zoom), b = vision::readCameraFile(options.files[1], zoom);
  if (!a) return a.error();
  if (!b) return b.error();
  const auto comparison = calibration::compareCameras(*a, *b, options.depth, options.poses);
  if (!comparison) return Error{comparison.error().code, options.files[0] + " and " + options.files[1] + ": " + comparison.error().message};
  const auto& c = *comparison;
  nlohmann::json json = {{"rms_px", c.rms_px}, {"max_px", c.max_px}, {"max_mm", c.max_mm}, {"depth", c.depth_m}, {"after_turn_rms_px", c.after_turn_rms_px},
                         {"turn_rotvec", {c.turn.x(), c.turn.y(), c.turn.z()}}, {"map", mapJson(c)}, {"columns", c.columns}, {"rows", c.rows}};
  if (c.sigmas) json["sigmas"] = *c.sigmas;
  const std::string table = "difference " + formatFixed(c.rms_px, 3) + " px rms, " + formatFixed(c.max_px, 3) + " px at most: " + formatFixed(c.max_mm, 2) +
                            " mm at " + formatFixed(c.depth_m, 2) + " m\nof which a turn by " + formatFixed(c.turn.norm() * 180 / 3.14159265358979323846, 3) +
                            " degrees leaves " + formatFixed(c.after_turn_rms_px, 3) + " px rms\n" +
                            (c.sigmas ? "parameters differ by " + formatFixed(*c.sigmas, 2) + " sigma rms\n" : "");
  return Answer{json, table, kExitDone};
}

}  // namespace

void addCompareVerb(Cli& cli, CLI::App& calibrate) {
  cli.addVerb<Options>(
      calibrate, "compare", "How two calibrations of one camera differ, in pixels and in millimetres at a working depth",
      "longarm calibrate compare before.yaml after.yaml --depth 1.5 --json",
      [](CLI::App& verb, Options& options) {
        verb.add_option("files", options.files, "The two camera files")->required()->expected(2);
        verb.add_option("--depth", options.depth, "Working depth [m]");
        verb.add_option("--zoom", options.zoom, "Setting at which zoom files are compared, 0 to 1");
        verb.add_flag("--poses", options.poses, "Compare the mounted cameras, poses included");
      },
      run);
}

}  // namespace longarm::app
