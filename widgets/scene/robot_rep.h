#pragma once

/// @file
/// Draws a robot at its joints; also as a ghost.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "planning/robot/robot_model.h"
#include "widgets/scene/representation.h"

namespace longarm::scene {

struct RobotLook {
  double opacity = 1;                          ///< 0 ... 1; below 1 it is drawn as a ghost.
  std::optional<Eigen::Vector3d> tint;         ///< RGB 0 ... 1 in place of the links' own colours.
  bool show_collision_shapes = false;          ///< Collision instead of visual shapes.
};

/// A robot.  Shapes are made once; update() changes matrices only.
class RobotRep final : public Representation {
 public:
  explicit RobotRep(std::shared_ptr<const planning::RobotModel> model, const RobotLook& look = {});
  ~RobotRep() override;

  /// @param q full configuration.  @pre q.size() == model->dof()
  void update(const Eigen::VectorXd& q);
  /// @param X_WL pose of every link, in the model's order.  @pre as many as links
  void update(const std::vector<Pose>& X_WL);
  /// Changes opacity and tint; show_collision_shapes only counts at construction.
  void setLook(const RobotLook& look);

  const std::shared_ptr<const planning::RobotModel>& model() const;
  /// Link poses drawn last.
  const std::vector<Pose>& linkPoses() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace longarm::scene
