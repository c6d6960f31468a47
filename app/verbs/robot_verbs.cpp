// robot info | fk | ik
#include "app/verbs/cli.h"
#include "core/text.h"
#include "planning/robot/ik.h"
#include "planning/robot/robot_model.h"

namespace longarm::app {
namespace {

using planning::JointGroup;
using planning::JointType;
using planning::RobotModel;

struct RobotOptions {
  std::string urdf, srdf, tip, base, joints, pose;
  unsigned seed = 1;
  int most = 16;
};

struct LoadedRobot {
  std::shared_ptr<const RobotModel> model;
  JointGroup group;
};

const char* toString(JointType type) {
  switch (type) {
    case JointType::kFixed: return "fixed";
    case JointType::kRevolute: return "revolute";
    case JointType::kContinuous: return "continuous";
    case JointType::kPrismatic: return "prismatic";
  }
  return "fixed";
}

Result<LoadedRobot> loadRobot(const RobotOptions& options, bool meshes) {
  planning::LoadOptions load;
  load.load_meshes = meshes;
  auto model = RobotModel::load(options.urdf, options.srdf, load);
  if (!model) return model.error();
  const RobotModel& robot = **model;
  const std::string root = robot.links()[static_cast<std::size_t>(robot.rootLink())].name;
  auto group = robot.chain(options.base.empty() ? root : options.base, options.tip);
  if (!group) return Error{group.error().code, options.urdf + ": " + group.error().message};
  return LoadedRobot{*model, *group};
}

PoseInParent inRoot(const RobotModel& model, const Pose& pose) {
  return {model.links()[static_cast<std::size_t>(model.rootLink())].name, pose};
}

// A configuration with the group's joints set; the others stand at neutral.
Result<Eigen::VectorXd> configuration(const LoadedRobot& robot, const std::string& joints) {
  Eigen::VectorXd q = robot.model->neutral();
  if (joints.empty()) return q;
  const auto values = numbersOption("--joints", joints);
  if (!values) return values.error();
  if (values->size() != static_cast<Eigen::Index>(robot.group.joints.size())) {
    return Error{ErrorCode::kInvalidInput, "--joints: " + std::to_string(values->size()) + " values given, the chain to " +
                                               robot.group.tip_link + " has " +
                                               std::to_string(robot.group.joints.size()) + " moving joints"};
  }
  planning::setGroupPositions(*robot.model, robot.group, *values, q);
  return q;
}

nlohmann::json jointJson(const RobotModel& model, const planning::Joint& joint) {
  nlohmann::json j = {{"name", joint.name},
                      {"type", toString(joint.type)},
                      {"parent", model.links()[static_cast<std::size_t>(joint.parent_link)].name},
                      {"child", model.links()[static_cast<std::size_t>(joint.child_link)].name},
                      {"axis", {joint.axis.x(), joint.axis.y(), joint.axis.z()}},
                      {"origin", poseJson({model.links()[static_cast<std::size_t>(joint.parent_link)].name, joint.X_PJ})}};
  if (joint.type == JointType::kRevolute || joint.type == JointType::kPrismatic) {
    j["lower"] = joint.lower;
    j["upper"] = joint.upper;
  }
  if (joint.max_velocity > 0) j["max_velocity"] = joint.max_velocity;
  if (joint.mimic_of >= 0) {
    j["mimic"] = {{"joint", model.joints()[static_cast<std::size_t>(joint.mimic_of)].name},
                  {"multiplier", joint.mimic_multiplier},
                  {"offset", joint.mimic_offset}};
  }
  return j;
}

Result<Answer> runInfo(const RobotOptions& options) {
  const auto robot = loadRobot(options, true);
  if (!robot) return robot.error();
  const RobotModel& model = *robot->model;
  Answer answer;
  answer.json = {{"name", model.name()}, {"tip", robot->group.tip_link}, {"dof", model.dof()},
                 {"warnings", model.warnings()}, {"links", nlohmann::json::array()},
                 {"joints", nlohmann::json::array()}, {"chain", nlohmann::json::array()}};
  for (const auto& link : model.links()) {
    answer.json["links"].push_back({{"name", link.name}, {"visuals", link.visuals.size()}, {"collisions", link.collisions.size()},
        {"parent_joint", link.parent_joint < 0 ? nlohmann::json() : nlohmann::json(model.joints()[static_cast<std::size_t>(link.parent_joint)].name)}});
  }
  for (const auto& joint : model.joints()) answer.json["joints"].push_back(jointJson(model, joint));
  std::vector<std::vector<std::string>> rows = {{"joint", "type", "lower", "upper", "max velocity"}};
  for (const int index : robot->group.joints) {
    const auto& joint = model.joints()[static_cast<std::size_t>(index)];
    answer.json["chain"].push_back(joint.name);
    rows.push_back({joint.name, toString(joint.type), formatFixed(joint.lower, 4), formatFixed(joint.upper, 4),
                    formatFixed(joint.max_velocity, 3)});
  }
  answer.table = model.name() + ": " + std::to_string(model.links().size()) + " links, " +
                 std::to_string(model.dof()) + " moving joints; chain to " + robot->group.tip_link + ":\n" + tableText(rows);
  for (const auto& warning : model.warnings()) answer.table += "warning: " + warning + "\n";
  return answer;
}

Result<Answer> runFk(const RobotOptions& options) {
  const auto robot = loadRobot(options, false);
  if (!robot) return robot.error();
  const auto q = configuration(*robot, options.joints);
  if (!q) return q.error();
  const RobotModel& model = *robot->model;
  std::vector<Pose> poses;
  model.forward(*q, poses);
  const Pose X_RT = poses[static_cast<std::size_t>(*model.linkIndex(robot->group.tip_link))];
  Answer answer;
  answer.json = {{"tip", robot->group.tip_link}, {"pose", poseJson(inRoot(model, X_RT))}, {"links", nlohmann::json::array()}};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    answer.json["links"].push_back({{"name", model.links()[i].name}, {"pose", poseJson(inRoot(model, poses[i]))}});
  }
  const Eigen::Vector3d p = X_RT.translation();
  const Eigen::Vector4d r = quaternionXyzw(X_RT.linear());
  answer.table = robot->group.tip_link + ": xyz " + formatFixed(p.x(), 5) + " " + formatFixed(p.y(), 5) + " " + formatFixed(p.z(), 5) +
                 " m, quaternion xyzw " + formatFixed(r[0], 5) + " " + formatFixed(r[1], 5) + " " + formatFixed(r[2], 5) + " " +
                 formatFixed(r[3], 5) + "\n";
  return answer;
}

Result<Answer> runIk(const RobotOptions& options) {
  const auto robot = loadRobot(options, false);
  if (!robot) return robot.error();
  const auto goal = poseOption("--pose", options.pose);
  if (!goal) return goal.error();
  const auto q = configuration(*robot, options.joints);
  if (!q) return q.error();
  const auto joints = robot->group.joints.size();
  if (joints == 0 || joints > planning::ChainKinematics::kMaxJoints) {
    return Error{ErrorCode::kInvalidInput, "--tip: the chain to " + robot->group.tip_link + " has " + std::to_string(joints) +
                                               " moving joints; 1 to " + std::to_string(planning::ChainKinematics::kMaxJoints) +
                                               " can be solved (choose a nearer --base)"};
  }
  const planning::IkSolver solver(robot->model, robot->group);
  planning::IkOptions ik;
  ik.seed = options.seed;
  const auto solved = solver.solveAll(*goal, planning::groupPositions(*robot->model, robot->group, *q), ik);
  if (!solved && solved.error().code != ErrorCode::kNoSolution) return solved.error();
  auto solutions = solved.valueOr({});
  if (solutions.size() > static_cast<std::size_t>(options.most)) solutions.resize(static_cast<std::size_t>(options.most));
  nlohmann::json json = {{"tip", robot->group.tip_link}, {"solutions", nlohmann::json::array()}};
  std::vector<std::vector<std::string>> rows = {{"joints", "position error m", "orientation error rad"}};
  for (const auto& s : solutions) {
    json["solutions"].push_back({{"joints", vectorJson(s.joints)}, {"position_error", s.position_error},
                                 {"orientation_error", s.orientation_error}});
    std::string text;
    for (const double v : std::vector<double>(s.joints.data(), s.joints.data() + s.joints.size())) text += (text.empty() ? "" : ",") + formatFixed(v, 5);
    rows.push_back({text, formatNumber(s.position_error), formatNumber(s.orientation_error)});
  }
  if (solutions.empty()) {
    return noSolution(json, "no_solution", "no joint angles within the limits bring " + robot->group.tip_link + " to this pose");
  }
  json["status"] = "ok";
  return Answer{json, tableText(rows), kExitDone};
}

void declareRobot(CLI::App& verb, RobotOptions& options) {
  verb.add_option("--urdf", options.urdf, "Robot description")->required();
  verb.add_option("--srdf", options.srdf, "Groups, named poses and disabled collision pairs");
  verb.add_option("--tip", options.tip, "Link at the end of the chain")->required();
  verb.add_option("--base", options.base, "Link at the start of the chain (default: the root)");
}

}  // namespace

