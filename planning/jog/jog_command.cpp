#include "planning/jog/jog_command.h"

#include <algorithm>
#include <cmath>

#include <Eigen/SVD>

#include "core/text.h"

namespace longarm::planning {

namespace {

constexpr double kMetresPerRadian = 0.3;
constexpr double kDampFrom = 0.06;         // singular value of the weighted Jacobian below which it is damped [m/rad]
constexpr double kMostDamping = 0.06;
constexpr double kLost = 0.90, kTrue = 0.99;   // cosine between wanted and possible: stands still below, full speed above

Status checkCommand(const Workcell& workcell, const JogCommand& command) {
  const auto inside = [](double value) { return std::abs(value) <= 1; };      // false for what is not a number
  const bool good = inside(command.turn) && inside(command.speed) && command.speed >= 0 &&
                    (command.linear.array().abs() <= 1).all() && (command.angular.array().abs() <= 1).all();
  if (!good) return {ErrorCode::kInvalidInput, "jog: deflections lie between -1 and 1, the speed between 0 and 1"};
  if (command.frame == JogFrame::kJoint && (command.joint < 0 || command.joint >= static_cast<int>(workcell.arm.joints.size()))) {
    return {ErrorCode::kInvalidInput, "jog: the arm has joints 1 to " + std::to_string(workcell.arm.joints.size()) +
                                          ", not " + std::to_string(command.joint + 1)};
  }
  return {};
}

// qd = J^T (J J^T + damping^2)^-1 twist, damped only near a singularity.
JogVelocity solveTwist(const Eigen::MatrixXd& J, const Eigen::VectorXd& twist) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& s = svd.singularValues();
  const double least = s[s.size() - 1];
  const double near = std::max(0.0, 1 - least / kDampFrom);
  const double damping = kMostDamping * std::sqrt(near) * near;
  const Eigen::VectorXd along = svd.matrixU().transpose() * twist;
  const Eigen::VectorXd gains = s.array() / (s.array().square() + damping * damping).max(1e-12);
  JogVelocity out;
  out.joints = svd.matrixV() * (gains.array() * along.array()).matrix();
  const Eigen::VectorXd possible = J * out.joints;
  const double cosine = possible.norm() > 1e-12 ? possible.dot(twist) / (possible.norm() * twist.norm()) : 0;
  out.dexterity = std::clamp((cosine - kLost) / (kTrue - kLost), 0.0, 1.0);
  out.joints *= out.dexterity;
  return out;
}

}  // namespace

Result<Eigen::Matrix3d> axesOf(const Workcell& workcell, const Eigen::VectorXd& q, JogFrame frame, const std::string& name) {
  if (frame == JogFrame::kJoint) return Error{ErrorCode::kInvalidInput, "single joints have no axes in common"};
  const RobotModel& model = *workcell.model;
  std::string link = workcell.arm.tip_link;
  if (frame == JogFrame::kBase) return Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  if (frame == JogFrame::kCamera) {
    const CameraSpec* camera = workcell.camera(name);
    if (camera == nullptr) {
      return Error{ErrorCode::kInvalidInput, "the workcell has no camera \"" + name + "\""};
    }
    link = camera->link;
  }
  const auto index = model.linkIndex(link);
  if (!index) return index.error();
  return Eigen::Matrix3d(model.forward(q, *index).linear());
}

Eigen::VectorXd withArm(const Workcell& workcell, const Eigen::VectorXd& q, const Eigen::VectorXd& arm) {
  Eigen::VectorXd out = q;
  setGroupPositions(*workcell.model, workcell.arm, arm, out);
  return out;
}

Result<JogVelocity> jogVelocity(const Workcell& workcell, const Eigen::VectorXd& q, const JogCommand& command,
                                const JogSpeeds& speeds) {
  if (auto status = checkCommand(workcell, command); !status) return status.error();
  JogVelocity out;
  out.joints = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(workcell.arm.joints.size()));
  if (command.isIdle()) return out;
  if (command.frame == JogFrame::kJoint) {
    out.joints[command.joint] =
        command.turn * command.speed * speeds.joint_share * workcell.arm_limits.max_velocity[command.joint];
    return out;
  }
  const auto axes = axesOf(workcell, q, command.frame, command.camera);
  if (!axes) return axes.error();
  Eigen::MatrixXd J = workcell.model->jacobian(q, workcell.arm);
  J.topRows(3) *= kMetresPerRadian;
  Eigen::VectorXd twist(6);
  twist << *axes * command.angular * (command.speed * speeds.angular * kMetresPerRadian),
      *axes * command.linear * (command.speed * speeds.linear);
  return solveTwist(J, twist);
}

}  // namespace longarm::planning
