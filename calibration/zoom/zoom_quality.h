#pragma once

/// @file
/// How well a zoom table predicts its own nodes.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "vision/camera/zoom_camera.h"

namespace longarm::calibration {

enum class TrafficLight { kGreen, kAmber, kRed };
const char* toString(TrafficLight light);

/// One interior node predicted from all others.
struct ZoomMiss {
  double zoom = 0;
  double focal_error = 0;                                    ///< Predicted over true fx, minus 1.
  Eigen::Vector2d boresight_px = Eigen::Vector2d::Zero();    ///< Predicted minus true, in pixels at this node's zoom.
  /// Root mean square of the misses of nine directions of the mount that fill a 640 x 480 picture about the middle:
  /// focal length, boresight and turn together [px].
  double error_px = 0;
  bool nominal = false;                                      ///< The node looks nominal, not measured (vision::isNominal).
  TrafficLight light = TrafficLight::kGreen;                 ///< Amber beyond 1 % or 3 px of boresight, red beyond 3 % or 10 px.
};

/// Leaves out each node but the first and the last in turn; sorted by zoom.  Fewer than 3 nodes: none.
std::vector<ZoomMiss> leaveOneOut(const vision::ZoomCamera& camera);

/// Zoom settings at which another calibration would help most: the middles of the wider gap beside each node that is
/// not green, worst first.
std::vector<double> advisedSettings(const vision::ZoomCamera& camera, const std::vector<ZoomMiss>& misses);

/// A camera with fixed rotation and principal point moves its boresight in proportion to the focal length.
struct BoresightLaw {
  Eigen::Vector2d principal_point = Eigen::Vector2d::Zero();   ///< Boresight at f = 0 [px].
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();             ///< d boresight / d f: tangents of the misalignment.
  Eigen::Vector2d residual_px = Eigen::Vector2d::Zero();       ///< Root mean square.
  int nodes = 0;
};
/// Straight lines through the boresights of the nodes that are not nominal.  @pre At least two of them.
BoresightLaw boresightLaw(const vision::ZoomCamera& camera);

}  // namespace longarm::calibration
