#include "calibration/intrinsics/next_view.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "calibration/intrinsics/plane_homography.h"
#include "core/text.h"

namespace longarm::calibration {
namespace {

constexpr double kTilt = 0.6;      // [rad] about 34 degrees

struct Candidate {
  double place_u, place_v;         // of the picture, -1 ... 1
  double tilt_x, tilt_y;           // about the picture's axes [rad]
  double fill;                     // board width over picture width
};

std::vector<Candidate> candidates() {
  std::vector<Candidate> out;
  for (const double fill : {0.35, 0.6}) {
    for (const double u : {-1.0, 0.0, 1.0}) {
      for (const double v : {-1.0, 0.0, 1.0}) {
        for (const double x : {-kTilt, 0.0, kTilt}) {
          for (const double y : {-kTilt, 0.0, kTilt}) out.push_back({u, v, x, y, fill});
        }
      }
    }
  }
  return out;
}

// The board at a candidate's place, facing the camera, tilted.
Pose poseOf(const Candidate& at, const vision::CameraModel& camera, const CornerPlane& plane, double half_width) {
  const double distance = camera.fx * 2 * half_width / (at.fill * camera.width);
  const double reach = 0.5 * (1 - at.fill);
  const Eigen::Vector2d pixel(0.5 * camera.width + at.place_u * reach * camera.width,
                              0.5 * camera.height + at.place_v * reach * camera.height);
  Pose X_CP = Pose::Identity();
  X_CP.linear() = expSO3({at.tilt_x, 0, 0}) * expSO3({0, at.tilt_y, 0});
  X_CP.translation() << distance * (pixel.x() - camera.cx) / camera.fx, distance * (pixel.y() - camera.cy) / camera.fy,
      distance;
  return X_CP * plane.X_KP.inverse();
}

// Information a view adds on the lens once its own pose is eliminated; nothing if a corner leaves the picture.
std::optional<LensMatrix> informationOf(const std::vector<Corner>& corners, const Pose& X_CK,
                                        const vision::CameraModel& camera, double sigma) {
  LensMatrix G = LensMatrix::Zero();
  Eigen::Matrix<double, kLensParameters, 6> W = Eigen::Matrix<double, kLensParameters, 6>::Zero();
  Matrix6d B = Matrix6d::Zero();
  LensProjection at;
  for (const auto& c : corners) {
    const Eigen::Vector3d turned = X_CK.linear() * c.xyz;
    if (!projectWithDerivatives(camera, turned + X_CK.translation(), &at)) return std::nullopt;
    if (!camera.containsPixel(at.pixel, -5)) return std::nullopt;
    Eigen::Matrix<double, 2, 6> J;
    J.leftCols<3>() = -at.d_point * skew(turned);
    J.rightCols<3>() = at.d_point;
    G.noalias() += at.d_lens.transpose() * at.d_lens;
    W.noalias() += at.d_lens.transpose() * J;
    B.noalias() += J.transpose() * J;
  }
  return LensMatrix((G - W * B.ldlt().solve(W.transpose())) / (sigma * sigma));
}

double logDeterminant(const LensMatrix& information, const std::vector<int>& free) {
  Eigen::MatrixXd M(free.size(), free.size());
  for (std::size_t i = 0; i < free.size(); ++i) {
    for (std::size_t j = 0; j < free.size(); ++j) {
      M(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = information(free[i], free[j]);
    }
  }
  const Eigen::VectorXd d = M.ldlt().vectorD();
  double sum = 0;
  for (Eigen::Index i = 0; i < d.size(); ++i) sum += std::log2(std::max(d[i], 1e-300));
  return sum;
}

std::string wordsOf(const Candidate& at) {
  const auto third = [](double value, const char* low, const char* high) {
    return std::string(value < 0 ? low : value > 0 ? high : "");
  };
  std::string place = third(at.place_v, "upper", "lower") + (at.place_v != 0 && at.place_u != 0 ? " " : "") +
                      third(at.place_u, "left", "right");
  if (place.empty()) place = "middle";
  std::string tilt;
  if (at.tilt_x != 0) tilt += at.tilt_x > 0 ? "its lower edge farther away" : "its upper edge farther away";
  if (at.tilt_y != 0) {
    tilt += (tilt.empty() ? "" : " and ") + std::string(at.tilt_y < 0 ? "its right edge farther away" : "its left edge farther away");
  }
  return "hold the board at the " + place + " of the picture, filling " + formatFixed(100 * at.fill, 0) +
         " % of its width, " + (tilt.empty() ? "square to the camera" : "with " + tilt + " (about 35 degrees)");
}

std::vector<Eigen::Vector2d> outline(const std::vector<Corner>& corners, const CornerPlane& plane, const Pose& X_CK,
                                     const vision::CameraModel& camera) {
  std::vector<Eigen::Vector2d> out;
  const Pose X_PK = plane.X_KP.inverse();
  for (const auto& direction : {Eigen::Vector2d(-1, -1), Eigen::Vector2d(1, -1), Eigen::Vector2d(1, 1), Eigen::Vector2d(-1, 1)}) {
    const auto extreme = std::max_element(corners.begin(), corners.end(), [&](const Corner& a, const Corner& b) {
      return (X_PK * a.xyz).head<2>().dot(direction) < (X_PK * b.xyz).head<2>().dot(direction);
    });
    Eigen::Vector2d pixel;
    if (projectPoint(camera, X_CK * extreme->xyz, &pixel)) out.push_back(pixel);
  }
  return out;
}

}  // namespace

std::optional<NextView> nextView(const std::vector<BoardView>& views, const IntrinsicsResult& result) {
  std::size_t first = 0;
  while (first < views.size() && !result.views[first].used) ++first;
  if (first == views.size() || result.camera.width <= 0) return std::nullopt;
  const auto& corners = views[first].corners;
  const CornerPlane plane = planeOf(corners);
  if (plane.flatness > 0.02) return std::nullopt;
  double half_width = 0;
  for (const auto& c : corners) half_width = std::max(half_width, (plane.X_KP.inverse() * c.xyz).head<2>().cwiseAbs().maxCoeff());
  const auto free = result.estimated.indices();
  const double now = logDeterminant(result.information, free), sigma = std::max(result.sigma_px, 1e-3);
  std::optional<NextView> best;
  for (const auto& candidate : candidates()) {
    const Pose X_CK = poseOf(candidate, result.camera, plane, half_width);
    const auto more = informationOf(corners, X_CK, result.camera, sigma);
    if (!more) continue;
    const double gain = 0.5 * (logDeterminant(result.information + *more, free) - now);
    if (best && gain <= best->gain_bits) continue;
    best = NextView{X_CK, gain, {}, wordsOf(candidate)};
  }
  if (best) best->outline_px = outline(corners, plane, best->X_CK, result.camera);
  return best;
}

}  // namespace longarm::calibration
