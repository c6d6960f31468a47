// The headless contract, measured from outside: exit status, one JSON object, shapes of the answers.
#include <cmath>
#include <fstream>
#include <set>

#include <unistd.h>

#include <gtest/gtest.h>

#include "core/text.h"
#include "tests/app/command.h"
#include "tests/support/test_data.h"
#include "tests/vision/painted_wall.h"
#include "vision/snapshot/image_file.h"
#include "vision/snapshot/views_file.h"

namespace longarm::tests {
namespace {

std::string scratch(const std::string& name, const std::string& content) {
  const std::string path = testing::TempDir() + "cli_" + std::to_string(::getpid()) + "_" + name;
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

// Two ideal cameras 0.25 m apart, f = 800, looking along x of base_link from 1 m above the ground.
std::string stereoViews() {
  const std::string camera = scratch("camera.yaml",
      "image_width: 640\nimage_height: 1000\ncamera_name: test\n"  // tall: it looks down on what stands near
      "camera_matrix: {rows: 3, cols: 3, data: [800, 0, 320, 0, 800, 240, 0, 0, 1]}\n"
      "distortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n");
  const auto view = [&](const std::string& name, double y) {
    return "  - name: " + name + "\n    camera: " + camera + "\n    pose: {parent: base_link, xyz: [0, " + formatNumber(y) +
           ", 1], quaternion_xyzw: [-0.5, 0.5, -0.5, 0.5]}\n";
  };
  return scratch("views.yaml", "views:\n" + view("left", 0.125) + view("right", -0.125));
}

// Pixel of a point in base_link in one of the cameras above.
std::string pick(const std::string& feature, const std::string& kind, int vertex, double x, double y, double z) {
  std::string rows;
  for (const double at : {0.125, -0.125}) {
    const double u = 320 - 800 * (y - at) / x, v = 240 - 800 * (z - 1) / x;
    rows += feature + "," + kind + "," + std::to_string(vertex) + "," + (at > 0 ? "left" : "right") + "," + formatNumber(u) + "," +
            formatNumber(v) + "\r\n";
  }
  return rows;
}

std::string pipePicks() {
  return scratch("picks.csv", "feature,kind,vertex,view,u,v\r\n" + pick("pipe", "line", 0, 0.75, 0.15, 0.45) +
                                  pick("pipe", "line", 1, 0.75, -0.15, 0.45) + pick("dot", "point", 0, 2, 0.1, 0.8));
}

TEST(Cli, HelpVersionAndWrongUsage) {
  EXPECT_EQ(longarm("--help").exit, 0);
  const auto version = longarm("--version");
  EXPECT_EQ(version.exit, 0);
  EXPECT_EQ(version.out.rfind("longarm ", 0), 0u) << version.out;
  EXPECT_EQ(longarm("frobnicate").exit, 2);
  EXPECT_EQ(longarm("target").exit, 2) << "required options are missing";
  for (const char* verb : {"target", "epipolar", "undistort", "robot info", "robot fk", "robot ik", "plan", "check", "run", "list"}) {
    const auto help = longarm(std::string(verb) + " --help");
    EXPECT_EQ(help.exit, 0) << verb;
    EXPECT_NE(help.out.find("Example"), std::string::npos) << verb << " has an example in its help";
  }
}

TEST(Cli, WithoutADisplayTheConsoleSaysSoAndEnds) {
  const auto result = longarm("");
  EXPECT_EQ(result.exit, 2);
  EXPECT_TRUE(result.err.find("no display") != std::string::npos || result.err.find("no window") != std::string::npos) << result.err;
}

TEST(Cli, CompletionNamesEveryVerb) {
  const auto script = longarm("completion").out;
  for (const char* word : {"target", "epipolar", "undistort", "robot", "plan", "check", "list", "run", "--views"}) {
    EXPECT_NE(script.find(word), std::string::npos) << word;
  }
}

TEST(Cli, TargetMeasuresPointsAndLines) {
  const auto result = longarm("target --views " + stereoViews() + " --picks " + pipePicks() + " --json");
  ASSERT_EQ(result.exit, 0) << result.err;
  const auto json = result.json();
  ASSERT_TRUE(json.is_object()) << result.out;
  ASSERT_EQ(json["features"].size(), 2u);
  const auto& pipe = json["features"][0];
  EXPECT_EQ(pipe["name"], "pipe");
  EXPECT_NEAR(pipe["length"].get<double>(), 0.3, 1e-9);
  EXPECT_GT(pipe["length_sigma"].get<double>(), 0);
  EXPECT_NEAR(pipe["vertices"][0]["xyz"][0].get<double>(), 0.75, 1e-9);
  EXPECT_EQ(pipe["vertices"][0]["covariance"].size(), 9u);
  EXPECT_NEAR(json["features"][1]["vertices"][0]["xyz"][2].get<double>(), 0.8, 1e-9);
}

TEST(Cli, TargetMeasuresPlanesAndBoxes) {
  std::string rows = "feature,kind,vertex,view,u,v\n";
  rows += pick("panel", "plane", 0, 1, 0.2, 0.9) + pick("panel", "plane", 1, 1, -0.1, 0.9) + pick("panel", "plane", 2, 1, -0.1, 1.1);
  const double slope = std::sqrt(0.5);   // a crate turned by 45 degrees about the vertical, seen from above its corner
  rows += pick("crate", "triad", 0, 1, 0, 0.9) + pick("crate", "triad", 1, 1 + 0.3 * slope, -0.3 * slope, 0.9) +
          pick("crate", "triad", 2, 1 + 0.2 * slope, 0.2 * slope, 0.9) + pick("crate", "triad", 3, 1, 0, 1.05);
  rows += pick("thin", "plane", 0, 1, 0.2, 0.9) + pick("thin", "plane", 1, 1, 0, 0.9) + pick("thin", "plane", 2, 1, -0.2, 0.9);
  const auto result = longarm("target --views " + stereoViews() + " --picks " + scratch("shapes.csv", rows) + " --json");
  ASSERT_EQ(result.exit, 0) << result.err;
  const auto json = result.json();
  const auto& panel = json["features"][0];
  EXPECT_NEAR(panel["normal"][0].get<double>(), -1, 1e-9) << "towards the cameras";
  EXPECT_EQ(panel["corners"].size(), 4u);
  EXPECT_NEAR(panel["center"][1].get<double>(), 0.05, 1e-9);
  EXPECT_GT(panel["angle_error_deg"].get<double>(), 0);
  const auto& crate = json["features"][1];
  const std::vector<double> wanted = {0.3, 0.2, 0.15};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(crate["box"]["size"][i].get<double>(), wanted[i], 1e-9) << i;
  EXPECT_EQ(crate["box"]["pose"]["parent"], "base_link");
  EXPECT_NEAR(crate["orthogonality_error_deg"].get<double>(), 0, 1e-6);
  EXPECT_EQ(json["features"][2]["status"], "degenerate") << "a plane of three points in line keeps its reason";
  EXPECT_TRUE(json["features"][2].contains("reason"));
}

// The two views above with pictures of a painted wall in them, or with grey ones.
std::string wallViews(bool painted) {
  vision::ViewSet views = *vision::readViewsFile(stereoViews());
  const auto wall = PaintedWall::textured(5);
  std::string text = slurp(stereoViews());
  for (auto& entry : views.entries) {
    vision::View seen = entry.view;   // the wall stands before a head that looks along z
    seen.X_WC = Pose::Identity();
    seen.X_WC.translation().x() = entry.view.name == "left" ? 0 : 0.25;
    const std::string path = testing::TempDir() + "wall_" + entry.view.name + "_" + std::to_string(::getpid()) + ".png";
    const cv::Mat flat(1000, 640, CV_8UC1, cv::Scalar(90));
    EXPECT_TRUE(vision::saveImage(path, painted ? wall.seenBy(seen, nullptr, 1, 0) : flat).ok());
    const std::string key = "name: " + entry.view.name + "\n";
    text.replace(text.find(key), key.size(), key + "    image: " + path + "\n");
  }
  return scratch(painted ? "wall.yaml" : "flat.yaml", text);
}

TEST(Cli, EpipolarSuggestsTheMatchOrSaysThereIsNone) {
  vision::View left;
  left.camera = pinhole();
  vision::View right = left;
  right.X_WC.translation().x() = 0.25;
  const Eigen::Vector3d p = PaintedWall::textured(5).at(0.05, 0.02);
  const Eigen::Vector2d a = left.project(p).value(), b = right.project(p).value();
  const std::string command = "epipolar --from left --to right --depth 0.5,5 --suggest --json --pixel " + formatNumber(a.x()) + "," + formatNumber(a.y());
  const auto found = longarm(command + " --views " + wallViews(true));
  ASSERT_EQ(found.exit, 0) << found.err << found.out;
  const auto best = found.json()["matches"][0];
  EXPECT_NEAR(best["u"].get<double>(), b.x(), 0.2);
  EXPECT_NEAR(best["v"].get<double>(), b.y(), 0.2);
  EXPECT_NEAR(best["depth"].get<double>(), p.z(), 0.01);
  EXPECT_GT(best["score"].get<double>(), 0.6);
  EXPECT_LT(best["ambiguity"].get<double>(), 0.5);
  const auto none = longarm(command + " --views " + wallViews(false));
  EXPECT_EQ(none.exit, 4);
  EXPECT_TRUE(none.json()["matches"].is_array() && none.json()["matches"].empty()) << none.out;
  const auto no_pictures = longarm(command + " --views " + stereoViews());
  EXPECT_EQ(no_pictures.exit, 3);
  EXPECT_NE(no_pictures.err.find("no picture"), std::string::npos) << no_pictures.err;
}

TEST(Cli, BadInputExitsThreeAndNamesThePlace) {
  const auto picks = scratch("bad.csv", "feature,kind,vertex,view,u,v\npipe,line,0,left,12,abc\n");
  const auto result = longarm("target --views " + stereoViews() + " --picks " + picks + " --json");
  EXPECT_EQ(result.exit, 3);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("abc"), std::string::npos) << result.err;
  EXPECT_EQ(longarm("target --views /no/such.yaml --picks x --json").exit, 3);
  EXPECT_EQ(longarm("epipolar --views " + stereoViews() + " --from left --pixel 1 --to right").exit, 3);
  EXPECT_EQ(longarm("epipolar --views " + stereoViews() + " --from left --pixel 1,2 --to middle").exit, 3);
}

TEST(Cli, EpipolarCurveOfIdealCamerasIsTheRow) {
  const auto result = longarm("epipolar --views " + stereoViews() + " --from left --pixel 320,200 --to right --depth 1,2 --json");
  ASSERT_EQ(result.exit, 0) << result.err;
  const auto json = result.json();
  ASSERT_GE(json["curve_px"].size(), 2u);
  EXPECT_EQ(json["curve_px"].size(), json["depths"].size());
  for (const auto& p : json["curve_px"]) EXPECT_NEAR(p[1].get<double>(), 200, 1e-6);
  EXPECT_NEAR(json["curve_px"][0][0].get<double>(), 320 - 800 * 0.25 / 1, 1e-6);
  EXPECT_NEAR(json["depths"].back().get<double>(), 2, 1e-9);
  const auto nothing = longarm("epipolar --views " + stereoViews() + " --from left --pixel 0,0 --to right --depth 0.2,0.3 --json");
  EXPECT_EQ(nothing.exit, 4);
  EXPECT_TRUE(nothing.json().contains("status"));
}

TEST(Cli, PlanReadsWhatTargetPrintsAndCheckApproves) {
  const auto target = longarm("target --views " + stereoViews() + " --picks " + pipePicks() + " --json");
  const auto feature = scratch("feature.json", target.out);
  const auto out = testing::TempDir() + "cli_" + std::to_string(::getpid()) + "_t.json";
  const auto plan = longarm("plan --macro grab_pipe --feature " + feature + " --seed 3 --out " + out + " --json");
  ASSERT_EQ(plan.exit, 0) << plan.out << plan.err;
  EXPECT_EQ(plan.json()["status"], "ok");
  EXPECT_LE(plan.json()["max_velocity_ratio"].get<double>(), 0.5 + 1e-6);
  const auto check = longarm("check --trajectory " + out + " --json");
  EXPECT_EQ(check.exit, 0) << check.out << check.err;
  EXPECT_EQ(check.json()["ok"], true);
  const std::string first = slurp(out);
  longarm("plan --macro grab_pipe --feature " + feature + " --seed 3 --out " + out + " --json");
  EXPECT_EQ(first, slurp(out)) << "same input, same seed, same output";
}

TEST(Cli, PlanSaysWhyAPipeIsOutOfReach) {
  const auto feature = scratch("far.json", R"({"name": "far", "kind": "line", "parent": "base_link",
      "vertices": [{"xyz": [3, 0.1, 0.4]}, {"xyz": [3, -0.1, 0.4]}]})");
  const auto plan = longarm("plan --macro grab_pipe --feature " + feature + " --json");
  EXPECT_EQ(plan.exit, 4);
  EXPECT_EQ(plan.json()["status"], "unreachable") << plan.out;
  EXPECT_GT(plan.json()["reason"].get<std::string>().size(), 20u);
}

TEST(Cli, CannedMotionsPlanWithoutAFeature) {
  for (const char* macro : {"stow", "ready", "look_ahead"}) {
    const auto plan = longarm(std::string("plan --macro ") + macro + " --json");
    EXPECT_EQ(plan.exit, 0) << macro << plan.out << plan.err;
  }
  EXPECT_EQ(longarm("plan --macro no_such --json").exit, 3);
}

TEST(Cli, CheckFindsABrokenLimit) {
  const auto names = longarm("list robots --json");
  EXPECT_EQ(names.exit, 0);
  std::string joints, zeros, moved;
  for (int i = 1; i <= 6; ++i) {
    joints += (i > 1 ? "," : "") + std::string("\"arm_") + std::to_string(i) + "_joint\"";
    zeros += i > 1 ? ",0" : "0";
    moved += i > 1 ? ",0" : "50";
  }
  const auto point = [&](const char* t, const std::string& q) {
    return std::string("{\"t\": ") + t + ", \"positions\": [" + q + "], \"velocities\": [" + zeros + "], \"accelerations\": [" + zeros + "]}";
  };
  const auto file = scratch("wild.json", "{\"joint_names\": [" + joints + "], \"points\": [" + point("0", zeros) + "," + point("0.1", moved) + "]}");
  const auto check = longarm("check --trajectory " + file + " --json");
  EXPECT_EQ(check.exit, 4) << check.err;
  EXPECT_EQ(check.json()["ok"], false);
  EXPECT_GE(check.json()["violations"].size(), 1u);
}

TEST(Cli, ListsAreObjectsWithNamesAndDescriptions) {
  std::set<std::string> macros;
  const auto list = longarm("list macros --json").json();
  for (const auto& m : list["macros"]) macros.insert(m["name"].get<std::string>());
  for (const char* name : {"home", "stow", "ready", "look_ahead", "grab_pipe"}) EXPECT_TRUE(macros.count(name)) << name;
  for (const char* what : {"scenarios", "robots", "devices"}) {
    const auto json = longarm(std::string("list ") + what + " --json").json();
    ASSERT_TRUE(json.contains(what));
    EXPECT_GE(json[what].size(), 1u) << what;
    EXPECT_TRUE(json[what][0].contains("description"));
  }
}

TEST(Cli, RobotFkEqualsPublishedFiguresOfTheUr5) {
  LONGARM_SKIP_WITHOUT_DATA();
  const std::string urdf = dataFolder() + "/robots/ur_expanded/ur5.urdf";
  const auto fk = longarm("robot fk --urdf " + urdf + " --tip tool0 --base base_link --joints=-2.238,-1.153,-2.174,0.185,0.667,0 --json");
  ASSERT_EQ(fk.exit, 0) << fk.err;
  std::map<std::string, nlohmann::json> links;
  const auto json = fk.json();
  for (const auto& link : json["links"]) links[link["name"].get<std::string>()] = link["pose"];
  EXPECT_EQ(json["tip"], "tool0");
  const double expected[3] = {0.29992, 0.09986, 0.49992};
  // the figures are in base_link, which in this file stands at the root
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(json["pose"]["xyz"][static_cast<std::size_t>(i)].get<double>(), expected[i], 2e-5) << i;
}

TEST(Cli, RobotIkReturnsJointsWhoseFkIsThePose) {
  LONGARM_SKIP_WITHOUT_DATA();
  const std::string robot = "--urdf " + dataFolder() + "/robots/ur_expanded/ur5.urdf --tip tool0";
  const auto fk = longarm("robot fk " + robot + " --joints=0.3,-1.2,1.1,-0.4,0.7,0.2 --json").json();
  const auto& p = fk["pose"];
  std::string pose;
  for (const char* key : {"xyz", "quaternion_xyzw"}) {
    for (const auto& v : p[key]) pose += (pose.empty() ? "" : ",") + formatNumber(v.get<double>());
  }
  const auto ik = longarm("robot ik " + robot + " --pose=" + pose + " --json");
  ASSERT_EQ(ik.exit, 0) << ik.err;
  const auto solutions = ik.json()["solutions"];
  ASSERT_GE(solutions.size(), 1u);
  for (const auto& s : solutions) {
    EXPECT_LT(s["position_error"].get<double>(), 1e-5);
    EXPECT_LT(s["orientation_error"].get<double>(), 1e-5);
  }
  EXPECT_EQ(longarm("robot ik " + robot + " --pose 9,0,0,0,0,0,1 --json").exit, 4);
  EXPECT_EQ(longarm("robot ik " + robot + " --pose 9,0,0 --json").exit, 3);
}

}  // namespace
}  // namespace longarm::tests
