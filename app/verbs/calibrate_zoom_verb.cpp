// calibrate zoom
#include "app/verbs/calibrate_verbs.h"
#include "calibration/zoom/zoom_fit.h"
#include "calibration/zoom/zoom_quality.h"
#include "core/text.h"
#include "vision/camera/zoom_camera.h"

namespace longarm::app {
namespace {

using calibration::ZoomMiss;

struct Options {
  std::string xml, at, fit, out, camera, rewrite;
  bool check = false;
};

Result<const vision::ZoomCamera*> chosen(const vision::ZoomFile& file, const std::string& name, const std::string& path) {
  if (name.empty()) return &file.cameras.front();
  std::string names;
  for (const auto& camera : file.cameras) {
    if (camera.name == name) return &camera;
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  return Error{ErrorCode::kInvalidInput, "--camera: " + path + " has no camera \"" + name + "\"; it has " + names};
}

nlohmann::json extrinsicJson(const vision::ZoomNode& node) {
  Pose C_ext = Pose::Identity();
  C_ext.linear() = expSO3({node.exterior[3], node.exterior[4], node.exterior[5]});
  C_ext.translation() << node.exterior[0], node.exterior[1], node.exterior[2];
  nlohmann::json out = poseJson({"camera", C_ext});
  out["rotvec"] = {node.exterior[3], node.exterior[4], node.exterior[5]};
  return out;
}

nlohmann::json missesJson(const std::vector<ZoomMiss>& misses) {
  nlohmann::json out = nlohmann::json::array();
  for (const auto& m : misses) {
    out.push_back({{"zoom", m.zoom}, {"error_px", m.error_px}, {"focal_error", m.focal_error}, {"boresight_error_px", {m.boresight_px.x(), m.boresight_px.y()}},
                   {"nominal", m.nominal}, {"light", calibration::toString(m.light)}});
  }
  return out;
}

std::string missesTable(const std::vector<ZoomMiss>& misses) {
  std::vector<std::vector<std::string>> rows = {{"zoom", "focal error %", "boresight px", "picture px", "light", "note"}};
  for (const auto& m : misses) {
    rows.push_back({formatNumber(m.zoom), formatFixed(100 * m.focal_error, 2), formatFixed(m.boresight_px.norm(), 2), formatFixed(m.error_px, 2),
                    calibration::toString(m.light), m.nominal ? "nominal, not measured" : ""});
  }
  return tableText(rows);
}

// Leave-one-out and what it advises, into an answer.
void addQuality(const vision::ZoomCamera& camera, nlohmann::json* json, std::string* table) {
  const auto misses = calibration::leaveOneOut(camera);
  const auto advised = calibration::advisedSettings(camera, misses);
  (*json)["leave_one_out"] = missesJson(misses);
  (*json)["advised_zoom"] = advised;
  const auto law = calibration::boresightLaw(camera);
  if (law.nodes >= 3) {
    (*json)["boresight"] = {{"principal_point_px", {law.principal_point.x(), law.principal_point.y()}}, {"slope", {law.slope.x(), law.slope.y()}},
                            {"residual_px", {law.residual_px.x(), law.residual_px.y()}}, {"nodes", law.nodes}};
  }
  *table += missesTable(misses);
  if (!advised.empty()) {
    *table += "calibrate also at zoom";
    for (const double z : advised) *table += " " + formatNumber(z);
    *table += "\n";
  }
}

Result<double> zoomOption(const std::string& text) {
  const auto zoom = parseNumber(text);
  if (zoom) return *zoom;
  return Error{ErrorCode::kInvalidInput, "--at: \"" + text.substr(0, 40) + "\" is not a number from 0 to 1"};
}

Result<Answer> runAt(const Options& options, const vision::ZoomFile& file, const vision::ZoomCamera& camera) {
  const auto zoom = zoomOption(options.at);
  if (!zoom) return zoom.error();
  const auto node = vision::zoomAt(camera, *zoom);
  if (!node) return Error{node.error().code, options.xml + ": " + node.error().message};
  const auto at = vision::cameraFileOf(camera, *node);
  if (!at) return Error{at.error().code, options.xml + ": " + at.error().message};
  if (auto status = saveCamera(options.out, *at); !status) return status.error();
  nlohmann::json json = {{"zoom", *zoom}, {"camera", vision::toJson(*at)}, {"extrinsic", extrinsicJson(*node)}, {"warnings", file.warnings}};
  calibration::LensMask all = calibration::LensMask::of(true, 4);
  std::string table = lensTable(at->camera, Eigen::MatrixXd::Zero(calibration::kLensParameters, calibration::kLensParameters), all);
  if (options.check) addQuality(camera, &json, &table);
  return Answer{json, table + warningLines(file.warnings), kExitDone};
}

Result<Answer> runCheck(const vision::ZoomFile& file, const vision::ZoomCamera& camera) {
  nlohmann::json nodes = nlohmann::json::array();
  for (const auto& node : camera.nodes) {
    nodes.push_back({{"zoom", node.zoom}, {"interior", node.interior}, {"exterior", node.exterior}, {"nominal", vision::isNominal(node)}});
  }
  nlohmann::json json = {{"camera_name", camera.name}, {"nodes", nodes}, {"warnings", file.warnings}};
  std::string table;
  addQuality(camera, &json, &table);
  return Answer{json, table + warningLines(file.warnings), kExitDone};
}

Result<Answer> runFit(const Options& options) {
  auto fit = calibration::fitZoom(options.fit);
  if (!fit) return fit.error();
  vision::ZoomFile file;
  file.headers = {{"SR_filename", options.out.empty() ? "zoom.xml" : options.out},
                  {"SR_comment", "SR_cam_int: fx fy fxy u0 v0 k1 k2 p1 p2. SR_cam_ext: dx dy dz in metres and a rotation vector in radians, mapping the mount's frame into the camera's."}};
  if (!options.camera.empty()) fit->camera.name = options.camera;
  file.cameras = {fit->camera};
  // Read back what is written: the warnings are those any reader gives.
  const auto checked = vision::parseZoomFile(vision::zoomFileText(file));
  if (!checked) return Error{checked.error().code, options.fit + ": " + checked.error().message};
  if (!options.out.empty()) {
    if (auto status = vision::writeZoomFile(options.out, file); !status) return status.error();
  }
  std::vector<std::string> warnings = fit->warnings;
  warnings.insert(warnings.end(), checked->warnings.begin(), checked->warnings.end());
  nlohmann::json sources = nlohmann::json::array();
  for (const auto& source : fit->sources) sources.push_back({{"file", source.file}, {"zoom", source.zoom}, {"refit_px", source.refit_px}});
  nlohmann::json json = {{"camera_name", fit->camera.name}, {"sources", sources}, {"out", options.out}, {"warnings", warnings}};
  std::string table;
  addQuality(fit->camera, &json, &table);
  return Answer{json, table + warningLines(warnings), kExitDone};
}

Result<Answer> run(const Options& options) {
  if (!options.fit.empty()) {
    if (!options.xml.empty()) return Error{ErrorCode::kInvalidInput, "--fit makes a zoom file, --xml reads one; give one of them"};
    return runFit(options);
  }
  if (options.xml.empty()) return Error{ErrorCode::kInvalidInput, "give --xml FILE with --at ZOOM or --check, or --fit FOLDER with --out FILE"};
  const auto file = vision::readZoomFile(options.xml);
  if (!file) return file.error();
  const auto camera = chosen(*file, options.camera, options.xml);
  if (!camera) return camera.error();
  if (!options.rewrite.empty()) {
    if (auto status = vision::writeZoomFile(options.rewrite, *file); !status) return status.error();
  }
  if (!options.at.empty()) return runAt(options, *file, **camera);
  if (options.check || !options.rewrite.empty()) return runCheck(*file, **camera);
  return Error{ErrorCode::kInvalidInput, "--xml: say what is wanted, --at ZOOM or --check"};
}

}  // namespace

void addZoomVerb(Cli& cli, CLI::App& calibrate) {
  cli.addVerb<Options>(
      calibrate, "zoom", "Zoom cameras: one setting of a table, a table from single calibrations, or how good a table is",
      "longarm calibrate zoom --xml zoom_cam.xml --at 0.33 --json",
      [](CLI::App& verb, Options& options) {
        verb.add_option("--xml", options.xml, "Zoom camera file (SR_world)");
        verb.add_option("--at", options.at, "Setting wanted, 0 to 1, inside the calibrated ones");
        verb.add_flag("--check", options.check, "Leave-one-out errors of the nodes");
        verb.add_option("--fit", options.fit, "Folder of calibrations at single settings (zcam_0.25.yaml, or points zcam_0.25.csv)");
        verb.add_option("--camera", options.camera, "Which camera of the file; with --fit: its name");
        verb.add_option("--rewrite", options.rewrite, "Write the table read with --xml again, in canonical form");
        verb.add_option("--out", options.out, "With --fit: zoom file to write; with --at: camera file");
      },
      run);
}

}  // namespace longarm::app
