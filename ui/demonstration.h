#pragma once

/// @file
/// Demonstration: does the scenario's task in the real window with a simulated mouse, and takes pictures of it.

#include <array>
#include <string>

#include <Eigen/Core>
#include <QString>

#include "core/result.h"
#include "ui/main_window.h"
#include "ui/simulated_hand.h"

namespace longarm::ui {

struct DemonstrationOptions {
  QString folder;                          ///< For the pictures; empty: none are taken.
  QString scenario = QStringLiteral("grab_pipe");
  double link_timeout_s = 30;
};

/// Works the window as an operator would: events go to its canvases and buttons, nothing is called behind them.  What
/// an operator has and a program lacks is eyes: the places of the pipe's two ends in the pictures are asked of the
/// virtual robot (`/virtual_robot/truth`: the pipe, and where the cameras really are) and projected by the cameras'
/// calibration.  They are used for nothing but where the mouse goes; measuring, planning and grasping know only the
/// marks.  VIRTUAL only.  GUI thread only.
class Demonstration final {
 public:
  Demonstration(MainWindow& window, DemonstrationOptions options);

  /// Runs the event loop until the task is done.  @returns what failed, as a sentence; success only if the gripper
  /// holds the pipe in the end.
  Status run();
  int picturesTaken() const { return m_pictures; }

 private:
  using Ends = std::array<Eigen::Vector3d, 2>;
  struct Truth {
    Ends ends{};                           ///< Of the pipe, in the robot's root frame [m].
    std::array<Pose, 2> X_WC;              ///< Left and right camera.
    std::string held;
  };

  Status waitForLink();
  Status aim();
  Status takePair();
  Status drawLine();
  Status planGrab();
  Status release();
  Status play();
  bool keepPlaying();                      ///< @returns whether the motion is done.
  Status grip();
  Status showSizes();
  Status dragHandle(vision::PaneSide side, int vertex, const Eigen::Vector2d& to);
  Result<Eigen::Vector2d> handle(vision::PaneSide side, int vertex) const;
  Result<Truth> truth() const;
  /// Raw pixel of a point in the picture of this pane's camera.
  Result<Eigen::Vector2d> see(vision::PaneSide side, const Truth& truth, const Eigen::Vector3d& p_W) const;
  bool inPicture(vision::PaneSide side, const Truth& now) const;
  QString panTiltOf(vision::PaneSide side) const;
  void turnTowardsPipe(vision::PaneSide side, const Truth& now);
  Status shoot(const char* name);
  Status shootAt(const QSize& size, const char* name);

  MainWindow& m_window;
  Workbench& m_bench;
  DemonstrationOptions m_options;
  SimulatedHand m_hand{60};
  int m_pictures = 0;
};

}  // namespace longarm::ui
