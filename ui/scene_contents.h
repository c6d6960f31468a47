#pragma once

/// @file
/// SceneContents: what stands in the 3-D scene, kept in step with document and robot.

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "session/controllers/held_controller.h"
#include "session/document/document.h"
#include "session/tools/sketch_tool.h"
#include "widgets/scene/dimension_rep.h"
#include "widgets/scene/frustum_rep.h"
#include "widgets/scene/ground_grid_rep.h"
#include "widgets/scene/plan_rep.h"
#include "widgets/scene/robot_rep.h"
#include "widgets/scene/sketch_rep.h"
#include "widgets/scene/world_rep.h"
#include "widgets/scene_view.h"

namespace longarm::ui {

/// One representation per kind of thing.  Nothing renders by itself: call SceneView::requestRender() afterwards.
/// GUI thread only.
class SceneContents final {
 public:
  explicit SceneContents(vtkRenderer* renderer);
  ~SceneContents();

  /// Builds robot, plan and fixed objects; null takes them away.
  void setWorkcell(std::shared_ptr<const planning::Workcell> workcell);
  /// Null: none.
  std::shared_ptr<const planning::RobotModel> robot() const { return m_workcell ? m_workcell->model : nullptr; }
  /// Measured joints; null: unknown, the robot is then drawn as a ghost.
  /// @returns whether the robot looks any different.
  bool setJoints(const JointState* joints);
  void setSketch(const session::Document& document);
  /// Bodies that were added to the world, and only those that are shown; what is held is drawn at the tool, what
  /// is stale where odometry has it.
  void setWorld(const session::Document& document, const std::optional<session::HeldBody>& held);
  /// What the measure tool measured; empty: nothing.  @returns whether it differs from what was shown.
  bool setDimension(const std::optional<session::SceneDimension>& dimension);
  void setPlan(const session::Document& document);
  /// Shows the ghost there, unless the robot itself stands there.
  void setCursor(double t_s);
  void setPicture(vision::PaneSide side, const std::optional<vision::View>& view, const cv::Mat& picture);
  void setOpacity(double opacity);

  Eigen::AlignedBox3d everything() const;
  /// Around the selected features, a hand wider; empty when nothing measured is selected.
  Eigen::AlignedBox3d selection(const session::Document& document) const;
  std::vector<widgets::Pickable> pickables(const session::Document& document) const;

 private:
  void refreshGhost();
  void placeBodies();

  vtkRenderer* m_renderer;
  std::shared_ptr<const planning::Workcell> m_workcell;
  std::unique_ptr<scene::RobotRep> m_robot;
  std::unique_ptr<scene::PlanRep> m_plan;
  std::unique_ptr<scene::WorldRep> m_world;
  scene::GroundGridRep m_grid;
  scene::AxesRep m_axes;
  scene::SketchRep m_sketch;
  scene::DimensionRep m_dimension;
  std::optional<session::SceneDimension> m_measured;
  scene::WorldRep m_sketched_world;
  std::vector<planning::WorldObject> m_bodies;   // What that shows.
  std::string m_held;                      // Name of the body that is held; it is drawn once.
  std::map<std::string, Pose> m_link_poses;
  std::array<scene::FrustumRep, 2> m_frustums;
  double m_opacity = 0.8;
  bool m_ghost = false;
  Eigen::VectorXd m_drawn;                 // Configuration drawn; empty: none yet.
  Trajectory m_trajectory;                 // Of the plan shown; empty: none.
  double m_cursor_s = 0;
};

}  // namespace longarm::ui
