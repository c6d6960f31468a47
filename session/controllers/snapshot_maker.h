#pragma once

/// @file
/// From stamped frames, or files, to snapshots: the logic without Qt, threads or time.

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "hardware/device.h"
#include "planning/world/workcell.h"
#include "vision/snapshot/view.h"

namespace longarm::session {

/// A frame with the robot's state at its own exposure.
struct StampedFrame {
  std::shared_ptr<const hardware::Frame> frame;
  JointState state;
  std::optional<double> zoom;              ///< Of a camera that zooms.
};

/// The largest joint change between two states, in rad or m, and its joint; joints that only one has are left out.
struct JointChange {
  double change = 0;
  std::string joint;
};
JointChange largestChange(const JointState& a, const JointState& b);

struct PairLimits {
  double max_skew_s = 0.050;               ///< Above this nothing may move between the two exposures.
  double moving_velocity = 0.01;           ///< [rad/s or m/s]
  double moving_change = 0.001;            ///< [rad or m] between the two exposures.
};

/// Whether two pictures may be measured together.
/// @returns kRefused: skew in ms, its limit, the joint that moves, and what to do.
Status checkPair(const StampedFrame& a, const StampedFrame& b, const PairLimits& limits = {});

/// Decodes the picture and places the camera by forward kinematics of its link at the frame's own joint state, and by
/// the camera file's pose where that is given in this link (a calibrated mount).
/// @returns kNotFound (camera or link unknown), kInvalidInput (damaged picture, bad camera file).  Thread-safe.
Result<vision::Snapshot> makeSnapshot(const planning::Workcell& workcell, const StampedFrame& stamped);

/// Camera pose and intrinsics of a workcell's camera at a joint state and a setting of its zoom, for overlays on live
/// pictures.  @returns kNotFound, kOutOfLimits: the camera is not calibrated at this zoom; as CameraCalibration.
Result<vision::View> cameraView(const planning::Workcell& workcell, const std::string& camera,
                                const JointState& state, std::optional<double> zoom = {});

/// A picture from files.
struct PictureFiles {
  std::string name;                        ///< Empty: the picture's file name.
  std::string image;                       ///< Path.
  std::string camera;                      ///< Path of the camera file.
  std::optional<PoseInParent> pose;        ///< Empty: the one in the camera file, which must then have one.
  double sigma_px = 0.5;
};
/// @returns kNotFound, kInvalidInput: file and what is wrong; a picture whose size differs from its camera's.
Result<vision::Snapshot> makeSnapshot(const PictureFiles& files);
/// Every view of a views.yaml that names an image.
Result<std::vector<vision::Snapshot>> makeSnapshots(const std::string& views_yaml);

}  // namespace longarm::session
