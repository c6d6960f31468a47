#pragma once

/// @file
/// A robot as URDF (+ SRDF) describes it: links, joints, shapes, kinematics.

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/motion.h"
#include "core/pose.h"
#include "core/result.h"
#include "planning/world/shape.h"

namespace longarm::planning {

enum class JointType { kFixed, kRevolute, kContinuous, kPrismatic };

/// A shape fixed to a link.
struct LinkShape {
  Shape shape;
  Pose X_LS = Pose::Identity();          ///< Shape in link.
  Eigen::Vector4d rgba{0.6, 0.6, 0.6, 1};
};

struct Link {
  std::string name;
  int parent_joint = -1;                 ///< -1: root.
  std::vector<LinkShape> visuals, collisions;
};

struct Joint {
  std::string name;
  JointType type = JointType::kFixed;
  int parent_link = -1, child_link = -1;
  Pose X_PJ = Pose::Identity();          ///< Joint frame in the parent link at q = 0.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double lower = 0, upper = 0;           ///< [rad or m]; +-infinity for continuous.
  double max_velocity = 0;               ///< [rad/s or m/s]
  int q_index = -1;                      ///< Index in the configuration vector; -1: fixed or mimic.
  int mimic_of = -1;                     ///< Joint index that this one follows, or -1.
  double mimic_multiplier = 1, mimic_offset = 0;
};

/// An arm: the moving joints from `base_link` to `tip_link`.
struct JointGroup {
  std::string name;
  std::string base_link, tip_link;
  std::vector<int> joints;               ///< Joint indices, root to tip, actuated only.
};

struct LoadOptions {
  std::vector<std::string> package_paths;    ///< Where package:// is looked up, besides the URDF's own folder and its parents.
  bool load_meshes = true;                   ///< false: kinematics only.
};

/// Immutable; const methods are thread-safe.  The configuration q is the vector of all actuated joints
/// (not fixed, not mimic), depth first from the root, in the order of actuatedNames().
class RobotModel {
 public:
  /// @returns kInvalidInput naming file, element and value: too big, too deep, DTD, loops, two parents, not
  ///   finite, zero axis, lower > upper, mimic cycle.  A mesh that is missing or bad is a warning, not an error.
  static Result<std::shared_ptr<const RobotModel>> load(const std::string& urdf_path,
                                                        const std::string& srdf_path = {},
                                                        const LoadOptions& options = {});

  const std::string& name() const { return m_name; }
  const std::vector<Link>& links() const { return m_links; }
  const std::vector<Joint>& joints() const { return m_joints; }
  const std::vector<std::string>& warnings() const { return m_warnings; }   ///< Missing meshes and such.
  int rootLink() const { return m_root; }
  /// The same robot, one of whose joints sits elsewhere in its parent link.  @pre joint is an index of joints()
  std::shared_ptr<const RobotModel> withJointPose(int joint, const Pose& X_PJ) const;
  Result<int> linkIndex(const std::string& name) const;
  Result<int> jointIndex(const std::string& name) const;
  int dof() const { return static_cast<int>(m_actuated.size()); }
  const std::vector<std::string>& actuatedNames() const { return m_actuated_names; }
  const std::vector<int>& actuatedJoints() const { return m_actuated; }     ///< Joint index per q entry.

  /// Named configurations of the SRDF (<group_state>): joint name -> value.
  const std::map<std::string, std::map<std::string, double>>& namedStates() const { return m_named_states; }
  /// Pairs of links (a < b) whose contact the SRDF allows; empty optional when there was no SRDF.
  const std::optional<std::set<std::pair<int, int>>>& srdfAllowedPairs() const { return m_srdf_pairs; }
  /// Groups that the SRDF gives as a <chain>.
  const std::vector<JointGroup>& groups() const { return m_groups; }
  /// Chain from base to tip (any two links, tip below base).  kNotFound / kInvalidInput.
  Result<JointGroup> chain(const std::string& base_link, const std::string& tip_link) const;

  /// Middle of the limits, 0 where unlimited or where 0 is inside.
  Eigen::VectorXd neutral() const;
  /// Copies the joints named in `state` into `q`; unknown names are ignored.
  void assign(const JointState& state, Eigen::VectorXd& q) const;

  /// X_root_link of every link.  @pre q.size() == dof()
  void forward(const Eigen::VectorXd& q, std::vector<Pose>& X_RL) const;
  /// X_root_link of one link (walks only its own chain).
  Pose forward(const Eigen::VectorXd& q, int link) const;
  /// Geometric Jacobian (6 x group size) of the origin of the group's tip, in the root frame; rows: angular, then linear.
  Eigen::MatrixXd jacobian(const Eigen::VectorXd& q, const JointGroup& group) const;

 private:
  friend class RobotLoader;
  RobotModel() = default;
  std::string m_name;
  std::vector<Link> m_links;
  std::vector<Joint> m_joints;
  std::vector<std::string> m_warnings;
  int m_root = 0;
  std::vector<int> m_actuated;
  std::vector<std::string> m_actuated_names;
  std::vector<int> m_topological;        ///< Joint indices, parents first.
  std::map<std::string, std::map<std::string, double>> m_named_states;
  std::optional<std::set<std::pair<int, int>>> m_srdf_pairs;
  std::vector<JointGroup> m_groups;
};

/// Values of the group's joints out of a full configuration, and back into it.
Eigen::VectorXd groupPositions(const RobotModel& model, const JointGroup& group, const Eigen::VectorXd& q);
void setGroupPositions(const RobotModel& model, const JointGroup& group, const Eigen::VectorXd& values,
                       Eigen::VectorXd& q);

}  // namespace longarm::planning
