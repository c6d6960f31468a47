#include "planning/macros/camera_look.h"

#include <cmath>

#include <Eigen/Geometry>

#include "planning/macros/feature_geometry.h"
#include "planning/macros/tool_directions.h"
#include "planning/macros/tool_shape.h"

namespace longarm::planning {
namespace {

constexpr double kRollStep = M_PI / 12;

std::optional<int> armCameraLink(const Workcell& cell) {
  for (const auto& camera : cell.cameras) {
    const auto link = cell.model->linkIndex(camera.link);
    if (link && beyondArm(cell, *link)) return *link;
  }
  return {};
}

}  // namespace

bool hasArmCamera(const Workcell& workcell) { return armCameraLink(workcell).has_value(); }

std::optional<ArmEye> armEyeOf(const Workcell& workcell, const Eigen::VectorXd& q, const Pose& X_RT) {
  const auto link = armCameraLink(workcell);
  if (!link) return {};
  const Pose X_RC = workcell.model->forward(q, *link);
  return ArmEye{X_RC, X_RC.inverse() * X_RT};
}

std::vector<ToolTask> lookTasks(const ArmEye& eye, const Eigen::Vector3d& p, const Eigen::Vector3d& z, double distance,
                                const Eigen::Vector3d& up, int preference) {
  const Eigen::Vector3d right = z.cross(up);             // of a level picture
  const Eigen::Matrix3d R = toolRotation(z, right.norm() > 0.1 ? right : Eigen::Vector3d(eye.X_RC.linear().col(0)));
  std::vector<ToolTask> tasks;
  for (const double roll : anglesAround(M_PI, kRollStep)) {
    ToolTask task;
    task.X_entry = poseAt(p - distance * z, R) * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()) * eye.X_CT;
    task.preference = preference + static_cast<int>(std::abs(roll) / M_PI * 3.99);
    tasks.push_back(std::move(task));
  }
  return tasks;
}

}  // namespace longarm::planning
