#pragma once

/// @file
/// CameraRig: which cameras take a picture when, and through what lens.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/virtual_robot/joint_servo.h"
#include "core/result.h"
#include "planning/world/workcell.h"
#include "vision/camera/camera_calibration.h"

namespace longarm::virtual_robot {

/// Times are on the robot's clock.  Thread-compatible.
class CameraRig {
 public:
  /// @returns the error of the first camera file that cannot be read.
  static Result<CameraRig> load(const planning::Workcell& workcell);

  bool has(const std::string& camera) const { return m_cameras.count(camera) != 0; }
  std::vector<std::string> names() const;
  bool zooms(const std::string& camera) const;

  /// Takes pictures from now on, no more often than every `least_period_s`; or no more.
  void want(const std::string& camera, bool on, double least_period_s = 0);
  /// Wanted zoom, 0 (wide) ... 1; the lens turns at its own rate.  @returns kNotFound, kInvalidInput.
  Status setZoom(const std::string& camera, double zoom);
  double zoom(const std::string& camera) const;
  /// 0 near (a third of a metre) ... 1 infinity; negative: the camera focuses by itself.  As setZoom.
  Status setFocus(const std::string& camera, double focus);
  double focus(const std::string& camera) const;
  void tick(double seconds);
  /// What the middle of the picture shows is so far away [m]: a camera that focuses by itself turns to it.
  void see(const std::string& camera, double distance_m);
  /// Blur of things at this distance by the focus as it is now, 1 sigma [px]; 0 for a camera without focus.
  double blur_px(const std::string& camera, double distance_m) const;

  /// The lens as it truly is now: by its zoom table; with a plain camera file the focal lengths grow kZoomFactor-fold
  /// from zoom 0 to 1 while the distortion coefficients stay.
  vision::CameraModel lens(const std::string& camera) const;
  /// Optical frame in the camera's link: a zoom lens' entrance pupil wanders.
  Pose mount(const std::string& camera) const;

  /// The cameras of one head that are due, both of a pair together; empty when nothing is.  Their next turn is set
  /// from `now_s`.  Called again, it returns the next head.
  std::vector<std::string> takeDue(double now_s);

  static constexpr double kZoomFactor = 8;
  static constexpr double kPeriod_s = 0.2, kStereoPeriod_s = 0.1;

 private:
  struct Camera {
    planning::CameraSpec spec;
    vision::CameraCalibration calibration;
    std::optional<JointServo> zoom, focus;
    bool self_focusing = true, focused = false;
    bool wanted = false;
    double period_s = kPeriod_s, due_s = 0;
  };
  std::map<std::string, Camera> m_cameras;
};

}  // namespace longarm::virtual_robot
