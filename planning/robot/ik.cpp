#include "planning/robot/ik.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <Eigen/Cholesky>

#include "core/require.h"
#include "core/text.h"

namespace longarm::planning {
namespace {

constexpr double kTwoPi = 2 * M_PI;
constexpr double kRotationWeight = 0.2;    ///< [m/rad]
constexpr double kLongestStep = 0.8;       ///< [rad or m] a joint moves in one iteration.
constexpr int kPatience = 8;               ///< Iterations without halving the residual before a try is given up.

/// Small generator with the same numbers on every machine (splitmix64; Steele, Lea, Flood, OOPSLA 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : m_state(seed * 0x9e3779b97f4a7c15u + 1) {}
  double uniform(double lower, double upper) {
    m_state += 0x9e3779b97f4a7c15u;
    std::uint64_t z = m_state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return lower + (upper - lower) * (static_cast<double>(z >> 11) * 0x1.0p-53);
  }

 private:
  std::uint64_t m_state;
};

/// Rotation vector of R; cheaper than the general logarithm, exact to rounding away from half a turn.
Eigen::Vector3d rotationVector(const Eigen::Matrix3d& R) {
  const Eigen::Vector3d v(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  const double twice_sine = v.norm(), twice_cosine = R.trace() - 1;
  if (twice_cosine > 1 && twice_sine < 1e-4) return v * (0.5 + twice_sine * twice_sine / 48);
  if (twice_sine < 1e-6) return logSO3(R);
  return v * (std::atan2(twice_sine, twice_cosine) / twice_sine);
}

}  // namespace

struct IkSolver::Goal {
  Eigen::Matrix3d R;
  Eigen::Vector3d p;
  bool all_matter = true;
  Vector6d matters = Vector6d::Ones();       ///< 0 where the goal's direction is free.

