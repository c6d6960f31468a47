#include "session/task/lift_motion.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "core/text.h"
#include "planning/motion/arm_space.h"
#include "planning/motion/straight_leg.h"
#include "planning/motion/timed_motion.h"

namespace longarm::session {
namespace {

// Straight up first, then a little to or from the robot, or to either side.
std::vector<Eigen::Vector3d> detours(const Eigen::Vector3d& p_RT) {
  const Eigen::Vector3d out = Eigen::Vector3d(p_RT.x(), p_RT.y(), 0).normalized();
  const Eigen::Vector3d side(-out.y(), out.x(), 0);
  std::vector<Eigen::Vector3d> all = {Eigen::Vector3d::Zero()};
  for (const double way : {0.04, 0.08}) {
    for (const Eigen::Vector3d& direction : {Eigen::Vector3d(-out), out, side, Eigen::Vector3d(-side)}) {
      all.push_back(way * direction);
    }
  }
  return all;
}

}  // namespace

Result<Trajectory> planLift(const planning::Workcell& workcell, const Eigen::VectorXd& q, const planning::WorldObject& grasped,
                            double height) {
  const auto& model = *workcell.model;
  const auto tip = model.linkIndex(workcell.arm.tip_link);
  if (!tip) return tip.error();
  const Pose X_RT = model.forward(q, *tip);
  auto objects = workcell.objects;
  objects.push_back(grasped);
  objects.back().attached_link = workcell.arm.tip_link;
  objects.back().X_WO = X_RT.inverse() * grasped.X_WO;
  planning::CollisionOptions options;
  options.moving = planning::movingIndices(model, workcell.arm);
  planning::CollisionWorld world(workcell.model, objects, planning::allowedPairs(workcell), options);
  if (workcell.gripper) world.allow(grasped.name, workcell.gripper->links);
  // What the grasp is close to already, the lift may leave as close.
  const auto [outside, inside] = world.clearances(q, 2 * options.padding);
  world.setPadding(std::min(options.padding, 0.8 * outside), std::min(options.self_padding, 0.8 * inside));
  planning::ArmSpace space(workcell, world, q);
  const Eigen::VectorXd start = planning::groupPositions(model, workcell.arm, q);
  std::optional<Error> straight;
  for (const auto& sideways : detours(X_RT.translation())) {
    Pose X_end = X_RT;
    X_end.translation() += sideways + height * Eigen::Vector3d::UnitZ();
    const auto leg = planning::followLine(space, start, X_end);
    auto motion = leg.ok ? planning::timedLeg(workcell, space, leg, {std::min(workcell.approach_speed, workcell.max_tool_speed)})
                         : Result<Trajectory>(ErrorCode::kNoSolution, leg.why);
    if (motion) return motion;
    if (!straight) straight = motion.error();
  }
  return Error{straight->code, "the arm cannot lift by " + formatFixed(height * 1000, 0) + " mm: " + straight->message};
}

}  // namespace longarm::session
