// Object templates: the sums of their files, the built-in ones against the scenarios they are for, and damaged files.
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/text.h"
#include "planning/macros/macro.h"
#include "planning/macros/macro_arguments.h"
#include "planning/templates/expression.h"
#include "planning/templates/object_template.h"
#include "planning/world/scenario.h"
#include "planning/world/workcell.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

TEST(Expression, WorksOutSumsOfParameters) {
  const std::map<std::string, double> values = {{"width", 0.45}, {"side", -1}, {"a2", 3}};
  const std::pair<const char*, double> good[] = {{"1", 1}, {"-width / 2 + 0.02", -0.205}, {"side * (width / 2 - 0.065)", -0.16},
                                                 {"2 - 3 - 4", -5}, {"12 / 2 / 3", 2}, {"2*-a2", -6}, {"--1", 1}, {"((a2))", 3},
                                                 {"2*cos(0) + sin(0)", 2}};
  for (const auto& [text, value] : good) {
    const auto got = evaluate(text, values);
    ASSERT_TRUE(got.ok()) << text << ": " << got.error().message;
    EXPECT_NEAR(*got, value, 1e-12) << text;
  }
  for (const char* bad : {"", "1 +", "(1", "1)", "height", "1 / 0", "1 2", "width.", "2 ** 3", "cos 1", "1,5", "a b", "1e-3", "1e999", "\xff"}) {
    const auto got = evaluate(bad, values);
    EXPECT_FALSE(got.ok()) << bad;
  }
  EXPECT_FALSE(evaluate(std::string(5000, '('), values).ok());
  EXPECT_FALSE(evaluate(std::string(100, '('), values).ok());
}

