#pragma once

/// @file
/// The workcell file: robot, arm, cameras, pan-tilts, devices, limits, fixed objects.  One YAML that an
/// integrator edits; resources/robots/*/workcell.yaml is the example.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base_motion.h"
#include "core/motion.h"
#include "core/result.h"
#include "planning/robot/robot_model.h"
#include "vision/camera/camera_calibration.h"

namespace longarm::planning {

struct GripperSpec {
  std::string joint;                     ///< Actuated finger joint.
  double open = 0, closed = 0;           ///< Joint positions [m or rad].
  double max_width = 0;                  ///< Largest object it takes [m].
  std::vector<std::string> links;        ///< Links allowed to touch what is grasped.
  std::string device;                    ///< Device name of the back end.
};

/// An attitude sensor: which way is up.
struct ImuSpec {
  std::string link;                      ///< Whose frame its orientation is of.
  std::string topic;                     ///< Empty: the driver's usual one.
};

struct PanTiltSpec {
  std::string name;
  std::string pan_joint, tilt_joint;
};

struct CameraSpec {
  std::string name;                      ///< "head_left", ...
  std::string link;                      ///< Optical frame link (x right, y down, z forward).
  std::string calibration;               ///< Absolute path of the camera file.
  std::string pan_tilt;                  ///< Name of the pan-tilt that aims it; empty: none.
  std::string stereo_partner;            ///< Empty, or the other camera of its head.
  std::string role;                      ///< "stereo_left", "stereo_right", "wrist", "drive", "reverse", "ptz"
  double sigma_px = 0.5;
  bool zooms = false;                    ///< Zoom and focus can be commanded.
  vision::DigitalZoom digital_zoom;
  int width = 0, height = 0;             ///< Of its pictures, where the camera file does not say [px]; 0: unknown.
};

/// How a device kind reaches the robot.
struct BackendSpec {
  std::string driver = "rosbridge";      ///< Driver folder under hardware/drivers.
  std::string url;                       ///< e.g. ws://127.0.0.1:9090
  bool is_virtual = false;               ///< Starts longarm-virtual-robot.
  std::map<std::string, std::string> topics;   ///< Overrides of the default topic names.
};

struct Workcell {
  std::string path;                      ///< File it came from.
  std::string name;
  std::shared_ptr<const RobotModel> model;
  JointGroup arm;                        ///< Tip is the tool frame T (z out of the tool).
  MotionLimits arm_limits;               ///< In the order of the arm's joints; for planning and the gate.
  std::optional<GripperSpec> gripper;
  std::optional<BaseLimits> base;  ///< A robot that drives; its root link moves with it.
  std::optional<ImuSpec> imu;            ///< Tells which way is up; without one the root's z is taken for it.
  std::vector<PanTiltSpec> pan_tilts;
  std::vector<CameraSpec> cameras;
  BackendSpec backend;
  std::vector<WorldObject> objects;      ///< Fixed bodies the console knows of.
  std::vector<std::string> templates;    ///< Absolute paths of object templates of one's own, files or folders.
  std::map<std::string, std::map<std::string, double>> poses;   ///< Canned poses: home, stow, ready ... (SRDF's too).
  double max_tool_speed = 0.25;          ///< Cartesian cap of planned motion [m/s].
  double approach_speed = 0.05;          ///< Last leg [m/s].
  std::vector<std::string> warnings;

  std::vector<std::string> armJointNames() const;
  const CameraSpec* camera(const std::string& name) const;   ///< Null if there is none.
};

/// @returns kInvalidInput naming file, line or key, value and what was expected.
Result<Workcell> loadWorkcell(const std::string& path);
/// The built-in robot ("longarm_one"); `variant` empty or "ptz".
Result<Workcell> loadBuiltInWorkcell(const std::string& variant = {});

}  // namespace longarm::planning