  /// Residual (rotation vector, shift) in the root frame, or in the goal frame when something is free.
  Vector6d residual(const Eigen::Matrix3d& R_tip, const Eigen::Vector3d& p_tip) const {
    Vector6d e;
    e.head<3>() = rotationVector(R * R_tip.transpose());
    e.tail<3>() = p - p_tip;
    if (!all_matter) {
      e.head<3>() = R.transpose() * e.head<3>();
      e.tail<3>() = R.transpose() * e.tail<3>();
      e = e.cwiseProduct(matters);
    }
    return e;
  }
};

struct IkSolver::Attempt {
  bool converged = false;
  int iterations = 0;
  double position_error = 0, orientation_error = 0;
};

IkSolver::IkSolver(std::shared_ptr<const RobotModel> model, const JointGroup& group)
    : IkSolver(model, group, model->neutral()) {}

IkSolver::IkSolver(std::shared_ptr<const RobotModel> model, const JointGroup& group,
                   const Eigen::VectorXd& reference)
    : m_model(std::move(model)),
      m_group(group),
      m_chain(*m_model, group, reference),
      m_lower(group.joints.size()),
      m_upper(group.joints.size()),
      m_wraps(group.joints.size()) {
  for (std::size_t i = 0; i < group.joints.size(); ++i) {
    const Joint& joint = m_model->joints()[static_cast<std::size_t>(group.joints[i])];
    const bool limited = std::isfinite(joint.lower) && std::isfinite(joint.upper);
    setLimit(i, limited ? joint.lower : -M_PI, limited ? joint.upper : M_PI);
  }
}

void IkSolver::setLimits(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  LONGARM_REQUIRE(lower.size() == m_chain.size() && upper.size() == m_chain.size(), "limits of the wrong size");
  for (std::size_t i = 0; i < m_lower.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    LONGARM_REQUIRE(std::isfinite(lower[k]) && std::isfinite(upper[k]) && lower[k] <= upper[k], "limits crossed");
    setLimit(i, lower[k], upper[k]);
  }
}

void IkSolver::setLimit(std::size_t i, double lower, double upper) {
  m_lower[i] = lower;
  m_upper[i] = upper;
  const Joint& joint = m_model->joints()[static_cast<std::size_t>(m_group.joints[i])];
  m_wraps[i] = joint.type != JointType::kPrismatic && upper - lower > kTwoPi - 1e-4;
}

Status IkSolver::check(const Pose& goal, const Eigen::VectorXd& seed) const {
  if (!isRigid(goal)) return {ErrorCode::kInvalidInput, "the goal is not a finite pose with a unit rotation"};
  if (seed.size() != m_chain.size() || !seed.allFinite()) {
    return {ErrorCode::kInvalidInput, "the seed has " + std::to_string(seed.size()) + " values; expected " +
                                          std::to_string(m_chain.size()) + " finite ones"};
  }
  return {};
}

void IkSolver::applyLimits(double* q) const {
  for (std::size_t i = 0; i < m_lower.size(); ++i) {
    if (m_wraps[i] && (q[i] < m_lower[i] || q[i] > m_upper[i])) {
      q[i] -= kTwoPi * std::floor((q[i] - m_lower[i]) / kTwoPi);
    }
    q[i] = std::clamp(q[i], m_lower[i], m_upper[i]);
  }
}

template <int kJoints>
IkSolver::Attempt IkSolver::descend(const Goal& goal, double* q, const IkOptions& options) const {
  constexpr int kMax = kJoints == Eigen::Dynamic ? ChainKinematics::kMaxJoints : kJoints;
  const int n = m_chain.size();
  Eigen::Matrix<double, 6, kJoints, Eigen::ColMajor, 6, kMax> J(6, n);
  Eigen::Matrix<double, kJoints, kJoints, Eigen::ColMajor, kMax, kMax> H(n, n);
  Eigen::Matrix<double, kJoints, 1, Eigen::ColMajor, kMax, 1> g(n);
  Eigen::Matrix3d R;
  Eigen::Vector3d p;
  Attempt attempt;
  double damping = 1e-4, last = std::numeric_limits<double>::infinity(), milestone = last;
  int since_milestone = 0;
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    m_chain.forwardAndJacobian(q, R, p, J.data());
    Vector6d e = goal.residual(R, p);
    attempt.orientation_error = e.head<3>().norm();
    attempt.position_error = e.tail<3>().norm();
    attempt.iterations = iteration + 1;
    if (attempt.position_error < options.position_tolerance &&
        attempt.orientation_error < options.orientation_tolerance) {
      attempt.converged = true;
      return attempt;
    }
    if (!goal.all_matter) {
      J.template topRows<3>() = (goal.R.transpose() * J.template topRows<3>()).eval();
      J.template bottomRows<3>() = (goal.R.transpose() * J.template bottomRows<3>()).eval();
      for (int row = 0; row < 6; ++row) J.row(row) *= goal.matters[row];
    }
    e.head<3>() *= kRotationWeight;
    J.template topRows<3>() *= kRotationWeight;
    const double cost = e.squaredNorm();
    if (cost < 0.25 * milestone) {
      milestone = cost;
      since_milestone = 0;
    } else if (++since_milestone > kPatience) {
      return attempt;
    }
    damping = cost < last ? std::max(0.2 * damping, 1e-10) : std::min(5 * damping, 1.0);
    last = cost;
    H.noalias() = J.transpose() * J;
    H.diagonal().array() += damping + 0.02 * cost;
    g.noalias() = J.transpose() * e;
    H.llt().solveInPlace(g);
    const double longest = g.cwiseAbs().maxCoeff();
    const double scale = longest > kLongestStep ? kLongestStep / longest : 1.0;
    for (int i = 0; i < n; ++i) q[i] += scale * g[i];
    applyLimits(q);
  }
  return attempt;
}

IkSolver::Attempt IkSolver::attempt(const Goal& goal, double* q, const IkOptions& options) const {
  applyLimits(q);
  switch (m_chain.size()) {
    case 6: return descend<6>(goal, q, options);
    case 7: return descend<7>(goal, q, options);
    default: return descend<Eigen::Dynamic>(goal, q, options);
  }
}