const ObjectTemplate& builtIn(const std::string& name) {
  static std::vector<std::string> warnings;
  static const auto all = loadTemplates({}, &warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  for (const auto& each : all) {
    if (each.name() == name) return each;
  }
  ADD_FAILURE() << "no template " << name;
  return all.front();
}

// How the robot sees the scenarios' things: from their front.
Pose faceAt(const Vector3d& origin) {
  Pose out = Pose::Identity();
  out.linear() << -Vector3d::UnitY(), Vector3d::UnitZ(), -Vector3d::UnitX();
  out.translation() = origin;
  return out;
}

TEST(ObjectTemplate, TheDoorIsThatOfTheScenario) {
  const auto door = builtIn("door").instance({});
  ASSERT_TRUE(door.ok()) << door.error().message;
  const auto scenario = *loadScenario("open_door");
  const Pose X_WT = faceAt({0.93, 0, 0.55});
  const auto& leaf = door->parts[0];
  EXPECT_LT(((X_WT * leaf.X_TP).translation() - scenario.object("door")->body.X_WO.translation()).norm(), 1e-9);
  EXPECT_LT(((X_WT * door->parts[1].X_TP).translation() - scenario.object("handle")->body.X_WO.translation()).norm(), 1e-9);
  const auto& hinge = *scenario.mechanism("door_hinge");
  const auto& line = door->features.at("hinge");
  const Vector3d on = X_WT * line.vertices[0].xyz, along = X_WT.linear() * line.direction();
  EXPECT_LT((along - hinge.axis).norm(), 1e-9) << "it opens the same way";
  EXPECT_LT((on - hinge.origin).cross(along).norm(), 0.011) << "about the same axis, to the leaf's thickness";
  // Opened, leaf and handle turn about the hinge; the hinge stays.
  const auto open = builtIn("door").instance({{"opened", 0.5}});
  ASSERT_TRUE(open.ok());
  const Vector3d p = line.vertices[0].xyz, axis = line.direction();
  const Vector3d before = door->parts[1].X_TP.translation() - p, after = open->parts[1].X_TP.translation() - p;
  EXPECT_NEAR(before.cross(axis).norm(), after.cross(axis).norm(), 1e-9);
  EXPECT_NEAR(std::acos(before.cross(axis).normalized().dot(after.cross(axis).normalized())), 0.5, 1e-9);
  EXPECT_GT(after.z(), before.z()) << "towards who looks at it";
  EXPECT_EQ(open->features.at("hinge").vertices[0].xyz, p);
  EXPECT_NEAR((open->features.at("handle").vertices[0].xyz - p).norm(), (door->features.at("handle").vertices[0].xyz - p).norm(), 1e-9);
}

TEST(ObjectTemplate, HingedOnTheRightItOpensTowardsWhoLooksAtItToo) {
  const auto shut = builtIn("door").instance({{"hinge_left", -1}}), open = builtIn("door").instance({{"hinge_left", -1}, {"opened", 0.5}});
  ASSERT_TRUE(shut.ok() && open.ok());
  EXPECT_LT(shut->parts[1].X_TP.translation().x(), 0);
  EXPECT_GT(open->parts[1].X_TP.translation().z(), shut->parts[1].X_TP.translation().z());
}

TEST(ObjectTemplate, ValveAndDrawerAreThoseOfTheScenarios) {
  const auto wheel = builtIn("valve").instance({{"pieces", 6}});
  ASSERT_TRUE(wheel.ok()) << wheel.error().message;
  const auto turn_valve = *loadScenario("turn_valve");
  const Pose X_WV = faceAt({0.86, 0, 0.6});
  const auto& rim = turn_valve.object("rim_1")->body;
  double nearest = 1;
  for (const auto& part : wheel->parts) nearest = std::min(nearest, ((X_WV * part.X_TP).translation() - rim.X_WO.translation()).norm());
  EXPECT_LT(nearest, 1e-3);
  const auto& grip = wheel->features.at("grip");
  const Vector3d middle = X_WV * Vector3d((grip.vertices[0].xyz + grip.vertices[1].xyz) / 2);
  EXPECT_LT((middle - rim.X_WO.translation()).norm(), 1e-3);
  EXPECT_LT((X_WV.linear() * wheel->features.at("axle").direction() - turn_valve.mechanism("wheel")->axis).norm(), 1e-9);

  const auto drawer = builtIn("drawer").instance({});
  ASSERT_TRUE(drawer.ok());
  const auto pull_drawer = *loadScenario("pull_drawer");
  const Pose X_WD = faceAt({0.89, 0, 0.53});
  const auto& handle = drawer->features.at("handle");
  EXPECT_LT((X_WD * Vector3d((handle.vertices[0].xyz + handle.vertices[1].xyz) / 2) - pull_drawer.object("handle")->body.X_WO.translation()).norm(), 1e-9);
  const auto pulled = builtIn("drawer").instance({{"pulled", 0.1}});
  EXPECT_NEAR(pulled->parts[0].X_TP.translation().z() - drawer->parts[0].X_TP.translation().z(), 0.1, 1e-12);
}

// What a template hands to a macro, the macro takes.
TEST(ObjectTemplate, EveryStepFitsItsMacro) {
  const auto cell = loadBuiltInWorkcell();
  ASSERT_TRUE(cell.ok());
  const auto macros = makeMacros(*cell);
  const auto all = loadTemplates({});
  EXPECT_GE(all.size(), 5u);
  for (const auto& each : all) {
    const auto made = each.instance({});
    ASSERT_TRUE(made.ok()) << made.error().message;
    EXPECT_FALSE(made->actions.empty()) << each.name();
    for (const auto& action : made->actions) {
      for (const auto& step : action.steps) {
        if (step.kind != TemplateStep::Kind::kMacro) continue;
        const auto* macro = findMacro(macros, step.macro);
        ASSERT_NE(macro, nullptr) << step.macro;
        EXPECT_EQ(macro->info().takes, made->features.at(step.feature).kind) << each.name() << " " << step.macro;
        const auto arguments = MacroArguments::from(macro->info(), step.arguments);
        EXPECT_TRUE(arguments.ok()) << arguments.error().message;
      }
    }
  }
}

TEST(ObjectTemplate, RefusesParametersOutOfTheirRange) {
  const auto wide = builtIn("door").instance({{"width", 30}});
  ASSERT_FALSE(wide.ok());
  EXPECT_EQ(wide.error().code, ErrorCode::kOutOfLimits);
  EXPECT_NE(wide.error().message.find("30"), std::string::npos) << wide.error().message;
  EXPECT_EQ(builtIn("door").instance({{"colour", 1}}).error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(builtIn("door").instance({{"width", std::nan("")}}).ok());
}

class TemplateFiles : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(m_folder); }
  void TearDown() override { fs::remove_all(m_folder); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(m_folder / name) << text;
    return (m_folder / name).string();
  }
  const fs::path m_folder = fs::temp_directory_path() / ("longarm_templates_" + std::to_string(::getpid()));
};

