#pragma once

/// @file
/// The built-in robot in front of pipes, for tests of macros.

#include <cmath>

#include <gtest/gtest.h>

#include "planning/macros/macro.h"
#include "planning/motion/random.h"
#include "planning/world/workcell.h"

namespace longarm::tests {

/// The built-in workcell, loaded once.
inline const planning::Workcell& builtIn() {
  static const planning::Workcell cell = [] {
    auto loaded = planning::loadBuiltInWorkcell();
    EXPECT_TRUE(loaded.ok()) << (loaded.ok() ? "" : loaded.error().message);
    return loaded.ok() ? *loaded : planning::Workcell{};
  }();
  return cell;
}

/// Full configuration of a canned pose.
inline Eigen::VectorXd configuration(const planning::Workcell& cell, const std::string& pose) {
  Eigen::VectorXd q = cell.model->neutral();
  JointState state;
  const auto& joints = cell.poses.at(pose);
  state.positions.resize(static_cast<Eigen::Index>(joints.size()));
  Eigen::Index i = 0;
  for (const auto& [name, value] : joints) {
    state.names.push_back(name);
    state.positions[i++] = value;
  }
  cell.model->assign(state, q);
  return q;
}

inline vision::Feature lineFeature(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double sigma = 0.002) {
  vision::Feature feature;
  feature.name = "pipe";
  feature.kind = vision::FeatureKind::kLine;
  feature.parent = "base_link";
  for (const auto& p : {a, b}) {
    vision::FeatureVertex vertex;
    vertex.xyz = p;
    vertex.covariance = sigma * sigma * Eigen::Matrix3d::Identity();
    feature.vertices.push_back(vertex);
  }
  return feature;
}

/// A near-horizontal pipe as the verb `plan` must serve: 0.2-0.5 m long, its middle 0.55-0.95 m from base_link
/// within 0.8 rad of straight ahead at heights 0.25-0.75 m; any heading, at most 0.15 rad off level.
inline vision::Feature randomPipe(planning::Random& random) {
  const double distance = random.uniform(0.55, 0.95), bearing = random.uniform(-0.8, 0.8);
  const double heading = random.uniform(-M_PI, M_PI), slope = random.uniform(-0.15, 0.15);
  const double half = 0.5 * random.uniform(0.2, 0.5);
  const Eigen::Vector3d middle(distance * std::cos(bearing), distance * std::sin(bearing), random.uniform(0.25, 0.75));
  const Eigen::Vector3d d(std::cos(heading) * std::cos(slope), std::sin(heading) * std::cos(slope), std::sin(slope));
  return lineFeature(middle - half * d, middle + half * d);
}

inline planning::PlanContext contextOf(const planning::Workcell& cell, const std::string& start = "home") {
  planning::PlanContext context;
  context.workcell = &cell;
  context.start = configuration(cell, start);
  return context;
}

}  // namespace longarm::tests
