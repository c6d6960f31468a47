#pragma once

/// @file
/// CameraLibrary: every calibration that was accepted, with its raw data, and which one each thing uses.

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "session/calibration/placement.h"
#include "vision/camera/camera_file.h"
#include "vision/camera/zoom_camera.h"

namespace longarm::session {

/// What a calibration is of.
enum class Subject { kCamera, kPanTilt, kObject };
const char* toString(Subject subject);     ///< "camera", "pan_tilt", "object"

struct CalibrationRecord {
  std::string id;                          ///< Given by add(): time, name, kind.
  std::string workcell;
  Subject subject = Subject::kCamera;
  std::string name;                        ///< Of the camera, pan-tilt or object.
  std::string kind;                        ///< "intrinsics", "fixture", "pose", "lens", "zoom"
  double wall_time_s = 0;                  ///< Seconds since 1970.
  int observations = 0;                    ///< Corners, points or correspondences used.
  double rms_px = 0;
  double uncertainty_px = -1;              ///< Mean over the picture of what the lens leaves open; < 0: not known.
  std::string note;
  std::string file;                        ///< The camera file, or the placement of what is no camera.
  std::string raw;                         ///< What it was made from, for solving again; may be empty.
};

/// A folder of records, each a folder of its own, and one file that says which are in use.  What is damaged is left out
/// and told by warnings().  Thread-compatible.
class CameraLibrary {
 public:
  explicit CameraLibrary(std::string folder);

  const std::string& folder() const { return m_folder; }
  /// Newest first.
  std::vector<CalibrationRecord> records(const std::string& workcell, const std::string& name, Subject subject = Subject::kCamera) const;
  std::optional<CalibrationRecord> find(const std::string& id) const;

  /// Keeps a calibration.  @param raw Text of what it was made from; `raw_ending` such as "csv".
  /// @returns kInvalidInput or kInternal when the folder cannot be written.
  Result<CalibrationRecord> add(CalibrationRecord record, const vision::CameraFile& file, const std::string& raw = {},
                                const std::string& raw_ending = {});
  /// The same for a zoom camera's table.
  Result<CalibrationRecord> add(CalibrationRecord record, const vision::ZoomFile& file, const std::string& raw = {},
                                const std::string& raw_ending = {});
  /// The same for where something stands or is mounted.
  Result<CalibrationRecord> add(CalibrationRecord record, const Placement& placement, const std::string& raw = {},
                                const std::string& raw_ending = {});
  /// Id of the calibration in use; empty: the workcell's own file.
  std::string inUse(const std::string& workcell, const std::string& name, Subject subject = Subject::kCamera) const;
  Status setInUse(const std::string& workcell, const std::string& name, const std::string& id, Subject subject = Subject::kCamera);
  const std::vector<std::string>& warnings() const { return m_warnings; }

 private:
  void read();
  Result<std::string> newFolder(CalibrationRecord* record) const;
  Result<CalibrationRecord> keep(CalibrationRecord record, const std::string& raw, const std::string& raw_ending);

  std::string m_folder;
  std::vector<CalibrationRecord> m_records;                        // oldest first
  std::vector<std::pair<std::string, std::string>> m_in_use;       // "workcell/name" -> id
  std::vector<std::string> m_warnings;
};

}  // namespace longarm::session
