#include "planning/macros/plan_report.h"

#include <nlohmann/json.hpp>

namespace longarm::planning {
namespace {

nlohmann::json poseJson(const Pose& X, const std::string& parent) {
  const Eigen::Vector3d p = X.translation();
  const Eigen::Vector4d q = quaternionXyzw(X.linear());
  return {{"parent", parent}, {"xyz", {p.x(), p.y(), p.z()}}, {"quaternion_xyzw", {q[0], q[1], q[2], q[3]}}};
}

}  // namespace

nlohmann::json toJson(const Plan& plan, const std::string& root) {
  nlohmann::json stages = nlohmann::json::array();
  for (const auto& stage : plan.stages) {
    stages.push_back({{"name", stage.name}, {"start", stage.start_s}, {"end", stage.end_s}, {"straight", stage.straight}, {"gripper", nullptr}});
    if (stage.gripper) stages.back()["gripper"] = stage.gripper->position;
  }
  nlohmann::json out{{"status", toString(plan.status)},
                     {"reason", plan.reason},
                     {"macro", plan.macro},
                     {"advice", plan.advice},
                     {"failed_stage", nullptr},
                     {"failed_waypoint", nullptr},
                     {"failed_pose", nullptr},
                     {"planning_seconds", plan.planning_seconds},
                     {"min_clearance", nullptr},
                     {"duration", nullptr},
                     {"max_velocity_ratio", nullptr},
                     {"max_acceleration_ratio", nullptr},
                     {"goal", nullptr},
                     {"go", plan.go},
                     {"accuracy_note", plan.accuracy_note},
                     {"notes", plan.notes},
                     {"figures", plan.figures},
                     {"pan_tilt", plan.pan_tilt},
                     {"stages", std::move(stages)}};
  if (!plan.failed_stage.empty()) out["failed_stage"] = plan.failed_stage;
  if (plan.failed_waypoint >= 0) out["failed_waypoint"] = plan.failed_waypoint;
  if (plan.failed_pose) out["failed_pose"] = poseJson(*plan.failed_pose, root);
  out["clearance"] = nlohmann::json::array();
  for (const auto& sample : plan.clearance) out["clearance"].push_back({sample.t_s, sample.distance});
  if (plan.ok()) {
    out["min_clearance"] = plan.min_clearance;
    out["duration"] = plan.trajectory.duration();
    out["max_velocity_ratio"] = plan.max_velocity_ratio;
    out["max_acceleration_ratio"] = plan.max_acceleration_ratio;
    out["goal"] = poseJson(plan.goal, root);
  }
  return out;
}

}  // namespace longarm::planning
