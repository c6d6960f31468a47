#include "session/task/lift_motion.h"

#include <algorithm>

#include "core/text.h"
#include "planning/motion/arm_space.h"
#include "planning/motion/straight_leg.h"
#include "planning/motion/timed_motion.h"

namespace longarm::session {
namespace {

planning::WorldObject heldPipe(const planning::Workcell& workcell, const Pose& X_RT, const vision::Feature& pipe,
                               double radius) {
  const Eigen::Vector3d a = pipe.vertices[0].xyz, b = pipe.vertices[1].xyz;
  Pose X_RO = Pose::Identity();
  X_RO.linear() = rotationWithZ(b - a);
  X_RO.translation() = 0.5 * (a + b);
  planning::WorldObject out;
  out.name = "held pipe";
  out.shape = planning::Cylinder{radius, (b - a).norm()};
  out.attached_link = workcell.arm.tip_link;
  out.X_WO = X_RT.inverse() * X_RO;
  return out;
}

}  // namespace

Result<Trajectory> planLift(const planning::Workcell& workcell, const Eigen::VectorXd& q, const vision::Feature& pipe,
                            double radius, double height) {
  const auto& model = *workcell.model;
  const auto tip = model.linkIndex(workcell.arm.tip_link);
  if (!tip) return tip.error();
  const Pose X_RT = model.forward(q, *tip);
  auto objects = workcell.objects;
  objects.push_back(heldPipe(workcell, X_RT, pipe, radius));
  planning::CollisionOptions options;
  options.moving = planning::movingIndices(model, workcell.arm);
  planning::CollisionWorld world(workcell.model, objects, planning::allowedPairs(workcell.model), options);
  if (workcell.gripper) world.allow("held pipe", workcell.gripper->links);
  // What the grasp is close to already, the lift may leave as close.
  const auto [outside, inside] = world.clearances(q, 2 * options.padding);
  world.setPadding(std::min(options.padding, 0.8 * outside), std::min(options.self_padding, 0.8 * inside));
  planning::ArmSpace space(workcell, world, q);
  Pose X_end = X_RT;
  X_end.translation().z() += height;
  const auto leg = planning::followLine(space, planning::groupPositions(model, workcell.arm, q), X_end);
  if (!leg.ok) {
    return Error{ErrorCode::kNoSolution, "the arm cannot lift by " + formatFixed(height * 1000, 0) + " mm: " + leg.why};
  }
  return planning::timedLeg(workcell, space, leg, {std::min(workcell.approach_speed, workcell.max_tool_speed)});
}

}  // namespace longarm::session
