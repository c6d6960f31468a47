#pragma once

/// @file
/// CameraCalibration: what a camera's file says of it at every setting of its lens.

#include <optional>
#include <string>

#include "vision/camera/camera_file.h"
#include "vision/camera/zoom_doubt.h"

namespace longarm::vision {

/// The part of a zoom's travel that only enlarges the picture about its middle.
struct DigitalZoom {
  double from = 1;                       ///< Setting at which the lens is at its long end, 0 ... 1; 1: no digital part.
  double factor = 1;                     ///< Enlargement at setting 1, >= 1.
};

/// The camera as its picture enlarged `factor`-fold about the picture's middle.
/// @pre factor > 0 and the camera has a size
CameraModel enlarged(const CameraModel& camera, double factor);

/// A camera file of either kind: one lens, or a table over the setting of a zoom.  Immutable; thread-safe.
///
/// Settings are the whole travel, 0 ... 1.  Up to DigitalZoom::from the table is interpolated; beyond, the model at that
/// place is enlarged, by a factor that grows exponentially as a lens' does.
class CameraCalibration {
 public:
  /// @param width,height of the picture where the file does not say [px]; 0: unknown
  /// @returns as readCameraFile and readZoomFile.
  static Result<CameraCalibration> read(const std::string& path, const DigitalZoom& digital = {}, int width = 0,
                                        int height = 0);

  bool hasTable() const { return m_table.has_value(); }
  /// Settings that are calibrated; {0, 0} where there is one lens only.
  std::pair<double, double> range() const;
  /// Enlargement at a setting against the lowest calibrated one; empty outside the table.
  std::optional<double> magnification(double setting) const;

  /// The camera at a setting of its zoom.  Of a table the pose is the optical frame in "<name>_mount",
  /// and the covariance is what the table leaves open (lensDoubt), where it has three settings or more.
  /// @returns kNotFound: a table, and no setting is given; kOutOfLimits: a setting that is not calibrated.
  Result<CameraFile> at(std::optional<double> setting) const;

 private:
  Result<CameraFile> tableAt(double setting) const;
  Error outside(double setting) const;

  std::string m_path;
  DigitalZoom m_digital;
  int m_width = 0, m_height = 0;
  std::optional<CameraFile> m_file;      // one of the two
  std::optional<ZoomCamera> m_table;
  std::vector<ZoomPrediction> m_predictions;
};

}  // namespace longarm::vision
