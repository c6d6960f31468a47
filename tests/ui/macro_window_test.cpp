// Every macro in the real window on the virtual robot, in a scenario that needs it: sketched, planned, looked
// at, played, paused, backed up, corrected and played to its end, all by mouse.
//
// LONGARM_UI_PICTURES=FOLDER keeps a picture of each plan, for docs/macros.md.
#include <QDoubleSpinBox>

#include "planning/macros/recorded_motion.h"
#include "tests/ui/played_window.h"
#include "ui/recorded_panel.h"

namespace longarm {
namespace {

using Eigen::Vector3d;
using ui::ActionId;

struct MacroCase {
  const char *macro, *scenario;
  ActionId tool;
  const char* object;            // whose frame the points are in
  std::vector<Vector3d> points;  // [m]
  std::map<std::string, double> settings = {};
  bool touches = false;  // the object must be touched, and nothing else
  double moves = 0;      // the object must have moved by so much at the end [m]
  // What stands about unmarked: the console, which knows only what was marked, cannot keep clear of it.
  std::set<std::string> untold = {};
};

void PrintTo(const MacroCase& c, std::ostream* out) { *out << c.macro << " in " << c.scenario; }

// Corners of the scenarios' bodies: the middle of an axis lies at 0, z along it.
const std::vector<Vector3d> kHandle{{0, 0, 0.10}, {0, 0, -0.10}}, kPipe{{0, 0, -0.2}, {0, 0, 0.2}},
    kAxle{{0, 0, -0.1}, {0, 0, 0.1}}, kPackageEdge{{-0.13, 0.18, -0.12}, {-0.13, -0.18, -0.12}},
    kPanel{{-0.01, 0.25, 0.2}, {-0.01, 0.25, -0.2}, {-0.01, -0.25, -0.2}},
    kPanelTop{{-0.01, 0.12, 0.2}, {-0.01, 0.12, 0}, {-0.01, -0.12, 0}},
    kCrate{{-0.035, 0.06, 0.05}, {0.035, 0.06, 0.05}, {-0.035, -0.06, 0.05}, {-0.035, 0.06, -0.05}},
    kPackage{{-0.13, 0.18, 0.12}, {0.13, 0.18, 0.12}, {-0.13, -0.18, 0.12}, {-0.13, 0.18, -0.12}},
    kPin{{0, 0, -0.07}, {0, 0, 0.07}}, kCrateTop{{0, 0, 0.05}}, kPanelMiddle{{-0.01, 0, 0}};

std::vector<MacroCase> everyMacro() {
  return {
      {"approach_from_side", "open_door", ActionId::kToolLine, "handle", kHandle, {{"radius", 0.012}}},
      {"grab_pipe", "grab_pipe", ActionId::kToolLine, "pipe", kPipe},
      {"place_disruptor", "package", ActionId::kToolLine, "package", kPackageEdge},
      {"surface_scan", "scan_panel", ActionId::kToolPlane, "panel", kPanel, {{"swath", 0.3}, {"speed", 0.1}}},
      {"move_around_axis", "turn_valve", ActionId::kToolLine, "axle", kAxle, {{"angle", 0.3}}},
      {"grasp_by_faces", "crate", ActionId::kToolTriad, "crate", kCrate},
      {"touch", "scan_panel", ActionId::kToolPoint, "panel", kPanelMiddle, {{"gap", 0.02}}},
      {"look_at", "crate", ActionId::kToolPoint, "crate", kCrateTop},
      {"move_above", "crate", ActionId::kToolPoint, "crate", kCrateTop},
      {"place_here", "crate", ActionId::kToolPoint, "table", {{0, -0.15, 0.015}}, {}, false, 0, {"table"}},
      {"move_parallel", "pull_drawer", ActionId::kToolLine, "handle", kHandle},
      {"aim_along_axis", "turn_valve", ActionId::kToolLine, "axle", kAxle},
      {"insert_along", "hatch", ActionId::kToolLine, "pin", kPin, {{"depth", 0.05}}},
      {"extract_along", "grab_pipe", ActionId::kToolLine, "pipe", kPipe},
      {"follow_perimeter", "scan_panel", ActionId::kToolPlane, "panel", kPanel, {{"inset", 0.08}}},
      {"press", "scan_panel", ActionId::kToolPlane, "panel", kPanelTop, {{"depth", 0.015}}, true},
      {"wipe", "scan_panel", ActionId::kToolPlane, "panel", kPanelTop, {{"depth", 0.015}, {"width", 0.06}}, true},
      {"push_face", "crate", ActionId::kToolTriad, "crate", kCrate, {{"distance", 0.05}}, false, 0.035, {"table"}},
      {"scan_faces", "package", ActionId::kToolTriad, "package", kPackage, {{"swath", 0.2}, {"speed", 0.1}}, false, 0, {"pallet", "ground"}},
      {"look_around", "crate", ActionId::kToolTriad, "crate", kCrate, {}, false, 0, {"table"}}};
}

class MacroWindow : public tests::PlayedWindow, public ::testing::WithParamInterface<MacroCase> {
 protected:
  void playThrough() {
    const MacroCase& c = GetParam();
    const QString macro = QString::fromLatin1(c.macro);
    openScenario(c.scenario);
    if (HasFatalFailure()) return;
    const auto at_first = op->look();
    ASSERT_TRUE(at_first.ok()) << at_first.error().message;
    const Vector3d before = at_first->objects.at(c.object).translation();
    if (!HasFatalFailure()) sketch(c.tool, c.object, c.points);
    if (!HasFatalFailure()) planIt(macro, c.settings);
    if (!HasFatalFailure()) preview(macro);
    if (HasFatalFailure()) return;
    demand(op->resetStop());
    demand(op->openGripper());
    playAndCorrect();
    if (!HasFatalFailure()) finish();
    if (HasFatalFailure()) return;
    std::set<std::string> may = c.untold;
    if (c.touches) may.insert(c.object);
    EXPECT_TRUE(contacts(may).empty()) << judge().dump();
    if (c.touches) EXPECT_FALSE(contacts().empty()) << "nothing was pressed";
    if (std::string(c.macro) == "insert_along") EXPECT_GT(toolNow().x(), 0.73) << "through the opening";
    if (c.moves == 0) return;
    const auto now = op->look();
    ASSERT_TRUE(now.ok()) << now.error().message;
    const Vector3d way = now->objects.at(c.object).translation() - before;
    EXPECT_GT(way.head<2>().norm(), c.moves) << "it was not pushed";
    EXPECT_NEAR(way.z(), 0, 2e-3) << "it slid";
  }
};

// A turn further than the arm reaches: it lets go by itself, goes back, and takes the next piece of the rim.
class RegripWindow : public tests::PlayedWindow {};

TEST_F(RegripWindow, AValveIsTurnedFarByGrippingAgain) {
  openScenario("turn_valve");
  if (!HasFatalFailure()) sketch(ActionId::kToolLine, "rim_1", {{0, 0, 0.06}, {0, 0, -0.06}});
  if (!HasFatalFailure()) planIt(QStringLiteral("approach_from_side"), {{"radius", 0.011}});
  if (HasFatalFailure()) return;
  demand(op->resetStop());
  demand(op->openGripper());
  finish();
  if (HasFatalFailure()) return;
  bench->robot().setGripper(bench->document().workcell()->gripper->closed);
  ASSERT_TRUE(ui::SimulatedHand::waitFor([this] { return bench->robot().runtime()->holding(); }, 20)) << whyNot();
  sketch(ActionId::kToolLine, "axle", kAxle);
  const double far = 5 * M_PI / 3;
  if (!HasFatalFailure()) planIt(QStringLiteral("move_around_axis"), {{"angle", far}, {"regrip", 1}, {"pitch", M_PI / 3}});
  if (HasFatalFailure()) return;
  preview(QStringLiteral("move_around_axis_regrip"));
  const auto& stages = bench->document().plan()->plan.stages;
  const auto steps = std::count_if(stages.begin(), stages.end(), [](const auto& stage) { return stage.gripper.has_value(); });
  ASSERT_GE(steps, 2) << "this far takes more than one grip";
  if (bench->play().state().ask) bench->play().acceptAccuracy();
  finish();
  const auto told = judge();
  EXPECT_NEAR(told.at("mechanisms").at("wheel").get<double>(), -far, 0.08) << "right-handed about the axle as it was marked: " << whyNot();
  EXPECT_EQ(told.at("held").get<std::string>().empty(), false);
  EXPECT_NE(told.at("held").get<std::string>(), "rim_1") << "another piece of the rim";
  EXPECT_TRUE(contacts().empty()) << told.dump();
}

// Nothing is marked: the pose is typed, and what is not typed stays as it is.
class TypedPoseWindow : public tests::PlayedWindow {
 protected:
  void type(const char* parameter, double value) {
    auto* box = window->macros()->form()->number(QString::fromLatin1(parameter));
    ASSERT_NE(box, nullptr) << parameter;
    box->setValue(value * ui::shownUnit({parameter, "m"}).factor);
  }
};

TEST_F(TypedPoseWindow, TakesTheToolThere) {
  openScenario("crate");
  if (HasFatalFailure()) return;
  demand(op->resetStop());
  demand(op->openGripper());
  const Vector3d before = toolNow();
  const QString macro = QStringLiteral("move_to");
  planIt(macro, {});
  if (HasFatalFailure()) return;
  const auto first = bench->document().plan()->id;
  EXPECT_NEAR(bench->plans().arguments(macro).at("z"), before.z(), 1e-3) << "it defaults to where the tool is";
  type("z", before.z() + 0.10);
  if (!HasFatalFailure()) type("y", before.y() - 0.20);
  if (HasFatalFailure()) return;
  const Vector3d wanted = before + Vector3d(0, -0.20, 0.10);
  const auto planned = [&] {
    const auto& plan = bench->document().plan();
    return plan && plan->id != first && plan->plan.ok() && (plan->plan.goal.translation() - wanted).norm() < 2e-3;
  };
  ASSERT_TRUE(ui::SimulatedHand::waitFor(planned, 60)) << whyNot();
  preview(macro);
  if (!HasFatalFailure()) playAndCorrect();
  if (!HasFatalFailure()) finish();
  if (HasFatalFailure()) return;
  EXPECT_LT((toolNow() - wanted).norm(), 5e-3) << "the correction was 1 mm at the most";
  EXPECT_TRUE(contacts().empty()) << judge().dump();
}

// To a pose that the workcell names, and once more along the way that was recorded.
class NamedMotionWindow : public tests::PlayedWindow {
 protected:
  void playThrough(const QString& macro, const QString& picture) {
    planIt(macro, {});
    if (!HasFatalFailure()) preview(picture);
    if (!HasFatalFailure()) playAndCorrect();
  }
  // How far the arm is from a named pose, in the joint that is furthest off [rad].
  double offPose(const std::string& name) const {
    const auto state = bench->robot().runtime()->jointState();
    double most = 0;
    for (const auto& [joint, wanted] : bench->document().workcell()->poses.at(name)) {
      const auto at = std::find(state->names.begin(), state->names.end(), joint);
      if (at != state->names.end()) most = std::max(most, std::abs(state->positions[at - state->names.begin()] - wanted));
    }
    return most;
  }
};

TEST_F(NamedMotionWindow, ACannedMotionIsPlayedRecordedAndReplayed) {
  openScenario("crate");
  if (HasFatalFailure()) return;
  demand(op->resetStop());
  demand(op->openGripper());
  ASSERT_GT(offPose("ready"), 0.2);
  playThrough(QStringLiteral("ready"), QStringLiteral("canned"));
  if (HasFatalFailure()) return;
  window->findChild<QDockWidget*>(QStringLiteral("recorded"))->raise();
  auto* panel = window->findChild<ui::RecordedPanel*>();
  ui::SimulatedHand::pump(100);
  ASSERT_TRUE(panel->recordButton()->isEnabled()) << panel->recordButton()->toolTip().toStdString();
  hand.click(panel->recordButton());
  finish();
  if (HasFatalFailure()) return;
  EXPECT_LT(offPose("ready"), 0.02) << "the correction was a millimetre or a degree, and the way led back";
  hand.click(panel->recordButton());
  ASSERT_EQ(bench->recorder().motions().size(), 1U) << whyNot();
  const auto& motion = bench->recorder().motions().front();
  EXPECT_GE(motion.waypoints.size(), 2U);
  planIt(QStringLiteral("stow"), {});
  if (!HasFatalFailure()) finish();
  if (HasFatalFailure()) return;
  EXPECT_LT(offPose("stow"), 0.02);
  playThrough(QString::fromStdString(planning::macroName(motion)), QStringLiteral("recorded"));
  if (!HasFatalFailure()) finish();
  if (HasFatalFailure()) return;
  EXPECT_LT(offPose("ready"), 0.02) << "it ends where the recording ended";
  EXPECT_TRUE(contacts().empty()) << judge().dump();
}

TEST_P(MacroWindow, IsSketchedPlannedPlayedPausedBackedUpCorrectedAndFinished) { playThrough(); }

std::string nameOf(const ::testing::TestParamInfo<MacroCase>& info) { return info.param.macro; }

INSTANTIATE_TEST_SUITE_P(Every, MacroWindow, ::testing::ValuesIn(everyMacro()), nameOf);

}  // namespace
}  // namespace longarm
