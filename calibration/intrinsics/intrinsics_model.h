#pragma once

/// @file
/// The bundle of one camera and the target poses of its views, for the arrow solver.

#include <vector>

#include "calibration/intrinsics/board_view.h"
#include "calibration/solve/arrow_solver.h"
#include "calibration/solve/lens_parameters.h"

namespace longarm::calibration {

/// Shared parameters: the free ones of the lens; blocks: the target's pose in the camera, X_CK, of each view.
/// Residuals are measured minus projected pixels, each with a weight.
class IntrinsicsModel final : public ArrowModel {
 public:
  /// @param views Borrowed; must outlive the model.  @pre One pose per view, every point in front of the camera.
  IntrinsicsModel(const std::vector<BoardView>& views, const vision::CameraModel& camera, std::vector<Pose> X_CK,
                  const LensMask& mask);

  int globals() const override { return static_cast<int>(m_free.size()); }
  int blocks() const override { return static_cast<int>(m_views->size()); }
  double linearise(ArrowNormal* normal) override;
  std::optional<double> costAfter(const ArrowStep& step) override;
  void accept() override;

  const vision::CameraModel& camera() const { return m_now.camera; }
  const std::vector<Pose>& poses() const { return m_now.X_CK; }
  void setMask(const LensMask& mask) { m_free = mask.indices(); }
  void setPose(std::size_t view, const Pose& X_CK) { m_now.X_CK[view] = X_CK; }
  /// Back to an ideal lens.
  void clearDistortion() { m_now.camera.distortion = {}; }
  /// Residuals longer than this count linearly (Huber); 0: plain least squares [px].
  void setHuber(double threshold_px) { m_huber = threshold_px; }
  /// 0 leaves an observation out, 1 is the normal weight; by view and corner.
  std::vector<std::vector<double>>& weights() { return m_weights; }
  const std::vector<std::vector<double>>& weights() const { return m_weights; }
  /// Measured minus projected pixel at the accepted state.
  std::vector<std::vector<Eigen::Vector2d>> residuals() const;
  /// Number of corners with a weight, and of views with such corners.
  int observations() const;
  int viewsUsed() const;
  int lensOffset() const { return 0; }
  int degreesOfFreedom() const { return 2 * observations() - globals() - 6 * viewsUsed(); }

 private:
  struct State {
    vision::CameraModel camera;
    std::vector<Pose> X_CK;
  };
  const std::vector<BoardView>* m_views;
  State m_now, m_trial;
  std::vector<int> m_free;
  std::vector<std::vector<double>> m_weights;
  double m_huber = 0;
};

}  // namespace longarm::calibration
