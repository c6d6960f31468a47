#pragma once

/// @file
/// The scenario file: the virtual world's truth (objects, light), the robot's hidden imperfections, faults and goals.
/// The console never reads the truth of a running scenario; the virtual robot and judges do.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "core/result.h"
#include "planning/world/shape.h"

namespace longarm::planning {

struct Workcell;

/// A place where something that is carried about rests for a while.
struct RouteStop {
  Pose X_WO = Pose::Identity();
  double rest_s = 2;
};

/// A body of the virtual world, in the world frame (base_link where the robot started).
struct ScenarioObject {
  WorldObject body;
  /// "wood", "concrete", "metal", "checker", "carton", "noise", "chessboard" (9 x 6 inner corners of 30 mm on a face of
  /// 0.36 x 0.27 m), "dots" (of 12 mm, 40 mm apart, the first 20 mm from the edges) or empty: plain.
  std::string surface;
  bool graspable = false;                ///< The gripper can close on it (cylinders and boxes).
  bool slides = false;                   ///< Pushed from the side it slides over what it stands on (boxes and cylinders).
  /// Somebody carries it from stop to stop and begins again; empty: it stays at body.X_WO.
  std::vector<RouteStop> route;
  double travel_s = 1;                   ///< From one stop to the next.
  /// Camera that it is held before; empty: the stops are in the world frame.  Else they are in that camera's optical frame
  /// as it stands at the start, and further away by as much as its lens has magnified since: the thing keeps its size in
  /// the picture.
  std::string before;

  /// Where a route brings it.  @pre route is not empty
  Pose onRoute(double time_s) const;
};

/// What the console does not know of the robot.  All drawn from a seed where they say "up to".
struct Imperfections {
  double joint_offset_deg = 0.1;         ///< Constant error of each arm encoder, uniform up to +- this.
  double backlash_deg = 0.02;            ///< Full width of the play of each arm joint.
  double encoder_noise_deg = 0.002;      ///< 1 sigma of each reading.
  double latency_s = 0.02;               ///< From receiving a command to acting on it.
  double image_noise = 2;                ///< 1 sigma [grey levels].
  double odometry_share = 0.01;          ///< Error of the odometry's scale, uniform up to +- this.

  static Imperfections none();           ///< All zero.
};

/// Something that goes wrong; names are those of cli.md (--faults).
struct ScenarioFault {
  std::string name;
  std::optional<double> at_s;            ///< Simulated time; empty: in the middle of the motion.
  double duration_s = 0;                 ///< 0: for good.
  std::string target;                    ///< Camera or joint it strikes; empty: the fault's usual one.
};

/// Bodies that only turn about a hinge or slide along a rail: a door, a valve, a drawer.
struct ScenarioMechanism {
  enum class Kind { kHinge, kSlide } kind = Kind::kHinge;
  std::string name;
  std::vector<std::string> moves;        ///< Objects that it carries.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();   ///< A point of the hinge's axis, in the world [m].
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();    ///< Unit; turns right-handed about it, or slides along it.
  double lower = 0, upper = 0;           ///< From where it starts [rad or m].
  double gives = 0.02;                   ///< A hand further than this from where it must be loses its hold [m].
};

struct ScenarioGoal {
  std::string kind;                      ///< "grasp", "lift", "touch", "open", "move", "no_contact"
  std::string object;                    ///< Or, of "open", the mechanism.
  double amount = 0;                     ///< lift: height above the start [m]; open, move: from the start [rad or m].
};

/// One thing to do: mark something in the pictures, and carry out a macro with it.
struct ScenarioStep {
  std::string object;                    ///< What is marked; empty: the axis of `mechanism`.
  std::string mechanism;
  /// Where to click, in halves of a box's edges (a cylinder: of radius, radius and length) from its middle: 1 point, 2 of a
  /// line, 3 of a plane, 4 of a triad (vertex first).  Empty: the axis of the cylinder or mechanism.
  std::vector<Eigen::Vector3d> at;
  std::string macro;
  std::map<std::string, double> arguments;
  bool close_gripper = false;            ///< Afterwards.
};

struct ScenarioLight {
  Eigen::Vector3d direction{-0.35, 0.25, -1};  ///< The way light travels; normalised on use.
  double intensity = 0.75;                     ///< Of the main light, 0 ... 2.
  double ambient = 0.45;                       ///< Of a fill light, 0 ... 2.
};

/// Where a graspable pipe may lie when drawn by a seed.
struct RandomPipe {
  std::string object, table;             ///< Names in `objects`; its stands are the objects `stands`.
  std::vector<std::string> stands, legs;
  double min_distance = 0.55, max_distance = 0.95;   ///< Of the middle from the base axis [m].
  double max_bearing = 0.8;              ///< [rad]
  double min_height = 0.25, max_height = 0.75;       ///< Of the middle [m].
  double max_slope = 0.05;               ///< [rad]
  double min_length = 0.2, max_length = 0.5;         ///< [m]
  double max_turn = 1.5707963267948966;  ///< Of the pipe from square to the line of sight [rad].
  /// Footprint that table and pipe stay out of: min x, min y, max x, max y [m].
  Eigen::Vector4d keep_clear{-0.6, -0.35, 0.3, 0.35};
};

struct Scenario {
  std::string path;                      ///< File it came from.
  std::string name, title, description;
  std::string robot = "longarm_one";     ///< Built-in robot, or absolute path of a workcell file.
  std::string variant;                   ///< "", "ptz"
  std::vector<ScenarioObject> objects;
  std::vector<ScenarioMechanism> mechanisms;
  ScenarioLight light;
  /// Unit vector against gravity in the world frame: where the robot stands on a slope it is not z.
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  std::string ground = "concrete";       ///< Surface of the ground.
  Imperfections imperfections;
  std::vector<ScenarioFault> faults;
  std::vector<ScenarioGoal> goals;
  std::vector<ScenarioStep> task;        ///< How an operator would do it; empty: by Grab Pipe on what the goals want grasped.
  std::string start_pose = "look_ahead"; ///< Canned pose of the workcell.
  std::map<std::string, double> start_joints;      ///< Joints that start elsewhere than that pose has them [rad or m].
  std::optional<RandomPipe> random_pipe;

  const ScenarioObject* object(const std::string& name) const;         ///< Null if there is none.
  const ScenarioMechanism* mechanism(const std::string& name) const;   ///< Null if there is none.
};

struct ScenarioInfo {
  std::string name, title, description, path;
};

/// The built-in scenarios that exist in resources/scenarios, by name.  Files that cannot be read are left out.
std::vector<ScenarioInfo> listScenarios();

/// @param path_or_name a file (contains '/' or ends in .yaml), or the name of a built-in one.
/// @returns kNotFound (the message lists the built-in ones), or kInvalidInput naming file, key, value and what was expected.
Result<Scenario> loadScenario(const std::string& path_or_name);
/// The same from text; `path` is used in messages and for relative meshes.
Result<Scenario> parseScenario(const std::string& text, const std::string& path);

/// The workcell of the robot that a scenario is for.  @returns as loadWorkcell.
Result<Workcell> workcellOf(const Scenario& scenario);

/// The scenario with its random_pipe drawn by `seed` (0 or no random_pipe: unchanged): the pipe's pose and length, and its
/// table and stands under it.  Same seed, same world.  Pure function.
Scenario randomised(const Scenario& scenario, unsigned seed);

}  // namespace longarm::planning
