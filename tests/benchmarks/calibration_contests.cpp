// Boards, intrinsics and zoom tables against OpenCV and linear interpolation.
#include <cmath>
#include <memory>

#include <benchmark/benchmark.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/intrinsics/board_detector.h"
#include "calibration/intrinsics/calibrate_intrinsics.h"
#include "calibration/zoom/zoom_quality.h"
#include "core/text.h"
#include "tests/benchmarks/gate.h"
#include "tests/calibration/synthetic.h"
#include "tests/support/report_zoom_file.h"
#include "tests/support/test_data.h"
#include "vision/snapshot/image_file.h"

namespace longarm::benchmarks {
namespace {

using calibration::BoardView;
using tests::Random;

// 13 views of 9 x 6 corners with 0.3 px noise, as the photographs that everybody measures with have.
std::vector<BoardView> thirteenViews() {
  Random random(7);
  auto camera = tests::cameraOf(533, 530, 341, 236);
  camera.distortion = {-0.28, 0.09, 0.001, -0.0004, 0};
  std::vector<BoardView> views;
  while (views.size() < 13) {
    BoardView view = tests::picture(camera, tests::boardPose(&random), tests::board(), &random, 0.3);
    bool inside = true;
    for (const auto& c : view.corners) inside = inside && camera.containsPixel(c.pixel, -2);
    if (inside) views.push_back(view);
  }
  return views;
}

struct CvCorners {
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
};

CvCorners forOpenCv(const std::vector<BoardView>& views) {
  CvCorners out;
  for (const auto& view : views) {
    out.points.emplace_back();
    out.pixels.emplace_back();
    for (const auto& c : view.corners) {
      out.points.back().emplace_back(static_cast<float>(c.xyz.x()), static_cast<float>(c.xyz.y()), static_cast<float>(c.xyz.z()));
      out.pixels.back().emplace_back(static_cast<float>(c.pixel.x()), static_cast<float>(c.pixel.y()));
    }
  }
  return out;
}

double byOpenCv(const CvCorners& corners) {
  cv::Mat K, D;
  std::vector<cv::Mat> turns, shifts;
  return cv::calibrateCamera(corners.points, corners.pixels, {640, 480}, K, D, turns, shifts, cv::CALIB_FIX_K3);
}

calibration::IntrinsicsOptions fourCoefficients() {
  calibration::IntrinsicsOptions options;
  options.lens.distortion = 4;
  options.lens.skew = false;
  options.robust = false;
  return options;
}

Contest intrinsicsContest() {
  auto views = std::make_shared<std::vector<BoardView>>(thirteenViews());
  auto corners = std::make_shared<CvCorners>(forOpenCv(*views));
  Contest contest{"intrinsics", "OpenCV calibrateCamera, 13 x 54, without covariance", {}, {}, 5, 20, false, {}};
  contest.ours = [views] { benchmark::DoNotOptimize(calibration::calibrateIntrinsics(*views, 640, 480, fourCoefficients())); };
  contest.theirs = [corners] { benchmark::DoNotOptimize(byOpenCv(*corners)); };
  contest.accuracy = [views, corners] {
    const auto found = calibration::calibrateIntrinsics(*views, 640, 480, fourCoefficients());
    if (!found) return Accuracy{false, found.error().message};
    // OpenCV's figure is of the lengths, ours of the components; its pixels are single precision.
    const double ours = found->rms_px * std::sqrt(2.0), theirs = byOpenCv(*corners);
    return Accuracy{ours <= theirs + 1e-6, "rms " + formatFixed(ours, 6) + " px (peer " + formatFixed(theirs, 6) + ", limit peer + 1e-6); covariance comes with it"};
  };
  return contest;
}

std::vector<cv::Mat> photographs() {
  std::vector<cv::Mat> out;
  for (const int number : {1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14}) {
    const auto image = vision::loadImage(tests::dataFolder() + "/opencv_stereo_chess/left" + (number < 10 ? "0" : "") + std::to_string(number) + ".jpg");
    if (!image) return {};
    cv::Mat grey = *image;
    if (grey.channels() == 3) cv::cvtColor(*image, grey, cv::COLOR_BGR2GRAY);
    out.push_back(grey);
  }
  return out;
}

bool classic(const cv::Mat& grey, int flags) {
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCorners(grey, {9, 6}, corners, flags)) return false;
  cv::cornerSubPix(grey, corners, {5, 5}, {-1, -1}, {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01});
  return true;
}

Accuracy allFound(const std::vector<cv::Mat>& pictures) {
  int found = 0;
  for (const auto& picture : pictures) found += calibration::detectBoardLive(picture, {}, "live").ok() ? 1 : 0;
  return {found == static_cast<int>(pictures.size()), std::to_string(found) + " of " + std::to_string(pictures.size()) + " boards found"};
}

Contest presentContest(const std::shared_ptr<std::vector<cv::Mat>>& pictures) {
  Contest contest{"board_present", "OpenCV findChessboardCorners + cornerSubPix", {}, {}, 1, 2, false, {}};
  contest.ours = [pictures] {
    for (const auto& picture : *pictures) benchmark::DoNotOptimize(calibration::detectBoardLive(picture, {}, "live"));
  };
  contest.theirs = [pictures] {
    for (const auto& picture : *pictures) benchmark::DoNotOptimize(classic(picture, cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE));
  };
  contest.accuracy = [pictures] { return allFound(*pictures); };
  return contest;
}

// The same rooms without the board: its place is filled with the picture's own left edge.
std::shared_ptr<std::vector<cv::Mat>> withoutBoards(const std::vector<cv::Mat>& pictures) {
  auto out = std::make_shared<std::vector<cv::Mat>>();
  for (const auto& picture : pictures) {
    cv::Mat empty = picture.clone();
    const auto board = calibration::detectBoard(picture, {}, "board");
    if (!board) continue;
    Eigen::Vector2d low = board->corners.front().pixel, high = low;
    for (const auto& c : board->corners) {
      low = low.cwiseMin(c.pixel);
      high = high.cwiseMax(c.pixel);
    }
    const cv::Rect box = cv::Rect(static_cast<int>(low.x()) - 50, static_cast<int>(low.y()) - 50, static_cast<int>(high.x() - low.x()) + 100,
                                  static_cast<int>(high.y() - low.y()) + 100) & cv::Rect(0, 0, picture.cols, picture.rows);
    cv::Mat filling;
    cv::resize(picture(cv::Rect(0, 0, 100, picture.rows)), filling, box.size());
    filling.copyTo(empty(box));
    out->push_back(empty);
  }
  return out;
}

Contest absentContest(const std::shared_ptr<std::vector<cv::Mat>>& pictures) {
  Contest contest{"board_absent", "OpenCV findChessboardCorners with FAST_CHECK", {}, {}, 1, 3, false, {}};
  contest.ours = [pictures] {
    for (const auto& picture : *pictures) benchmark::DoNotOptimize(calibration::detectBoardLive(picture, {}, "live"));
  };
  contest.theirs = [pictures] {
    for (const auto& picture : *pictures) {
      benchmark::DoNotOptimize(classic(picture, cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK));
    }
  };
  contest.accuracy = [pictures] {
    int found = 0;
    for (const auto& picture : *pictures) found += calibration::detectBoardLive(picture, {}, "live").ok() ? 1 : 0;
    return Accuracy{found == 0, std::to_string(found) + " boards seen where there is none"};
  };
  return contest;
}

// Relative error of the focal length of every inner node, predicted from the others; root mean square.
std::pair<double, double> zoomErrors() {
  const auto file = vision::parseZoomFile(tests::kReportZoomFile);
  if (!file) return {1, 0};
  auto camera = file->cameras.front();
  double ours = 0, linear = 0;
  const auto misses = calibration::leaveOneOut(camera);
  for (const auto& miss : misses) ours += miss.focal_error * miss.focal_error;
  for (std::size_t i = 1; i + 1 < camera.nodes.size(); ++i) {
    const auto &a = camera.nodes[i - 1], &n = camera.nodes[i], &b = camera.nodes[i + 1];
    const double at = a.interior[0] + (b.interior[0] - a.interior[0]) * (n.zoom - a.zoom) / (b.zoom - a.zoom);
    linear += std::pow(at / n.interior[0] - 1, 2);
  }
  const auto count = static_cast<double>(misses.size());
  return {100 * std::sqrt(ours / count), 100 * std::sqrt(linear / count)};
}

Contest zoomContest() {
  Contest contest{"zoom_focal", "linear interpolation, leave-one-out on the report's table", {}, {}, 5, 30, false, {}};
  contest.figures = zoomErrors;
  contest.unit = "% rms";
  return contest;
}

}  // namespace

std::vector<Contest> calibrationContests(std::map<std::string, std::string>* skipped) {
  std::vector<Contest> out = {intrinsicsContest(), zoomContest()};
  const auto pictures = tests::dataFolder().empty() ? std::vector<cv::Mat>{} : photographs();
  if (pictures.empty()) {
    for (const char* name : {"board_present", "board_absent"}) (*skipped)[name] = "no photographs (set LONGARM_DATA)";
    return out;
  }
  out.push_back(presentContest(std::make_shared<std::vector<cv::Mat>>(pictures)));
  out.push_back(absentContest(withoutBoards(pictures)));
  return out;
}

}  // namespace longarm::benchmarks
