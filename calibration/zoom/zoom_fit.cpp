#include "calibration/zoom/zoom_fit.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include <Eigen/Dense>

#include "calibration/fixture/calibrate_fixture.h"
#include "calibration/intrinsics/corners_file.h"
#include "calibration/solve/lens_parameters.h"
#include "core/text.h"

namespace longarm::calibration {
namespace {

namespace fs = std::filesystem;

constexpr double kWorstRefit = 1;    // [px]

Error bad(const std::string& what) { return {ErrorCode::kInvalidInput, what}; }

bool isNumberPart(char c) { return (c >= '0' && c <= '9') || c == '.'; }

// The last number in a name: "zcam_0.25" -> 0.25.
std::optional<double> lastNumber(const std::string& stem) {
  std::size_t end = stem.size();
  while (end > 0 && !isNumberPart(stem[end - 1])) --end;
  std::size_t begin = end;
  while (begin > 0 && isNumberPart(stem[begin - 1])) --begin;
  return end > begin ? parseNumber(stem.substr(begin, end - begin)) : std::nullopt;
}

Result<vision::CameraFile> readSource(const fs::path& path) {
  if (path.extension() != ".csv") return vision::readCameraFile(path.string());
  const auto points = readFixturePoints(path.string());
  if (!points) return points.error();
  const auto fixture = calibrateFixture(*points, 0, 0);
  if (!fixture) return Error{fixture.error().code, path.string() + ": " + fixture.error().message};
  return vision::CameraFile{fixture->camera, PoseInParent{"mount", fixture->X_WC}, {}};
}

vision::ZoomNode nodeOf(const vision::CameraFile& file, double zoom) {
  const auto& c = file.camera;
  vision::ZoomNode node;
  node.zoom = zoom;
  node.interior = {c.fx, c.fy, c.skew, c.cx, c.cy, c.distortion[0], c.distortion[1], c.distortion[2], c.distortion[3]};
  if (file.pose) {
    const Pose X_camera_mount = file.pose->pose.inverse();
    const Eigen::Vector3d theta = logSO3(X_camera_mount.linear());
    for (std::size_t i = 0; i < 3; ++i) {
      node.exterior[i] = X_camera_mount.translation()[static_cast<Eigen::Index>(i)];
      node.exterior[3 + i] = theta[static_cast<Eigen::Index>(i)];
    }
  }
  return node;
}

std::vector<fs::path> sourcesIn(const std::string& folder) {
  std::vector<fs::path> out;
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(folder, ec)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".yaml" || extension == ".yml" || extension == ".xml" || extension == ".csv") out.push_back(entry.path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

Status addSource(const fs::path& path, ZoomFit* fit) {
  const auto zoom = lastNumber(path.stem().string());
  if (!zoom || !(*zoom >= 0 && *zoom <= 1)) {
    return bad(path.string() + ": its name holds no zoom setting from 0 to 1; name it such as zcam_0.25" + path.extension().string());
  }
  for (const auto& source : fit->sources) {
    if (source.zoom == *zoom) return bad(path.string() + ": zoom " + formatNumber(*zoom) + " is also that of " + source.file + "; remove one");
  }
  auto file = readSource(path);
  if (!file) return bad(file.error().message);
  ZoomSource source{path.string(), *zoom, 0};
  if (file->camera.distortion[4] != 0) {
    file->camera = withoutK3(file->camera, &source.refit_px);
    if (source.refit_px > kWorstRefit) {
      return bad(path.string() + ": its k3 cannot be expressed by k1 k2 p1 p2, which is all that the XML holds (" +
                 formatFixed(source.refit_px, 2) + " px error, 1 px allowed); calibrate it with --distortion 4");
    }
    fit->warnings.push_back(path.string() + ": k3 was refitted to k1 k2 p1 p2, with at most " + formatFixed(source.refit_px, 3) + " px error");
  }
  if (!file->pose) fit->warnings.push_back(path.string() + ": has no pose; the camera is taken to stand in the mount's frame");
  fit->camera.nodes.push_back(nodeOf(*file, *zoom));
  if (fit->camera.name.empty()) fit->camera.name = file->camera.name;
  fit->sources.push_back(source);
  return {};
}

}  // namespace

vision::CameraModel withoutK3(const vision::CameraModel& camera, double* error_px) {
  const double width = camera.width > 0 ? camera.width : 2 * camera.cx, height = camera.height > 0 ? camera.height : 2 * camera.cy;
  vision::CameraModel out = camera;
  out.distortion[4] = 0;
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i <= 20; ++i) {
    for (int j = 0; j <= 16; ++j) {
      const auto n = camera.normalisedOfPixel({width * i / 20, height * j / 16});
      if (n) places.push_back(*n);
    }
  }
  // Linear in k1 k2 p1 p2 for fixed places.
  Eigen::MatrixXd A(2 * places.size(), 4);
  Eigen::VectorXd b(A.rows());
  out.distortion = {};
  for (std::size_t k = 0; k < places.size(); ++k) {
    LensProjection at;
    projectWithDerivatives(out, places[k].homogeneous(), &at);
    const auto row = 2 * static_cast<Eigen::Index>(k);
    A.middleRows<2>(row) = at.d_lens.middleCols<4>(kK1);
    b.segment<2>(row) = camera.pixelOfNormalised(places[k]) - at.pixel;
  }
  const Eigen::VectorXd x = A.colPivHouseholderQr().solve(b);
  for (std::size_t i = 0; i < 4; ++i) out.distortion[i] = x[static_cast<Eigen::Index>(i)];
  *error_px = 0;
  for (const auto& n : places) *error_px = std::max(*error_px, (out.pixelOfNormalised(n) - camera.pixelOfNormalised(n)).norm());
  return out;
}

Result<ZoomFit> fitZoom(const std::string& folder) {
  std::error_code ec;
  if (!fs::is_directory(folder, ec)) return Error{ErrorCode::kNotFound, folder + ": no such folder"};
  ZoomFit fit;
  for (const auto& path : sourcesIn(folder)) {
    if (auto status = addSource(path, &fit); !status) return status.error();
  }
  if (fit.camera.nodes.size() < 2) {
    return bad(folder + ": holds " + std::to_string(fit.camera.nodes.size()) +
               " calibrated settings; at least 2 are needed (camera files or fixture points named such as zcam_0.25.yaml)");
  }
  if (fit.camera.name.empty()) fit.camera.name = "zcam";
  std::sort(fit.camera.nodes.begin(), fit.camera.nodes.end(),
            [](const vision::ZoomNode& a, const vision::ZoomNode& b) { return a.zoom < b.zoom; });
  for (std::size_t k = 1; k < fit.camera.nodes.size(); ++k) {
    if (fit.camera.nodes[k].interior[0] <= fit.camera.nodes[k - 1].interior[0]) {
      fit.warnings.push_back("the focal length does not grow from zoom " + formatNumber(fit.camera.nodes[k - 1].zoom) + " to " +
                             formatNumber(fit.camera.nodes[k].zoom) + "; check which file belongs to which setting");
    }
  }
  return fit;
}

}  // namespace longarm::calibration
