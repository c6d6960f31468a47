#pragma once

/// @file
/// TaskTruth: what the virtual robot's judge knows.

#include <map>
#include <string>
#include <vector>

#include "core/pose.h"
#include "core/result.h"

namespace longarm::session {

/// An answer of /virtual_robot/truth.  Poses are in the world: base_link where the robot started.
struct TaskTruth {
  struct Contact {
    std::string first, second;
    double time_s = 0;                   ///< Robot's clock.
  };
  struct Goal {
    std::string kind, object;
    bool reached = false;
  };
  double time_s = 0;                     ///< Robot's clock.
  std::map<std::string, double> joints;  ///< True positions [rad or m].
  std::map<std::string, Pose> objects;
  std::string held;                      ///< Empty: nothing.
  std::vector<Contact> contacts;
  std::vector<Goal> goals;
  std::map<std::string, Pose> links;     ///< The tool's tip and the cameras' optical frames.
};

/// @returns kInvalidInput naming what is missing.  Pure function.
Result<TaskTruth> parseTruth(const std::string& json);

}  // namespace longarm::session
