#pragma once

/// @file
/// Inverse kinematics of any chain: Levenberg-Marquardt with limits and restarts.

#include <array>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "core/result.h"
#include "planning/robot/chain_kinematics.h"
#include "planning/robot/robot_model.h"

namespace longarm::planning {

struct IkOptions {
  int restarts = 20;                       ///< Random starts after the seed has failed.
  int iterations = 60;                     ///< At most, of each try.
  unsigned seed = 1;                       ///< Of the random starts.
  double position_tolerance = 1e-6;        ///< [m]
  double orientation_tolerance = 1e-6;     ///< [rad]
  /// Directions of the goal's own frame that do not matter: turning about its x, y, z, then shifting along x, y, z.
  /// A pipe grasped along tool x leaves turning about x free: {true, false, ...}.
  std::array<bool, 6> free{};
};

struct IkSolution {
  Eigen::VectorXd joints;                  ///< (n) Group's values, inside the limits.
  double position_error = 0;               ///< [m], by forward kinematics, free directions left out.
  double orientation_error = 0;            ///< [rad]
  int iterations = 0, tries = 0;           ///< Spent in all.
};

/// Solves X_root_tip(q) = goal for the joints of one group.
///
/// Levenberg-Marquardt with the residual itself as damping (Sugihara, "Solvability-Unconcerned Inverse Kinematics by
/// the Levenberg-Marquardt Method", IEEE T-RO 27(5), 2011); rotation is weighted by 0.2 m/rad.  Departures: the
/// constant part of the damping shrinks and grows with success; joints that turn all the way round are wrapped,
/// the others clamped to their limits; tries that stop improving are given up early.
///
/// Every answer is checked by forward kinematics and lies within the limits.  The same input and seed give the same
/// answer.  Const methods are thread-safe and allocate nothing but the answer.
class IkSolver {
 public:
  /// Joints outside the group stand at `reference` (the model's neutral configuration by default).
  /// @pre The group has 1 ... ChainKinematics::kMaxJoints joints.
  IkSolver(std::shared_ptr<const RobotModel> model, const JointGroup& group);
  IkSolver(std::shared_ptr<const RobotModel> model, const JointGroup& group, const Eigen::VectorXd& reference);

  /// Keeps answers inside these limits (a workcell's, with their margin) instead of the URDF's.
  /// @pre n values each, finite, lower <= upper.
  void setLimits(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

  const ChainKinematics& kinematics() const { return m_chain; }
  const JointGroup& group() const { return m_group; }

  /// The solution reached from `seed`, or else from random starts.
  /// @param goal  X_root_tip, rigid.  @param seed  (n) group's values; clamped to the limits.
  /// @returns kInvalidInput: goal not rigid or seed of the wrong size or not finite; kNoSolution: none found, the
  ///   message gives the smallest error met.
  Result<IkSolution> solve(const Pose& goal, const Eigen::VectorXd& seed, const IkOptions& options = {}) const;

  /// Distinct solutions (some joint differs by more than `distinct` [rad or m]) found from the seed and all restarts,
  /// nearest to the seed first.  Joints with more than one turn of range are given in the turn nearest the seed.
  /// Redundant arms have endlessly many; this is a sample.  Fails as solve().
  Result<std::vector<IkSolution>> solveAll(const Pose& goal, const Eigen::VectorXd& seed,
                                           const IkOptions& options = {}, double distinct = 0.01) const;

 private:
  struct Goal;
  struct Attempt;
  template <int kJoints>
  Attempt descend(const Goal& goal, double* q, const IkOptions& options) const;
  Attempt attempt(const Goal& goal, double* q, const IkOptions& options) const;
  void setLimit(std::size_t i, double lower, double upper);
  Status check(const Pose& goal, const Eigen::VectorXd& seed) const;
  void applyLimits(double* q) const;
  IkSolution solution(const Goal& goal, const double* q, const Eigen::VectorXd& seed) const;

  std::shared_ptr<const RobotModel> m_model;
  JointGroup m_group;
  ChainKinematics m_chain;
  std::vector<double> m_lower, m_upper;      ///< Limits; random starts use +-pi where there are none.
  std::vector<char> m_wraps;                 ///< Turns all the way round: 2 pi or more between its limits.
};

}  // namespace longarm::planning
