#pragma once

/// @file
/// A planar arm of three turning joints for collision tests, written as URDF beside the test.

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <unistd.h>

#include "planning/robot/robot_model.h"

namespace longarm::tests {

/// Loads a URDF given as text; the file is removed again.
inline std::shared_ptr<const planning::RobotModel> modelFrom(const std::string& urdf) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("longarm_model_" + std::to_string(::getpid()) + ".urdf");
  std::ofstream(path) << urdf;
  auto model = planning::RobotModel::load(path.string());
  std::filesystem::remove(path);
  return model.ok() ? *model : nullptr;
}

/// Links of 0.5, 0.4 and 0.3 m along x, 10 mm square, turning about z; the three are stacked without touching.
inline std::string planarArmUrdf() {
  const auto link = [](const std::string& name, double length) {
    return "<link name=\"" + name + "\"><collision><origin xyz=\"" + std::to_string(length / 2) +
           " 0 0\"/><geometry><box size=\"" + std::to_string(length) + " 0.01 0.01\"/></geometry></collision></link>";
  };
  const auto joint = [](const std::string& name, const std::string& parent, const std::string& child, double x) {
    return "<joint name=\"" + name + "\" type=\"revolute\"><parent link=\"" + parent + "\"/><child link=\"" + child +
           "\"/><origin xyz=\"" + std::to_string(x) +
           " 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-3\" upper=\"3\" velocity=\"1\" effort=\"1\"/></joint>";
  };
  return "<robot name=\"planar\"><link name=\"base\"/>" + link("one", 0.5) + link("two", 0.4) + link("three", 0.3) +
         "<link name=\"tip\"/>" + joint("j1", "base", "one", 0) + joint("j2", "one", "two", 0.5) +
         joint("j3", "two", "three", 0.4) +
         "<joint name=\"jt\" type=\"fixed\"><parent link=\"three\"/><child link=\"tip\"/><origin xyz=\"0.3 0 0\"/></joint>"
         "</robot>";
}

}  // namespace longarm::tests