Result<Pose> poseOption(const std::string& option, const std::string& text) {
  const auto fail = [&](const std::string& why) {
    return Error{ErrorCode::kInvalidInput, option + ": " + why + "; write x,y,z,qx,qy,qz,qw or {\"xyz\": [..], \"quaternion_xyzw\": [..]}"};
  };
  std::vector<double> n;
  if (!text.empty() && text.find('{') != std::string::npos) {
    const auto json = nlohmann::json::parse(text, nullptr, false);
    for (const char* key : {"xyz", "quaternion_xyzw"}) {
      if (!json.is_object() || !json.contains(key) || !json[key].is_array()) return fail(std::string("has no list ") + key);
      for (const auto& v : json[key]) {
        if (!v.is_number()) return fail(std::string(key) + " holds something that is no number");
        n.push_back(v.get<double>());
      }
    }
  } else {
    const auto numbers = parseNumbers(text);
    if (!numbers) return fail(numbers.error().message);
    n = *numbers;
  }
  if (n.size() != 7) return fail(std::to_string(n.size()) + " numbers given, 7 are needed");
  const Eigen::Vector4d quaternion(n[3], n[4], n[5], n[6]);
  if (!Eigen::Map<Eigen::VectorXd>(n.data(), 7).allFinite() || std::abs(quaternion.norm() - 1) > 1e-2) {
    return fail("the quaternion's length is " + formatNumber(quaternion.norm()) + ", it must be 1");
  }
  return poseFrom({n[0], n[1], n[2]}, quaternion);
}