/// Checked by forward kinematics; joints with room for more than one turn come as near the seed as they can.
IkSolution IkSolver::solution(const Goal& goal, const double* q, const Eigen::VectorXd& seed) const {
  IkSolution found;
  found.joints = Eigen::Map<const Eigen::VectorXd>(q, m_chain.size());
  for (Eigen::Index i = 0; i < found.joints.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!m_wraps[k]) continue;
    const double nearest = found.joints[i] + kTwoPi * std::round((seed[i] - found.joints[i]) / kTwoPi);
    for (const double candidate : {nearest, nearest - kTwoPi, nearest + kTwoPi}) {
      if (candidate < m_lower[k] || candidate > m_upper[k]) continue;
      found.joints[i] = candidate;
      break;
    }
  }
  const Pose reached = m_chain.forward(found.joints.data());
  const Vector6d e = goal.residual(reached.linear(), reached.translation());
  found.orientation_error = e.head<3>().norm();
  found.position_error = e.tail<3>().norm();
  return found;
}

namespace {

Error noSolution(double position_error, double orientation_error, int tries) {
  return {ErrorCode::kNoSolution, "no joint angles within the limits reach this pose: after " +
                                      std::to_string(tries) + " tries the nearest is off by " +
                                      formatFixed(1000 * position_error, 1) + " mm and " +
                                      formatFixed(orientation_error * 180 / M_PI, 2) + " deg"};
}

}  // namespace

Result<IkSolution> IkSolver::solve(const Pose& goal, const Eigen::VectorXd& seed, const IkOptions& options) const {
  if (const Status status = check(goal, seed); !status) return status.error();
  Goal wanted{goal.linear(), goal.translation()};
  for (int i = 0; i < 6; ++i) wanted.matters[i] = options.free[static_cast<std::size_t>(i)] ? 0 : 1;
  wanted.all_matter = wanted.matters.minCoeff() > 0;
  std::array<double, ChainKinematics::kMaxJoints> q{};
  std::copy(seed.data(), seed.data() + seed.size(), q.begin());
  Random random(options.seed);
  Attempt best;
  best.position_error = best.orientation_error = std::numeric_limits<double>::infinity();
  int iterations = 0;
  for (int tries = 1; tries <= options.restarts + 1; ++tries) {
    const Attempt tried = attempt(wanted, q.data(), options);
    iterations += tried.iterations;
    if (tried.converged) {
      IkSolution found = solution(wanted, q.data(), seed);
      found.iterations = iterations;
      found.tries = tries;
      return found;
    }
    const auto size = [](const Attempt& a) { return a.position_error + kRotationWeight * a.orientation_error; };
    if (size(tried) < size(best)) best = tried;
    for (std::size_t i = 0; i < m_lower.size(); ++i) q[i] = random.uniform(m_lower[i], m_upper[i]);
  }
  return noSolution(best.position_error, best.orientation_error, options.restarts + 1);
}

Result<std::vector<IkSolution>> IkSolver::solveAll(const Pose& goal, const Eigen::VectorXd& seed,
                                                   const IkOptions& options, double distinct) const {
  std::vector<IkSolution> found;
  IkOptions single = options;
  single.restarts = 0;
  Random random(options.seed);
  Eigen::VectorXd start = seed;
  Error last;
  for (int i = 0; i <= options.restarts; ++i) {
    auto one = solve(goal, start, single);
    if (one) {
      IkSolution near_seed = solution(Goal{goal.linear(), goal.translation()}, one->joints.data(), seed);
      near_seed.iterations = one->iterations;
      near_seed.tries = i + 1;
      near_seed.position_error = one->position_error;
      near_seed.orientation_error = one->orientation_error;
      const bool known = std::any_of(found.begin(), found.end(), [&](const IkSolution& other) {
        return (other.joints - near_seed.joints).cwiseAbs().maxCoeff() <= distinct;
      });
      if (!known) found.push_back(std::move(near_seed));
    } else if (one.error().code == ErrorCode::kInvalidInput) {
      return one.error();
    } else {
      last = one.error();
    }
    for (Eigen::Index k = 0; k < start.size(); ++k) {
      start[k] = random.uniform(m_lower[static_cast<std::size_t>(k)], m_upper[static_cast<std::size_t>(k)]);
    }
  }
  if (found.empty()) return last;
  std::stable_sort(found.begin(), found.end(), [&](const IkSolution& a, const IkSolution& b) {
    return (a.joints - seed).squaredNorm() < (b.joints - seed).squaredNorm();
  });
  return found;
}

}  // namespace longarm::planning
