#pragma once

/// @file
/// SimulatedOperator: what an operator does in the window, by mouse alone; for the demonstration and for
/// tests.

#include <functional>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <QString>

#include "core/result.h"
#include "session/task/task_truth.h"
#include "ui/main_window.h"
#include "ui/simulated_hand.h"

namespace longarm::ui {

/// What an operator has and a program lacks is eyes: where things are is asked of the virtual robot
/// (`/virtual_robot/truth`: objects, and where the cameras really are) and projected by the cameras'
/// calibration.  It is used for nothing but where the mouse goes; measuring, planning and grasping know only
/// the marks.  VIRTUAL only.  GUI thread only; every call runs the event loop.
class SimulatedOperator final {
 public:
  using Points =
      std::vector<Eigen::Vector3d>;  ///< In the world frame: the robot's root where it started [m].

  /// What the virtual robot's judge knows; with the cameras of both panes among its links.
  using Truth = session::TaskTruth;

  SimulatedOperator(MainWindow& window, int pause_ms)
      : m_window(window), m_bench(window.bench()), m_hand(pause_ms) {}

  /// All return kNoSolution with a sentence when it does not come about in time.
  Status waitForLink(double timeout_s);
  Result<Truth> look() const;
  /// Raw pixel of a point in the picture of this pane's camera.
  Result<Eigen::Vector2d> see(vision::PaneSide side, const Truth& now, const Eigen::Vector3d& p_W) const;
  /// Brings points into both live pictures; they may depend on what is seen.
  Status aim(const std::function<Result<Points>()>& points);
  Status takePair();
  /// Chooses the tool and drags its handles onto the points, in the left picture, then in the right.
  /// @param between  Called after each picture; may be empty.  @param off_curve  With Ctrl in the right picture: where
  /// things are seen, even off the epipolar curve.
  Status mark(ActionId tool, const Points& points, const std::function<Status(vision::PaneSide)>& between = {},
              bool off_curve = false);
  /// Presses the motion's button and waits for its plan.
  Status plan(const QString& macro, double timeout_s);
  Status resetStop();
  Status openGripper();
  /// Presses Play as often as it takes: on a busy machine the watchdogs may stop the arm on its way, and when
  /// it then stands beside its path the console asks for a new plan.  @returns whether the motion is done.
  bool keepPlaying();
  /// Clicks the visible button of an action.
  Status click(ActionId action);

  /// From now on marks are off by a hand's tremble, normal with this sigma in each direction [px].
  void setTremble(double sigma_px, unsigned seed);
  SimulatedHand& hand() { return m_hand; }

 private:
  Pose cameraPose(vision::PaneSide side, const Truth& now) const;
  bool inPicture(vision::PaneSide side, const Truth& now, const Points& points) const;
  QString panTiltOf(vision::PaneSide side) const;
  void turnTowards(vision::PaneSide side, const Truth& now, const Eigen::Vector3d& p_W);
  Result<Eigen::Vector2d> handle(vision::PaneSide side, int vertex, int vertices) const;
  Status dragHandle(vision::PaneSide side, int vertex, int vertices, const Eigen::Vector2d& to,
                    Qt::KeyboardModifiers keys);

  MainWindow& m_window;
  Workbench& m_bench;
  SimulatedHand m_hand;
  double m_tremble_px = 0;
  std::mt19937_64 m_random;
};

}  // namespace longarm::ui
