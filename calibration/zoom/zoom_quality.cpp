#include "calibration/zoom/zoom_quality.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "vision/camera/zoom_doubt.h"

namespace longarm::calibration {
namespace {

using vision::ZoomCamera;
using vision::ZoomNode;

std::vector<double> sortedSettings(const ZoomCamera& camera) {
  std::vector<double> settings;
  for (const auto& node : camera.nodes) settings.push_back(node.zoom);
  std::sort(settings.begin(), settings.end());
  return settings;
}

Eigen::Matrix3d rotationOf(const ZoomNode& node) { return expSO3({node.exterior[3], node.exterior[4], node.exterior[5]}); }

Eigen::Vector2d pixelOf(const ZoomNode& node, const Eigen::Vector3d& direction) {
  const auto& i = node.interior;
  vision::CameraModel camera;
  camera.fx = i[0];
  camera.fy = i[1];
  camera.skew = i[2];
  camera.cx = i[3];
  camera.cy = i[4];
  camera.distortion = {i[5], i[6], i[7], i[8], 0};
  return camera.pixelOfNormalised((rotationOf(node) * direction).hnormalized());
}

// Directions in the mount that the true node shows at the middle, edges and corners of a picture.
double pictureError(const ZoomNode& truth, const ZoomNode& predicted) {
  const Eigen::Matrix3d back = rotationOf(truth).transpose();
  double sum = 0;
  for (const double u : {-320.0, 0.0, 320.0}) {
    for (const double v : {-240.0, 0.0, 240.0}) {
      const Eigen::Vector3d direction = back * Eigen::Vector3d(u / truth.interior[0], v / truth.interior[1], 1);
      sum += (pixelOf(predicted, direction) - pixelOf(truth, direction)).squaredNorm();
    }
  }
  return std::sqrt(sum / 9);
}

TrafficLight lightOf(const ZoomMiss& miss) {
  const double focal = std::abs(miss.focal_error), boresight = miss.boresight_px.norm();
  if (focal > 0.03 || boresight > 10) return TrafficLight::kRed;
  return focal > 0.01 || boresight > 3 ? TrafficLight::kAmber : TrafficLight::kGreen;
}

}  // namespace

const char* toString(TrafficLight light) {
  return light == TrafficLight::kGreen ? "green" : light == TrafficLight::kAmber ? "amber" : "red";
}

std::vector<ZoomMiss> leaveOneOut(const ZoomCamera& camera) {
  std::vector<ZoomMiss> out;
  for (const auto& prediction : vision::predictFromOthers(camera)) {
    ZoomMiss miss;
    miss.zoom = prediction.truth.zoom;
    miss.focal_error = prediction.focalError();
    miss.boresight_px = prediction.boresightError();
    miss.error_px = pictureError(prediction.truth, prediction.predicted);
    miss.nominal = vision::isNominal(prediction.truth);
    miss.light = lightOf(miss);
    out.push_back(miss);
  }
  return out;
}

std::vector<double> advisedSettings(const ZoomCamera& camera, const std::vector<ZoomMiss>& misses) {
  const auto settings = sortedSettings(camera);
  auto worst = misses;
  std::stable_sort(worst.begin(), worst.end(), [](const ZoomMiss& a, const ZoomMiss& b) { return a.error_px > b.error_px; });
  std::vector<double> out;
  for (const auto& miss : worst) {
    if (miss.light == TrafficLight::kGreen) continue;
    for (std::size_t k = 1; k + 1 < settings.size(); ++k) {
      if (settings[k] != miss.zoom) continue;
      const bool right = settings[k + 1] - settings[k] > settings[k] - settings[k - 1];
      const double at = 0.5 * (settings[k] + settings[right ? k + 1 : k - 1]);
      if (std::find(out.begin(), out.end(), at) == out.end()) out.push_back(at);
    }
  }
  return out;
}

BoresightLaw boresightLaw(const ZoomCamera& camera) {
  std::vector<ZoomNode> measured;
  for (const auto& node : camera.nodes) {
    if (!vision::isNominal(node)) measured.push_back(node);
  }
  BoresightLaw law;
  law.nodes = static_cast<int>(measured.size());
  if (measured.size() < 2) return law;
  Eigen::MatrixXd A(measured.size(), 2), b(measured.size(), 2);
  for (std::size_t k = 0; k < measured.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    A.row(row) << 1, measured[k].interior[0];
    b.row(row) = vision::boresightOf(measured[k]).transpose();
  }
  const Eigen::MatrixXd x = A.colPivHouseholderQr().solve(b);
  law.principal_point = x.row(0).transpose();
  law.slope = x.row(1).transpose();
  law.residual_px = ((A * x - b).cwiseAbs2().colwise().mean()).cwiseSqrt().transpose();
  return law;
}

}  // namespace longarm::calibration