constexpr const char* kHatch = R"(format: 1
name: hatch
parameters: [{name: edge, value: 0.3, range: [0.1, 1]}]
bodies: [{name: lid, box: [edge, edge, 0.02], moves: true}]
features: [{name: hinge, kind: line, p0: [-edge / 2, 0, 0], p1: [edge / 2, 0, 0]}]
mechanism: {hinge: hinge, by: edge}
actions: [{name: lift, steps: [{macro: move_around_axis, feature: hinge, arguments: {angle: 0.5}}]}]
)";

TEST_F(TemplateFiles, OfOnesOwnStandBesideTheBuiltInOnes) {
  write("hatch.yaml", kHatch);
  write("broken.yaml", "format: 1\nname: broken\n");
  std::vector<std::string> warnings;
  const auto all = loadTemplates({m_folder.string()}, &warnings);
  EXPECT_TRUE(std::any_of(all.begin(), all.end(), [](const auto& t) { return t.name() == "hatch"; }));
  EXPECT_TRUE(std::any_of(all.begin(), all.end(), [](const auto& t) { return t.name() == "door"; }));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings.front().find("broken.yaml"), std::string::npos);
}

TEST_F(TemplateFiles, DamagedOnesAreToldInASentence) {
  const std::string good = kHatch;
  ASSERT_TRUE(ObjectTemplate::load(write("good.yaml", good)).ok());
  const auto without = [&](const std::string& what, const std::string& instead) {
    std::string text = good;
    const auto at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), instead);
  };
  const std::pair<std::string, const char*> bad[] = {
      {without("box: [edge, edge, 0.02]", "box: [edge, edge]"), "lid"},
      {without("box: [edge, edge, 0.02]", "box: [edge, wide, 0.02]"), "wide"},
      {without("box: [edge, edge, 0.02]", "box: [edge, edge, -0.02]"), "lid"},
      {without("box: [edge, edge, 0.02]", "box: [1, 1, 1], sphere: [1]"), "exactly one"},
      {without("hinge: hinge", "hinge: axle"), "axle"},
      {without("by: edge", "by: angle"), "angle"},
      {without("feature: hinge", "feature: lid"), "lid"},
      {without("range: [0.1, 1]", "range: [0.4, 1]"), "range"},
      {without("kind: line", "kind: curve"), "kind"},
      {without("p1: [edge / 2, 0, 0]", "p1: [-edge / 2, 0, 0]"), "hinge"},
      {without("name: lift", "names: lift"), "name"},
      {"[1, 2", "YAML"}};
  for (const auto& [text, expected] : bad) {
    const auto read = ObjectTemplate::load(write("bad.yaml", text));
    ASSERT_FALSE(read.ok()) << text;
    EXPECT_NE(read.error().message.find(expected), std::string::npos) << read.error().message;
  }
  EXPECT_EQ(ObjectTemplate::load((m_folder / "absent.yaml").string()).error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace longarm::planning
