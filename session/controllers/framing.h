#pragma once

/// @file
/// Which pan, tilt and zoom make some points fill a camera's picture.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "session/controllers/aimed_camera.h"
#include "vision/snapshot/view.h"

namespace longarm::session {

struct FramingWish {
  double fill = 0.85;                      ///< Part of the picture's width or height that the points may take.
  bool may_zoom = true;
};

struct Framing {
  PanTiltAngles angles;                    ///< Within the joints' limits.
  std::optional<double> zoom;              ///< Empty: the camera has none.
  std::string shortfall;                   ///< What could not be had, and why; empty: all of it.
};

/// Turns the middle of the points' outline to the middle of the picture, and zooms as far in as they still fit.
/// @param points_W  in the robot's root frame, at least one [m]
/// @param zoom_now  setting of the camera's zoom; empty for a camera without
/// @returns kInvalidInput without points, kNotFound (no pan-tilt aims the camera), kDegenerate (along the pan axis); as
///   CameraCalibration.  Pure function.
Result<Framing> frame(const planning::Workcell& workcell, const planning::CameraSpec& camera,
                      const std::vector<Eigen::Vector3d>& points_W, const JointState& now, std::optional<double> zoom_now,
                      const FramingWish& wish);

/// The outline of a rectangle of a picture as points at this distance from the camera [m].
/// @returns as CameraModel::rayOfPixel.
Result<std::vector<Eigen::Vector3d>> regionAt(const vision::View& view, const Eigen::Vector2d& corner,
                                              const Eigen::Vector2d& opposite, double distance_m);

/// The larger of the parts of the picture's width and height, from its middle, that the points reach to; more than 1: not
/// all of them are seen.  Points behind the camera count as 10.
double spread(const vision::View& view, const std::vector<Eigen::Vector3d>& points_W);

}  // namespace longarm::session
