#include "planning/robot/robot_model.h"

#include <algorithm>

#include "core/require.h"

namespace longarm::planning {
namespace {

/// Motion of a joint at value `q`, in its own frame.
Pose jointMotion(const Joint& joint, double q) {
  Pose X = Pose::Identity();
  if (joint.type == JointType::kPrismatic) {
    X.translation() = q * joint.axis;
  } else if (joint.type != JointType::kFixed) {
    X.linear() = Eigen::AngleAxisd(q, joint.axis).toRotationMatrix();
  }
  return X;
}

/// Value of any joint, mimics included, at configuration q.
double jointValue(const std::vector<Joint>& joints, const Joint& joint, const Eigen::VectorXd& q) {
  if (joint.q_index >= 0) return q[joint.q_index];
  if (joint.mimic_of < 0) return 0;
  const int source = joints[static_cast<std::size_t>(joint.mimic_of)].q_index;
  return joint.mimic_multiplier * q[source] + joint.mimic_offset;
}

template <typename Named>
Result<int> indexByName(const std::vector<Named>& things, const std::string& name, const char* kind,
                        const std::string& robot) {
  for (std::size_t i = 0; i < things.size(); ++i) {
    if (things[i].name == name) return static_cast<int>(i);
  }
  return Error{ErrorCode::kNotFound, std::string("robot \"") + robot + "\" has no " + kind + " \"" +
                                         name.substr(0, 200) + "\"; longarm robot info lists them"};
}

}  // namespace

Result<int> RobotModel::linkIndex(const std::string& name) const {
  return indexByName(m_links, name, "link", m_name);
}

Result<int> RobotModel::jointIndex(const std::string& name) const {
  return indexByName(m_joints, name, "joint", m_name);
}

std::shared_ptr<const RobotModel> RobotModel::withJointPose(int joint, const Pose& X_PJ) const {
  LONGARM_REQUIRE(joint >= 0 && joint < static_cast<int>(m_joints.size()), "no joint of this robot");
  auto changed = std::shared_ptr<RobotModel>(new RobotModel(*this));
  changed->m_joints[static_cast<std::size_t>(joint)].X_PJ = X_PJ;
  return changed;
}

Result<JointGroup> RobotModel::chain(const std::string& base_link, const std::string& tip_link) const {
  const auto base = linkIndex(base_link);
  if (!base) return base.error();
  const auto tip = linkIndex(tip_link);
  if (!tip) return tip.error();
  JointGroup group{tip_link, base_link, tip_link, {}};
  int at = *tip;
  while (at != *base) {
    const int up = m_links[static_cast<std::size_t>(at)].parent_joint;
    if (up < 0) {
      return Error{ErrorCode::kInvalidInput, "link \"" + tip_link + "\" is not below link \"" + base_link +
                                                 "\"; expected a chain from base to tip"};
    }
    const Joint& joint = m_joints[static_cast<std::size_t>(up)];
    if (joint.q_index >= 0) group.joints.push_back(up);
    at = joint.parent_link;
  }
  std::reverse(group.joints.begin(), group.joints.end());
  return group;
}

Eigen::VectorXd RobotModel::neutral() const {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(dof());
  for (int i = 0; i < dof(); ++i) {
    const Joint& joint = m_joints[static_cast<std::size_t>(m_actuated[static_cast<std::size_t>(i)])];
    if (joint.lower > 0 || joint.upper < 0) q[i] = 0.5 * (joint.lower + joint.upper);
  }
  return q;
}

void RobotModel::assign(const JointState& state, Eigen::VectorXd& q) const {
  LONGARM_REQUIRE(q.size() == dof(), "configuration of the wrong size");
  const auto count = std::min<std::size_t>(state.names.size(), static_cast<std::size_t>(state.positions.size()));
  for (std::size_t i = 0; i < count; ++i) {
    const auto found = std::find(m_actuated_names.begin(), m_actuated_names.end(), state.names[i]);
    if (found == m_actuated_names.end()) continue;
    q[found - m_actuated_names.begin()] = state.positions[static_cast<Eigen::Index>(i)];
  }
}

void RobotModel::forward(const Eigen::VectorXd& q, std::vector<Pose>& X_RL) const {
  LONGARM_REQUIRE(q.size() == dof(), "configuration of the wrong size");
  X_RL.resize(m_links.size());
  X_RL[static_cast<std::size_t>(m_root)].setIdentity();
  for (const int index : m_topological) {
    const Joint& joint = m_joints[static_cast<std::size_t>(index)];
    X_RL[static_cast<std::size_t>(joint.child_link)] = X_RL[static_cast<std::size_t>(joint.parent_link)] *
                                                       joint.X_PJ *
                                                       jointMotion(joint, jointValue(m_joints, joint, q));
  }
}

Pose RobotModel::forward(const Eigen::VectorXd& q, int link) const {
  LONGARM_REQUIRE(q.size() == dof(), "configuration of the wrong size");
  Pose X = Pose::Identity();
  for (int up = m_links.at(static_cast<std::size_t>(link)).parent_joint; up >= 0;) {
    const Joint& joint = m_joints[static_cast<std::size_t>(up)];
    X = joint.X_PJ * jointMotion(joint, jointValue(m_joints, joint, q)) * X;
    up = m_links[static_cast<std::size_t>(joint.parent_link)].parent_joint;
  }
  return X;
}

Eigen::MatrixXd RobotModel::jacobian(const Eigen::VectorXd& q, const JointGroup& group) const {
  const auto tip = linkIndex(group.tip_link);
  LONGARM_REQUIRE(tip.ok(), "group with an unknown tip \"" + group.tip_link + "\"");
  std::vector<Pose> X_RL;
  forward(q, X_RL);
  const Eigen::Vector3d p_tip = X_RL[static_cast<std::size_t>(*tip)].translation();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(group.joints.size()));
  for (int up = m_links[static_cast<std::size_t>(*tip)].parent_joint; up >= 0;) {
    const Joint& joint = m_joints[static_cast<std::size_t>(up)];
    const int driver = joint.mimic_of >= 0 ? joint.mimic_of : up;
    const auto found = std::find(group.joints.begin(), group.joints.end(), driver);
    if (joint.type != JointType::kFixed && found != group.joints.end()) {
      const Pose& X_RC = X_RL[static_cast<std::size_t>(joint.child_link)];
      const Eigen::Vector3d axis =
          X_RC.linear() * joint.axis * (joint.mimic_of >= 0 ? joint.mimic_multiplier : 1.0);
      auto column = J.col(found - group.joints.begin());
      if (joint.type == JointType::kPrismatic) {
        column.tail<3>() += axis;
      } else {
        column.head<3>() += axis;
        column.tail<3>() += axis.cross(p_tip - X_RC.translation());
      }
    }
    up = m_links[static_cast<std::size_t>(joint.parent_link)].parent_joint;
  }
  return J;
}

Eigen::VectorXd groupPositions(const RobotModel& model, const JointGroup& group, const Eigen::VectorXd& q) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(group.joints.size()));
  for (std::size_t i = 0; i < group.joints.size(); ++i) {
    values[static_cast<Eigen::Index>(i)] =
        q[model.joints()[static_cast<std::size_t>(group.joints[i])].q_index];
  }
  return values;
}

void setGroupPositions(const RobotModel& model, const JointGroup& group, const Eigen::VectorXd& values,
                       Eigen::VectorXd& q) {
  LONGARM_REQUIRE(values.size() == static_cast<Eigen::Index>(group.joints.size()), "values of the wrong size");
  for (std::size_t i = 0; i < group.joints.size(); ++i) {
    q[model.joints()[static_cast<std::size_t>(group.joints[i])].q_index] = values[static_cast<Eigen::Index>(i)];
  }
}

}  // namespace longarm::planning
