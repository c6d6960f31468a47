#pragma once

/// @file
/// Random features that each macro should manage, cluttered scenes, and the independent look at a finished plan.

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "planning/macros/feature_geometry.h"
#include "planning/macros/macro.h"
#include "planning/motion/check_trajectory.h"
#include "tests/planning/pipe_scene.h"

namespace longarm::tests {

inline vision::Feature featureOf(vision::FeatureKind kind, const std::vector<Eigen::Vector3d>& points, double sigma = 0.001,
                                 const std::string& name = "mark") {
  vision::Feature feature;
  feature.name = name;
  feature.kind = kind;
  for (const auto& p : points) {
    vision::FeatureVertex vertex;
    vertex.xyz = p;
    vertex.covariance = sigma * sigma * Eigen::Matrix3d::Identity();
    feature.vertices.push_back(vertex);
  }
  return feature;
}

/// A point in front of the robot, in the middle of its reach.
inline Eigen::Vector3d randomPlace(planning::Random& random, double near = 0.55, double far = 0.85, double low = 0.3, double high = 0.75) {
  const double distance = random.uniform(near, far), bearing = random.uniform(-0.7, 0.7);
  return {distance * std::cos(bearing), distance * std::sin(bearing), random.uniform(low, high)};
}

inline Eigen::Vector3d randomDirection(planning::Random& random) {
  const double z = random.uniform(-1, 1), a = random.uniform(-M_PI, M_PI), r = std::sqrt(1 - z * z);
  return {r * std::cos(a), r * std::sin(a), z};
}

inline planning::WorldObject boxObject(const std::string& name, const Eigen::Vector3d& size, const Eigen::Vector3d& p) {
  planning::WorldObject object;
  object.name = name;
  object.shape = planning::Box{size};
  object.X_WO.translation() = p;
  return object;
}

/// Three cluttered scenes: posts to either side; a low table with a lamp; a shelf above and a wall behind the arm's work.
inline std::vector<planning::WorldObject> clutter(int scene) {
  switch (scene % 3) {
    case 0:
      return {boxObject("post_left", {0.06, 0.06, 1.2}, {0.55, 0.72, 0.6}), boxObject("post_right", {0.06, 0.06, 1.2}, {0.55, -0.72, 0.6}),
              boxObject("floor", {4, 4, 0.02}, {0, 0, -0.02})};
    case 1:
      return {boxObject("table", {0.5, 1.2, 0.03}, {0.9, 0, 0.12}), boxObject("lamp", {0.05, 0.05, 0.5}, {0.35, 0.62, 0.6}),
              boxObject("floor", {4, 4, 0.02}, {0, 0, -0.02})};
    default:
      return {boxObject("shelf", {0.4, 1.4, 0.03}, {0.8, 0, 1.25}), boxObject("wall", {0.05, 3, 2}, {1.5, 0, 1}),
              boxObject("floor", {4, 4, 0.02}, {0, 0, -0.02})};
  }
}

/// Full configuration of a plan at an instant, the gripper as `q` has it.
inline Eigen::VectorXd planAt(const planning::Workcell& cell, const planning::Plan& plan, double t) {
  Eigen::VectorXd q = plan.start_configuration;
  planning::setGroupPositions(*cell.model, cell.arm, plan.trajectory.sample(t).positions, q);
  return q;
}

inline Pose toolAt(const planning::Workcell& cell, const planning::Plan& plan, double t) {
  return cell.model->forward(planAt(cell, plan, t), *cell.model->linkIndex(cell.arm.tip_link));
}

inline Eigen::VectorXd gripperOpened(const planning::Workcell& cell, Eigen::VectorXd q) {
  const auto joint = cell.model->jointIndex(cell.gripper->joint);
  q[cell.model->joints()[static_cast<std::size_t>(*joint)].q_index] = cell.gripper->open;
  return q;
}

/// The independent sweep.  Gripper links may touch `touched` in stages whose name is no transit.
inline planning::CheckReport sweepOf(const planning::Workcell& cell, const planning::Plan& plan,
                                     const std::vector<planning::WorldObject>& objects, const std::vector<std::string>& touched = {}) {
  planning::CheckOptions options;
  options.objects = objects;
  for (const auto& stage : plan.stages) {
    if (stage.name.find("transit") != std::string::npos) continue;
    for (const auto& name : touched) options.allowed.push_back({name, cell.gripper->links, stage.start_s, stage.end_s});
  }
  const bool open = !touched.empty() && (plan.macro == "grasp_by_faces" || plan.macro == "approach_from_side");
  const Eigen::VectorXd q = open ? gripperOpened(cell, plan.start_configuration) : plan.start_configuration;
  const auto report = planning::checkTrajectory(cell, plan.trajectory, q, options);
  EXPECT_TRUE(report.ok()) << (report.ok() ? "" : report.error().message);
  return report.ok() ? *report : planning::CheckReport{};
}

inline const planning::PlanStage* stageOf(const planning::Plan& plan, const std::string& name) {
  const auto it = std::find_if(plan.stages.begin(), plan.stages.end(), [&](const auto& s) { return s.name == name; });
  return it == plan.stages.end() ? nullptr : &*it;
}

/// The macro of the built-in workcell.
inline const planning::Macro& macroOf(const std::string& name) {
  static const auto macros = planning::makeMacros(builtIn());
  const planning::Macro* macro = planning::findMacro(macros, name);
  if (macro == nullptr) throw std::runtime_error("no macro " + name);
  return *macro;
}

}  // namespace longarm::tests