void addRobotVerbs(Cli& cli) {
  CLI::App* robot = cli.app().add_subcommand("robot", "Read a robot description: info, fk, ik");
  robot->require_subcommand(1);
  cli.addVerb<RobotOptions>(*robot, "info", "Links, joints and the chain to the tip",
                            "longarm robot info --urdf arm.urdf --tip tool0 --json", declareRobot, runInfo);
  cli.addVerb<RobotOptions>(
      *robot, "fk", "Pose of every link for given joints", "longarm robot fk --urdf arm.urdf --tip tool0 --joints=0,-1.57,0,0,1.57,0",
      [](CLI::App& verb, RobotOptions& options) {
        declareRobot(verb, options);
        verb.add_option("--joints", options.joints, "Joint positions from root to tip, comma separated (default: neutral)");
      },
      runFk);
  cli.addVerb<RobotOptions>(
      *robot, "ik", "Joints that bring the tip to a pose", "longarm robot ik --urdf arm.urdf --tip tool0 --pose 0.4,0.1,0.5,0,1,0,0",
      [](CLI::App& verb, RobotOptions& options) {
        declareRobot(verb, options);
        verb.add_option("--pose", options.pose, "Pose of the tip in the root link: x,y,z,qx,qy,qz,qw, or JSON")->required();
        verb.add_option("--joints", options.joints, "Joints to start from");
        verb.add_option("--seed", options.seed, "Seed of the restarts");
        verb.add_option("--most", options.most, "At most this many solutions")->check(CLI::Range(1, 256));
      },
      runIk);
}

}  // namespace longarm::app
