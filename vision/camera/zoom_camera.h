#pragma once

/// @file
/// Zoom cameras and the file of SAND2004-6198, Appendix D.

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "core/result.h"
#include "vision/camera/camera_file.h"

namespace longarm::vision {

/// One calibrated setting.
struct ZoomNode {
  double zoom = 0;                       ///< 0 wide ... 1 narrow.
  std::array<double, 9> interior{};      ///< fx fy fxy u0 v0 [px], k1 k2 p1 p2.
  std::array<double, 6> exterior{};      ///< dx dy dz [m] and the rotation vector [rad]: C_ext = [Exp(theta) d], mount to camera.
};

struct ZoomCamera {
  std::string name;
  std::vector<ZoomNode> nodes;           ///< In the file's order.
};

struct ZoomFile {
  /// SR_filename and SR_comment with their texts, in the file's order.
  std::vector<std::pair<std::string, std::string>> headers;
  std::vector<ZoomCamera> cameras;
  std::vector<std::string> warnings;     ///< Unsorted nodes, seven intrinsic values, nominal nodes.
};

/// Reads the XML; the report's quirks are accepted (`0.`, `-0.000`, blanks, braces that touch numbers, text before
/// child elements, unsorted nodes, seven values for nine, several cameras).
/// @returns kNotFound, or kInvalidInput naming setting, element and value with the fix: broken XML, a missing brace,
///   a wrong number of values, decimals with a comma, a setting given twice, focal lengths that are not positive,
///   zoom outside 0 to 1, numbers that are not finite.  Bounded in time and memory.
Result<ZoomFile> readZoomFile(const std::string& path);
Result<ZoomFile> parseZoomFile(std::string_view text);

/// The XML text: elements in the given order, numbers in their shortest form that reads back the same.
/// parseZoomFile(zoomFileText(x)) is x, and its text the same again.
std::string zoomFileText(const ZoomFile& file);
/// Writes beside, then renames.
Status writeZoomFile(const std::string& path, const ZoomFile& file);

/// Placeholder numbers rather than measured ones: fx == fy, no skew, no distortion, principal point in the middle
/// of a picture with whole pixels.
bool isNominal(const ZoomNode& node);

/// Pixel of the mount's z axis at infinity.  Principal point and rotation trade off at narrow fields; this pixel is
/// what stays smooth over zoom.
Eigen::Vector2d boresightOf(const ZoomNode& node);

/// Between nodes: ln fx by monotone cubic over zoom, fy/fx and fxy/fx, distortion, translation and rotation vector
/// likewise; the principal point follows from the interpolated boresight.  Nodes are met exactly.
/// @returns kInvalidInput when there are no nodes or `zoom` lies outside them.  Pure function.
Result<ZoomNode> zoomAt(const ZoomCamera& camera, double zoom);

/// The camera knocked or mounted anew: its optical frame at every setting moves with the mount.
/// @param X_MM  Where the mount frame has gone, in the mount frame it was [m, rad].
void moveMount(const Pose& X_MM, ZoomCamera* camera);

/// The node as a camera file: pose of the optical frame in "<name>_mount".  @returns as validate(CameraModel).
Result<CameraFile> cameraFileOf(const ZoomCamera& camera, const ZoomNode& node);

/// Monotone cubic (Fritsch and Carlson, SIAM J. Numer. Anal. 17, 1980) through (x, y), clamped to its ends.
/// @pre x increases strictly and has the size of y, at least 1.
double monotoneCubic(const std::vector<double>& x, const std::vector<double>& y, double at);

}  // namespace longarm::vision
