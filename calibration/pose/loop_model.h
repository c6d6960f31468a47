#pragma once

/// @file
/// The transform loop as an arrow problem.

#include <array>
#include <optional>
#include <vector>

#include "calibration/pose/transform_loop.h"
#include "calibration/solve/arrow_solver.h"
#include "calibration/solve/lens_parameters.h"

namespace longarm::calibration {

/// Values of the unknowns.  The object's transform is held as its inverse, as it stands in the loop.
struct LoopState {
  vision::CameraModel camera;
  std::array<Pose, 3> T = {Pose::Identity(), Pose::Identity(), Pose::Identity()};  ///< T_ext, T_dev, T_obj^-1.
  std::vector<Pose> T_kin;                                                         ///< Of each view, corrected.
};

/// Errors of the aiming device's pose, per view, as a prior.
struct KinPrior {
  double sigma_rad = 0, sigma_m = 0;     ///< Per axis, of the split increment of T_kin.
};

/// Shared parameters: six of each unknown transform in the order T_ext, T_dev, T_obj^-1, then the free ones of the
/// lens.  Blocks: a correction of T_kin per view, only with a prior.
class LoopModel final : public ArrowModel {
 public:
  /// @param problem Borrowed; must outlive the model.
  /// @param sigma_px Divides the residuals; 1 leaves them in pixels.
  LoopModel(const LoopProblem& problem, const std::vector<LoopUnknown>& unknowns, const LoopState& start,
            const LensMask& lens = {}, const std::optional<KinPrior>& prior = {}, double sigma_px = 1);

  int globals() const override { return lensOffset() + static_cast<int>(m_free.size()); }
  int blocks() const override { return m_prior ? static_cast<int>(m_problem->views.size()) : 0; }
  double linearise(ArrowNormal* normal) override;
  std::optional<double> costAfter(const ArrowStep& step) override;
  void accept() override { m_now = m_trial; }

  const LoopState& state() const { return m_now; }
  const vision::CameraModel& camera() const { return m_now.camera; }
  void setMask(const LensMask& mask) { m_free = mask.indices(); }
  /// Number of shared pose parameters: where those of the lens begin.
  int lensOffset() const { return 6 * static_cast<int>(m_poses.size()); }
  int degreesOfFreedom() const { return 2 * observations() - globals(); }
  int observations() const;
  /// 0 leaves an observation out, 1 is the normal weight; by view and point.
  std::vector<std::vector<double>>& weights() { return m_weights; }
  const std::vector<std::vector<double>>& weights() const { return m_weights; }
  /// Loss of long residuals, in units of sigma_px: Huber's, or Cauchy's, which forgets them.
  enum class Loss { kSquares, kHuber, kCauchy };
  void setLoss(Loss loss, double threshold) {
    m_loss = loss;
    m_threshold = threshold;
  }
  /// Lowers the weights of points whose own place is uncertain, at the present state.
  void weighPointUncertainty(double sigma_px);

  /// A point in the camera's frame.
  Eigen::Vector3d pointInCamera(std::size_t view, std::size_t point) const { return chain(m_now, view, m_problem->views[view].points[point].xyz).back(); }
  /// Whether every point with a weight is in front of the camera.
  bool allInFront() const;
  /// Measured minus projected pixel; infinite behind the camera.
  Eigen::Vector2d residual(std::size_t view, std::size_t point) const;
  /// d pixel / d shared parameters (2 x globals) [px].
  Eigen::MatrixXd jacobian(std::size_t view, std::size_t point) const;

 private:
  // x, T_obj^-1 x, T_dev .., T_kin .., T_ext ..
  std::array<Eigen::Vector3d, 5> chain(const LoopState& state, std::size_t view, const Eigen::Vector3d& x) const;
  // The transform at link 0 T_obj^-1, 1 T_dev, 2 T_kin, 3 T_ext of a view.
  Pose link(const LoopState& state, std::size_t view, int at) const;
  bool fill(std::size_t view, std::size_t point, Eigen::Vector2d* pixel, Eigen::MatrixXd* J,
            Eigen::Matrix<double, 2, 6>* J_kin) const;
  double loss(double squares, double* weight) const;
  double priorCost(const LoopState& state, std::size_t view, Vector6d* residual) const;

  const LoopProblem* m_problem;
  std::vector<int> m_poses;              // links that are unknown, in the order of the parameters
  std::vector<int> m_free;
  LoopState m_now, m_trial;
  std::optional<KinPrior> m_prior;
  double m_sigma;
  std::vector<std::vector<double>> m_weights;
  Loss m_loss = Loss::kSquares;
  double m_threshold = 0;
};

}  // namespace longarm::calibration
