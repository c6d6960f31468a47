#include "planning/motion/timed_motion.h"

#include <algorithm>
#include <cmath>

#include "planning/trajectory/joint_path.h"
#include "planning/trajectory/nominal_limits.h"
#include "planning/trajectory/time_parameterization.h"

namespace longarm::planning {
namespace {

constexpr double kWidestBlend = 0.4;     // joint-space length before and after a corner [rad]
constexpr double kChordDeviation = 2e-4;
constexpr double kCertifiedShare = 0.4;
constexpr int kHalvings = 6;
constexpr double kClearanceStep = 0.08;  // [s]
constexpr double kFurthest = 0.5;        // [m]

TimingOptions timingOptions(const ArmSpace& space, const StageSpeed& speed) {
  TimingOptions options;
  options.max_tool_speed = speed.max_tool_speed;
  options.stop = [&space] { return space.cancelled(); };
  options.tool_way = [&space](const PathState& state) { return space.toolWay(state.q, state.dq); };
  return options;
}

// Whether the rounded corner at waypoint i is free.  The curve bends by at most 2 / blend per unit length.
bool cornerFree(const ArmSpace& space, const std::vector<Eigen::VectorXd>& waypoints, std::size_t i, double blend) {
  const Eigen::VectorXd before = waypoints[i] + blend * (waypoints[i - 1] - waypoints[i]).normalized();
  const Eigen::VectorXd after = waypoints[i] + blend * (waypoints[i + 1] - waypoints[i]).normalized();
  const BlendedPolyline corner({before, waypoints[i], after}, {blend});
  const double chord = std::sqrt(4 * kChordDeviation * blend);
  const int chords = std::max(4, static_cast<int>(std::ceil(corner.length() / chord)));
  Eigen::VectorXd from = before;
  for (int k = 1; k <= chords; ++k) {
    const Eigen::VectorXd to = corner.at(corner.length() * k / chords).q;
    if (!space.segmentFree(from, to)) return false;
    from = to;
  }
  return true;
}

std::vector<double> freeBlends(const ArmSpace& space, const std::vector<Eigen::VectorXd>& waypoints) {
  std::vector<double> blends;
  for (std::size_t i = 1; i + 1 < waypoints.size(); ++i) {
    const double shorter =
        std::min((waypoints[i] - waypoints[i - 1]).norm(), (waypoints[i + 1] - waypoints[i]).norm());
    double blend = std::min(kWidestBlend, 0.49 * shorter);
    for (int k = 0; k < kHalvings && !cornerFree(space, waypoints, i, blend); ++k) blend /= 2;
    blends.push_back(blend);
  }
  return blends;
}

Error notFree(const Contact& contact) {
  return {ErrorCode::kCollision, "the timed motion cannot be shown to be free: " + contact.sentence()};
}

}  // namespace

bool certified(const ArmSpace& space, const Trajectory& trajectory, Contact* contact) {
  CollisionWorld& world = space.world();
  const double padding = world.padding(), self_padding = world.selfPadding();
  world.setPadding(kCertifiedShare * padding, kCertifiedShare * self_padding);
  bool free = true;
  for (std::size_t i = 1; free && i < trajectory.points.size(); ++i) {
    free = space.segmentFree(trajectory.points[i - 1].positions, trajectory.points[i].positions, contact);
  }
  world.setPadding(padding, self_padding);
  return free;
}

Result<Trajectory> timedPath(const Workcell& workcell, const ArmSpace& space, const std::vector<Eigen::VectorXd>& waypoints,
                             const StageSpeed& speed) {
  std::vector<double> blends = freeBlends(space, waypoints);
  const NominalLimits limits = nominalLimits(workcell.arm_limits);
  Contact contact;
  for (int k = 0; k < 3; ++k) {
    const BlendedPolyline path(waypoints, blends);
    auto trajectory = parameterize(path, workcell.armJointNames(), limits, timingOptions(space, speed));
    if (!trajectory) return trajectory;
    if (certified(space, *trajectory, &contact)) return trajectory;
    if (space.cancelled()) break;
    for (double& blend : blends) blend /= 8;     // closer to the straight pieces, which are known to be free
  }
  return notFree(contact);
}

Result<Trajectory> timedLeg(const Workcell& workcell, const ArmSpace& space, const StraightLeg& leg,
                            const StageSpeed& speed) {
  const SplinePath path(leg.way, leg.waypoints);
  auto trajectory =
      parameterize(path, workcell.armJointNames(), nominalLimits(workcell.arm_limits), timingOptions(space, speed));
  if (!trajectory) return trajectory;
  Contact contact;
  if (!certified(space, *trajectory, &contact)) return notFree(contact);
  return trajectory;
}

void appendStage(Plan& plan, const std::string& name, bool straight, const Trajectory& trajectory) {
  const double start = plan.trajectory.duration();
  append(plan.trajectory, trajectory);
  plan.stages.push_back({name, start, plan.trajectory.duration(), straight});
}

void measureRatios(const Workcell& workcell, Plan& plan, const CancelToken& cancel) {
  const LimitRatios ratios = limitRatios(plan.trajectory, workcell.arm_limits.max_velocity, workcell.arm_limits.max_acceleration,
                                         [&cancel] { return cancel.cancelled(); });
  plan.max_velocity_ratio = ratios.velocity;
  plan.max_acceleration_ratio = ratios.acceleration;
}

void measureClearance(const ArmSpace& space, Plan& plan, double from_s, double to_s) {
  if (plan.clearance.empty()) plan.min_clearance = kFurthest;
  const int steps = std::max(1, static_cast<int>(std::ceil((to_s - from_s) / kClearanceStep)));
  for (int i = 0; i <= steps && !space.cancelled(); ++i) {
    const double t = from_s + (to_s - from_s) * i / steps;
    const Eigen::VectorXd q = space.full(plan.trajectory.sample(t).positions);
    const auto [outside, inside] = space.world().clearances(q, std::max(plan.min_clearance, kClearanceTold));
    plan.min_clearance = std::min({plan.min_clearance, outside, inside});
    plan.clearance.push_back({t, inside < kTightClearance ? std::min(outside, inside) : outside});
  }
}

}  // namespace longarm::planning
