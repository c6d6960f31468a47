#include "planning/macros/pipe_grasp.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "planning/macros/feature_geometry.h"

namespace longarm::planning {
namespace {

constexpr double kShortest = 0.02;       // [m]
constexpr double kLongest = 20;
constexpr double kUpright = 0.978;       // |cos| of the angle to the vertical: 12 degrees

// Approach direction nearest to straight down that is square to the pipe.
Eigen::Vector3d firstApproach(const Pipe& pipe) {
  Eigen::Vector3d wanted = -Eigen::Vector3d::UnitZ();
  if (std::abs(pipe.direction.z()) > kUpright) {
    wanted = Eigen::Vector3d(pipe.middle.x(), pipe.middle.y(), 0);
    if (wanted.norm() < 1e-6) wanted = Eigen::Vector3d::UnitX();
  }
  const Eigen::Vector3d square = wanted - wanted.dot(pipe.direction) * pipe.direction;
  return square.normalized();
}

}  // namespace

Eigen::Matrix3d Pipe::covarianceAt(double along) const {
  const double second = 0.5 + along / length, first = 1 - second;
  return first * first * covariance_first + second * second * covariance_second;
}

Result<Pipe> pipeFrom(const vision::Feature& feature, const RobotModel& model, const Eigen::VectorXd& q) {
  if (feature.kind != vision::FeatureKind::kLine || feature.vertices.size() != 2) {
    return Error{ErrorCode::kInvalidInput, "a pipe is a line of 2 vertices; the feature has " +
                                               std::to_string(feature.vertices.size())};
  }
  const auto& a = feature.vertices[0];
  const auto& b = feature.vertices[1];
  if (!a.xyz.allFinite() || !b.xyz.allFinite() || !a.covariance.allFinite() || !b.covariance.allFinite()) {
    return Error{ErrorCode::kInvalidInput, "the feature holds a number that is not finite"};
  }
  const auto X = poseOfParent(feature.parent, model, q);
  if (!X) return X.error();
  Pipe pipe;
  pipe.length = (b.xyz - a.xyz).norm();
  if (!(pipe.length >= kShortest) || pipe.length > kLongest) {
    return Error{ErrorCode::kDegenerate, "the line is " + formatFixed(pipe.length * 1000, 1) +
                                             " mm long; a pipe to grab is 20 mm to 20 m: mark it again"};
  }
  pipe.middle = *X * (0.5 * (a.xyz + b.xyz));
  pipe.direction = X->linear() * (b.xyz - a.xyz) / pipe.length;
  pipe.covariance_first = X->linear() * a.covariance * X->linear().transpose();
  pipe.covariance_second = X->linear() * b.covariance * X->linear().transpose();
  return pipe;
}

std::vector<PipeGrasp> graspsAt(const Pipe& pipe, double along, double step) {
  const Eigen::Vector3d first = firstApproach(pipe);
  std::vector<PipeGrasp> out;
  const int steps = static_cast<int>(std::floor(0.5 * M_PI / step + 1e-9));
  for (int i = 0; i <= 2 * steps; ++i) {
    const double tilt = (i % 2 ? 1 : -1) * step * ((i + 1) / 2);     // 0, +1, -1, +2, ... steps
    const Eigen::Vector3d z = Eigen::AngleAxisd(tilt, pipe.direction) * first;
    if (z.z() > 1e-6) continue;          // from below
    for (const bool flipped : {false, true}) {
      const Eigen::Vector3d x = flipped ? Eigen::Vector3d(-pipe.direction) : pipe.direction;
      PipeGrasp grasp{along, tilt, flipped, Pose::Identity()};
      grasp.X_RT.linear() << x, z.cross(x), z;
      grasp.X_RT.translation() = pipe.middle + along * pipe.direction;
      out.push_back(grasp);
    }
  }
  return out;
}

std::vector<double> placesAlong(const Pipe& pipe, double step, double margin) {
  std::vector<double> out{0};
  const double most = std::min(0.5 * pipe.length - margin, 10 * step);
  for (int i = 1; i * step <= most; ++i) {
    out.push_back(i * step);
    out.push_back(-i * step);
  }
  return out;
}

}  // namespace longarm::planning
