#include "planning/motion/straight_leg.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/text.h"
#include "planning/trajectory/joint_path.h"

namespace longarm::planning {
namespace {

constexpr double kArrived = 1e-7;
constexpr int kDeepest = 5;              // halvings of one step

// Angular, then linear error of the tool, in the root frame.
Vector6d poseError(const Pose& X_goal, const Pose& X) {
  Vector6d e;
  e << logSO3(X_goal.linear() * X.linear().transpose()), X_goal.translation() - X.translation();
  return e;
}

struct Follower {
  const ArmSpace& space;
  const LegOptions& options;
  std::function<Pose(double)> X_RT;      // by the share of the way
  double length;
  StraightLeg leg;

  // Goes from the last waypoint to parameter `s`, halving where the joints would leave the path.
  bool advance(double from, double s, int depth) {
    Eigen::VectorXd arm = leg.waypoints.back();
    if (space.cancelled()) return fail(from, "was not looked at: cancelled");
    if (!solveNear(space, X_RT(s), arm)) return fail(from, "is out of reach or a joint limit");
    const Eigen::VectorXd before = leg.waypoints.back();
    const Pose X_middle = space.tip(0.5 * (before + arm));
    const Vector6d error = poseError(X_RT(0.5 * (from + s)), X_middle);
    const double jump = (arm - before).cwiseAbs().maxCoeff();
    if (error.tail<3>().norm() > options.position_tolerance || error.head<3>().norm() > options.angle_tolerance ||
        jump > options.max_joint_step) {
      if (depth >= kDeepest) return fail(from, "needs a jump of a joint (" + formatFixed(jump * 180 / M_PI, 1) + " deg)");
      const double middle = 0.5 * (from + s);
      return advance(from, middle, depth + 1) && advance(middle, s, depth + 1);
    }
    leg.waypoints.push_back(arm);
    leg.way.push_back(s * length);
    leg.fraction = s;
    return true;
  }

  bool fail(double at, const std::string& what) {
    leg.next = what;
    leg.why = "the straight leg stops after " + formatFixed(100 * at, 0) + " % of its way: the next piece " + what;
    return false;
  }

  // A step far larger than the others, per way of the tool, is another branch.
  bool evenSteps() {
    std::vector<double> slopes;
    for (std::size_t i = 1; i < leg.waypoints.size(); ++i) {
      slopes.push_back((leg.waypoints[i] - leg.waypoints[i - 1]).cwiseAbs().maxCoeff() / (leg.way[i] - leg.way[i - 1]));
    }
    std::vector<double> sorted = slopes;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<long>(sorted.size() / 2), sorted.end());
    const double median = sorted[sorted.size() / 2];
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      const double step = (leg.waypoints[i + 1] - leg.waypoints[i]).cwiseAbs().maxCoeff();
      if (slopes[i] <= 3 * median || step <= options.even_step) continue;
      leg.fraction = leg.way[i] / leg.way.back();
      return fail(leg.fraction, "turns a joint more than three times as fast as the rest");
    }
    return true;
  }
};

}  // namespace

bool solveNear(const ArmSpace& space, const Pose& X, Eigen::VectorXd& arm, int iterations) {
  for (int i = 0; i < iterations; ++i) {
    const Vector6d e = poseError(X, space.tip(arm));
    if (e.head<3>().norm() < kArrived && e.tail<3>().norm() < kArrived) return space.withinLimits(arm, 0);
    const Eigen::MatrixXd J = space.model().jacobian(space.full(arm), space.group());
    const double damping = 1e-10 + 1e-3 * e.squaredNorm();
    const Eigen::MatrixXd A = J.transpose() * J + damping * Eigen::MatrixXd::Identity(J.cols(), J.cols());
    const Eigen::VectorXd step = A.ldlt().solve(J.transpose() * e);
    if (!step.allFinite() || step.norm() > 1) return false;
    arm += step;
  }
  return false;
}

StraightLeg followLine(const ArmSpace& space, const Eigen::VectorXd& start, const Pose& X_end,
                       const LegOptions& options) {
  const Pose X_start = space.tip(start);
  const double distance = (X_end.translation() - X_start.translation()).norm();
  const double angle = angleBetween(X_start.linear(), X_end.linear());
  const auto X_RT = [&](double share) { return interpolate(X_start, X_end, share); };
  Follower follower{space, options, X_RT, distance > 1e-9 ? distance : angle, {}};
  follower.leg.waypoints = {start};
  follower.leg.way = {0};
  if (follower.length < 1e-9) {
    follower.leg.why = "the straight leg has no length";
    return follower.leg;
  }
  const int steps = std::max({2, static_cast<int>(std::ceil(distance / options.step)),
                              static_cast<int>(std::ceil(angle / (5 * options.angle_tolerance)))});
  for (int i = 0; i < steps; ++i) {
    const double from = static_cast<double>(i) / steps, to = static_cast<double>(i + 1) / steps;
    if (!follower.advance(from, to, 0)) return follower.leg;
  }
  follower.leg.ok = follower.evenSteps();
  return follower.leg;
}

StraightLeg followPath(const ArmSpace& space, const Eigen::VectorXd& start, const std::function<Pose(double)>& X_RT,
                       const std::vector<double>& stations, const LegOptions& options) {
  const double length = stations.back();
  Follower follower{space, options, [&](double share) { return X_RT(share * length); }, length, {}};
  follower.leg.waypoints = {start};
  follower.leg.way = {0};
  for (std::size_t i = 1; i < stations.size(); ++i) {
    if (!follower.advance(stations[i - 1] / length, stations[i] / length, 0)) return follower.leg;
  }
  follower.leg.ok = follower.evenSteps();
  return follower.leg;
}

LegDeviation splineDeviation(const ArmSpace& space, const StraightLeg& leg, const std::function<Pose(double)>& X_RT) {
  const SplinePath path(leg.way, leg.waypoints);
  LegDeviation worst;
  for (std::size_t i = 1; i < leg.way.size() && !space.cancelled(); ++i) {
    for (const double share : {0.25, 0.5, 0.75}) {
      const double s = leg.way[i - 1] + share * (leg.way[i] - leg.way[i - 1]);
      const Vector6d error = poseError(X_RT(s), space.tip(path.at(s).q));
      worst.position = std::max(worst.position, error.tail<3>().norm());
      worst.angle = std::max(worst.angle, error.head<3>().norm());
    }
  }
  return worst;
}

}  // namespace longarm::planning
