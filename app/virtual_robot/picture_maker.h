#pragma once

/// @file
/// PictureMaker: what a camera sees of the true world.

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "app/virtual_robot/world_snapshot.h"
#include "core/result.h"
#include "planning/world/scenario.h"
#include "planning/world/workcell.h"
#include "vision/camera/camera_model.h"

namespace longarm::virtual_robot {

/// One picture to take.
struct PictureOrder {
  std::string camera;
  vision::CameraModel lens;
  double noise = 0;                      ///< 1 sigma [grey levels]
  unsigned seed = 0;                     ///< Of the noise, with the exposure's time.
  bool dark = false, glare = false;      ///< Faults.
  double blur_px = 0;                    ///< Out of focus, 1 sigma [px].
};

/// A picture as it goes out.
struct Picture {
  std::string camera;
  double time_s = 0;                     ///< Exposure, on the robot's clock.
  vision::CameraModel lens;
  std::string jpeg;
};

/// Renders without a display, bends the picture as the real lens would, adds light faults and noise.  The same
/// snapshot and order give the same picture.  All calls on the thread that created it.
class PictureMaker {
 public:
  /// @returns kInternal when the machine cannot render (no EGL).
  static Result<std::unique_ptr<PictureMaker>> create(const planning::Workcell& workcell,
                                                      const planning::Scenario& scenario);
  ~PictureMaker();

  /// An 8-bit BGR picture of the lens's size.  @returns kInvalidInput for a lens that is not valid, kNotFound for a
  /// camera that is not in the snapshot.
  Result<cv::Mat> render(const WorldSnapshot& world, const PictureOrder& order);
  /// The same as JPEG.
  Result<Picture> take(const WorldSnapshot& world, const PictureOrder& order);

 private:
  PictureMaker();
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace longarm::virtual_robot
