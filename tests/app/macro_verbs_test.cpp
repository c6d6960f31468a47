// plan, check and list for macros, as a script sees them.
#include <array>
#include <fstream>
#include <vector>

#include <unistd.h>

#include <gtest/gtest.h>

#include "tests/app/command.h"

namespace longarm::tests {
namespace {

std::string fileWith(const std::string& name, const nlohmann::json& content) {
  const std::string path = testing::TempDir() + "macro_verbs_" + std::to_string(::getpid()) + "_" + name;
  std::ofstream(path, std::ios::binary) << content.dump();
  return path;
}

nlohmann::json feature(const std::string& kind, const std::vector<std::array<double, 3>>& points) {
  nlohmann::json vertices = nlohmann::json::array();
  for (const auto& p : points) vertices.push_back({{"xyz", {p[0], p[1], p[2]}}, {"covariance", {1e-6, 0, 0, 0, 1e-6, 0, 0, 0, 1e-6}}});
  return {{"name", "mark"}, {"kind", kind}, {"parent", "base_link"}, {"vertices", vertices}};
}

TEST(MacroVerbs, ListShowsParametersWithUnitsAndRanges) {
  const auto result = longarm("list macros --json");
  ASSERT_EQ(result.exit, 0) << result.err;
  int found = 0;
  const nlohmann::json list = result.json();
  for (const auto& macro : list["macros"]) {
    ASSERT_TRUE(macro["parameters"].is_array());
    if (macro["name"] != "surface_scan") continue;
    EXPECT_EQ(macro["takes"], "plane");
    EXPECT_GT(macro["accuracy_need"].get<double>(), 0);
    for (const auto& p : macro["parameters"]) {
      found += p["name"] == "swath" && p["unit"] == "m" && p["min"] < p["default"] && p["default"] < p["max"] && !p["description"].get<std::string>().empty();
    }
  }
  EXPECT_EQ(found, 1);
  EXPECT_NE(longarm("list macros").out.find("swath = 0.08 m"), std::string::npos);
}

TEST(MacroVerbs, PlanTakesParametersAndTheTrajectoryPassesTheCheck) {
  const std::string plane = fileWith("plane.json", feature("plane", {{0.85, -0.1, 0.42}, {0.85, 0.1, 0.42}, {0.85, 0.1, 0.55}}));
  const std::string out = testing::TempDir() + "macro_verbs_" + std::to_string(::getpid()) + "_t.json";
  const auto result = longarm("plan --macro surface_scan --feature " + plane + " --param swath=0.06 --param speed=0.05 --budget 100 --out " + out + " --json");
  ASSERT_EQ(result.exit, 0) << result.out << result.err;
  const auto json = result.json();
  EXPECT_EQ(json["status"], "ok");
  EXPECT_GE(json["figures"]["coverage"].get<double>(), 0.99);
  EXPECT_NEAR(json["figures"]["speed_highest"].get<double>(), 0.05, 0.001);
  EXPECT_EQ(json["stages"].back()["name"], "scan");
  const auto check = longarm("check --trajectory " + out + " --json");
  EXPECT_EQ(check.exit, 0) << check.out;
  EXPECT_TRUE(check.json()["ok"].get<bool>());
  const auto again = longarm("plan --macro surface_scan --feature " + plane + " --param swath=0.06 --param speed=0.05 --budget 100 --out " + out + "2 --json");
  ASSERT_EQ(again.exit, 0);
  EXPECT_EQ(slurp(out), slurp(out + "2")) << "same input, same seed, same file";
}

TEST(MacroVerbs, PlanRefusesParametersThatAreNone) {
  const std::string point = fileWith("point.json", feature("point", {{0.75, 0.1, 0.45}}));
  for (const char* wrong : {"speed", "stand_off=abc", "no_such=1", "stand_off=9"}) {
    const auto result = longarm("plan --macro touch --feature " + point + " --param " + wrong + " --json");
    EXPECT_EQ(result.exit, 3) << wrong;
    EXPECT_NE(result.err.find("--param"), std::string::npos) << result.err;
  }
  const auto kind = longarm("plan --macro surface_scan --feature " + point + " --json");
  EXPECT_EQ(kind.exit, 4) << kind.out;
  EXPECT_EQ(kind.json()["status"], "bad_feature");
}

TEST(MacroVerbs, AMacroThatCannotBeDoneSaysWhyAndExitsFour) {
  const std::string point = fileWith("far.json", feature("point", {{3, 0, 0.5}}));
  const auto result = longarm("plan --macro move_above --feature " + point + " --json");
  EXPECT_EQ(result.exit, 4);
  const auto json = result.json();
  EXPECT_EQ(json["status"], "unreachable");
  EXPECT_NE(json["reason"].get<std::string>().find("drive"), std::string::npos);
  EXPECT_TRUE(json["failed_pose"].is_object());
}

}  // namespace
}  // namespace longarm::tests
