#pragma once

/// @file
/// The bundle of two cameras that see the same boards, for the arrow solver.

#include <array>
#include <vector>

#include "calibration/intrinsics/stereo_pair.h"
#include "calibration/solve/arrow_solver.h"

namespace longarm::calibration {

/// Shared parameters: the split increment of T_RL (left to right camera), then the free ones of the left and of the
/// right lens; blocks: the board's pose in the left camera of each pair.
class StereoModel final : public ArrowModel {
 public:
  /// @param pairs Borrowed.
  StereoModel(const std::vector<BoardPair>& pairs, const vision::CameraModel& left, const vision::CameraModel& right,
              const LensMask& left_mask, const LensMask& right_mask, const Pose& T_RL, std::vector<Pose> X_LK);

  int globals() const override { return 6 + static_cast<int>(m_free[0].size() + m_free[1].size()); }
  int blocks() const override { return static_cast<int>(m_pairs->size()); }
  double linearise(ArrowNormal* normal) override;
  std::optional<double> costAfter(const ArrowStep& step) override;
  void accept() override { m_now = m_trial; }

  const Pose& T_RL() const { return m_now.T_RL; }
  const vision::CameraModel& camera(int side) const { return m_now.camera[static_cast<std::size_t>(side)]; }
  void setMasks(const LensMask& left, const LensMask& right) { m_free = {left.indices(), right.indices()}; }
  /// By pair, side (0 left, 1 right) and corner.
  std::vector<std::array<std::vector<double>, 2>>& weights() { return m_weights; }
  Eigen::Vector2d residual(std::size_t pair, int side, std::size_t corner) const;
  int observations() const;
  int pairsUsed() const;

 private:
  struct State {
    std::array<vision::CameraModel, 2> camera;
    Pose T_RL;
    std::vector<Pose> X_LK;
  };
  const std::vector<Corner>& corners(std::size_t pair, int side) const {
    return side == 0 ? (*m_pairs)[pair].left.corners : (*m_pairs)[pair].right.corners;
  }
  void addCorner(std::size_t pair, int side, std::size_t corner, ArrowNormal* normal, double* cost) const;

  const std::vector<BoardPair>* m_pairs;
  std::array<std::vector<int>, 2> m_free;
  State m_now, m_trial;
  std::vector<std::array<std::vector<double>, 2>> m_weights;
};

}  // namespace longarm::calibration
