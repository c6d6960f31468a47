// The task Calibrate with the virtual robot: a board held before a live camera, and a camera that was knocked.
#include <cmath>

#include <QComboBox>
#include <QListWidget>
#include <QPushButton>
#include <QTabWidget>
#include <QTableWidget>
#include <QToolButton>
#include <nlohmann/json.hpp>

#include "planning/world/scenario.h"
#include "tests/ui/window_fixture.h"

namespace longarm {
namespace {

using calibration::HealthLevel;
using session::PickState;
using ui::SimulatedHand;
using ui::Task;
using vision::PaneSide;

Pose poseOf(const nlohmann::json& json) {
  const auto& p = json.at("xyz");
  const auto& q = json.at("quaternion_xyzw");
  const auto number = [](const nlohmann::json& list, std::size_t i) { return list.at(i).get<double>(); };
  return longarm::poseFrom(Eigen::Vector3d(number(p, 0), number(p, 1), number(p, 2)), Eigen::Vector4d(number(q, 0), number(q, 1), number(q, 2), number(q, 3)));
}

class CalibrateWithRobot : public tests::WindowFixture {
 protected:
  void openScenario(const QString& scenario, const QSize& size = {1280, 800}) {
    openWindow(QStringLiteral("dark"), size);
    ui::RobotChoice choice;
    choice.scenario = scenario;
    bench->openRobot(choice);
    ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->robot().linkUp(); }, 60)) << bench->robot().status().link_text;
  }
  nlohmann::json truth() { return nlohmann::json::parse(bench->robot().runtime()->callService("/virtual_robot/truth", "{}", 10).value()); }
  Pose trueCamera(const std::string& camera) { return poseOf(truth().at("links").at(bench->document().workcell()->camera(camera)->link)); }
  void takePair() {
    const auto before = bench->document().paneSnapshotId(PaneSide::kRight);
    for (int tries = 0; tries < 6 && bench->document().paneSnapshotId(PaneSide::kRight) == before; ++tries) {
      SimulatedHand::pump(300);
      bench->takePair();
      SimulatedHand::waitFor([this] { return bench->snapshots().state() == session::SnapshotController::State::kIdle; }, 60);
    }
    ASSERT_NE(bench->document().paneSnapshotId(PaneSide::kRight), before) << window->strip()->message().toStdString();
  }
  // Turns the head until the pipe lies in the middle of the left picture.
  void aimAt(const Eigen::Vector3d& p_W) {
    bench->aim().setPanTilt(QStringLiteral("head"));
    for (int tries = 0; tries < 6; ++tries) {
      const Eigen::Vector3d p_C = trueCamera("head_left").inverse() * p_W;
      const double right = std::atan2(p_C.x(), p_C.z()), up = -std::atan2(p_C.y(), std::hypot(p_C.x(), p_C.z()));
      if (std::abs(right) < 0.05 && std::abs(up) < 0.05) return;
      bench->aim().step(right, up);
      SimulatedHand::pump(400);
      SimulatedHand::waitFor([this] {
        const auto angles = bench->robot().runtime()->panTilt("head");
        return angles && !angles->moving;
      }, 20);
    }
  }
  QToolButton* buttonOf(ui::ActionId id) {
    for (auto* button : window->findChildren<QToolButton*>()) {
      if (button->defaultAction() == window->actions().at(id) && button->isVisible()) return button;
    }
    return nullptr;
  }
  std::optional<Eigen::Vector2d> handleOf(PaneSide side, int vertex) {
    const auto& items = bench->document().items();
    const auto* pick = items.empty() ? nullptr : items.back().pick(bench->document().paneSnapshotId(side), vertex);
    if (pick != nullptr) return pick->pixel;
    // The tool's own copy: markers in vertex order, the active one among them.
    int index = 0;
    for (const auto& shape : bench->targeting().overlay(side).shapes) {
      const bool marker = shape.kind == vision::OverlayShape::Kind::kMarker && (shape.role == vision::OverlayRole::kUnplaced || shape.role == vision::OverlayRole::kActiveHandle);
      if (marker && index++ == vertex) return shape.points.front();
    }
    return std::nullopt;
  }
  // Draws a line over the pipe with the mouse: in the left picture freely, in the right one with Ctrl, off the curve.
  FeatureId markPipe(const std::array<Eigen::Vector3d, 2>& ends) {
    ui::SimulatedHand steady{60};
    auto* tool = buttonOf(ui::ActionId::kToolLine);
    EXPECT_NE(tool, nullptr);
    if (tool != nullptr) hand.click(tool);
    SimulatedHand::pump(100);
    for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
      const auto snapshot = bench->document().paneSnapshot(side);
      const Pose X_WC = trueCamera(snapshot->view.name);
      auto* canvas = window->pictures()->pane(side)->canvas();
      for (int vertex = 0; vertex < 2; ++vertex) {
        const auto to = snapshot->view.camera.project(X_WC.inverse() * ends[static_cast<std::size_t>(vertex)]);
        const auto from = handleOf(side, vertex);
        EXPECT_TRUE(to.ok() && from.has_value());
        const auto start = from ? canvas->widgetOfPixel(*from) : std::nullopt, end = to ? canvas->widgetOfPixel(*to) : std::nullopt;
        EXPECT_TRUE(start && end) << "in the picture shown";
        if (start && end) steady.drag(canvas, *start, *end, side == PaneSide::kRight ? Qt::ControlModifier : Qt::NoModifier);
      }
    }
    SimulatedHand::pump(100);
    return bench->document().items().empty() ? FeatureId() : bench->document().items().back().id;
  }
  std::array<Eigen::Vector3d, 2> pipeEnds() {
    const auto scenario = planning::loadScenario("grab_pipe").value();
    const double half = std::get<planning::Cylinder>(scenario.object("pipe")->body.shape).length / 2;
    for (const auto& object : truth().at("objects")) {
      if (object.at("name") != "pipe") continue;
      const Pose X_WO = poseOf(object.at("pose"));
      return {X_WO * Eigen::Vector3d(0, 0, -half), X_WO * Eigen::Vector3d(0, 0, half)};
    }
    return {};
  }
  int clickCorners(const std::string& camera, int most);
  double missOfPipe(FeatureId id, const std::array<Eigen::Vector3d, 2>& ends) {
    const auto& feature = bench->document().measurement(id).feature;
    EXPECT_TRUE(feature.has_value()) << bench->document().measurement(id).reason;
    if (!feature) return 1e9;
    return std::max((feature->vertices[0].xyz - ends[0]).norm(), (feature->vertices[1].xyz - ends[1]).norm());
  }
};

TEST_F(CalibrateWithRobot, ABoardHeldBeforeALiveCameraGivesItsTrueLens) {
  openScenario(QStringLiteral("calibration_board"));
  window->tasks()->setTask(Task::kCalibrate);
  auto* panel = window->calibrate()->intrinsics();
  calibration::BoardSpec board;
  board.square = 0.03;
  panel->setBoard(board);
  panel->source()->setCurrentIndex(panel->source()->findData(QStringLiteral("head_left")));
  auto& wizard = bench->calibration().intrinsics();
  const auto kept = [&] { return wizard.boards().usable().size(); };
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return kept() >= 4; }, 240)) << panel->advice().toStdString();
  look(QStringLiteral("calibrate-live-1280"));
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return kept() >= 12; }, 400)) << kept() << " views";
  panel->source()->setCurrentIndex(0);
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return !wizard.solving() && wizard.outcome().has_value(); }, 60)) << wizard.why().toStdString();
  panel->steps()->setCurrentIndex(2);
  look(QStringLiteral("calibrate-live-result-1280"));
  const auto& result = wizard.outcome()->result;
  const auto true_lens = calibration::lensVector(bench->calibration().fileInUse("head_left")->camera);
  const auto error = (calibration::lensVector(result.camera) - true_lens).eval();
  for (const int i : result.estimated.indices()) {
    const double sigma = std::sqrt(result.covariance(i, i));
    std::printf("%s %.4f, true %.4f, sigma %.4f: %.2f sigma\n", calibration::lensParameterName(i), true_lens[i] + error[i], true_lens[i], sigma, error[i] / sigma);
    EXPECT_LT(std::abs(error[i]), 3 * sigma) << calibration::lensParameterName(i);
  }
  EXPECT_LT(result.rms_px, 0.5);
}

// Turns the page of the pose wizard through pictures of other arm poses and clicks known corners by mouse.
int CalibrateWithRobot::clickCorners(const std::string& camera, int most) {
  auto* panel = window->calibrate()->pose();
  auto& pose = bench->pose();
  const auto snapshot = pose.snapshot();
  const auto& model = *bench->document().workcell()->model;
  Eigen::VectorXd q = model.neutral();
  model.assign(snapshot->robot_state, q);
  const Pose X_WC = trueCamera(camera);
  int clicked = 0;
  for (int i = 0; i < panel->landmarks()->count() && clicked < most; ++i) {
    const auto at = pose.landmarks()[static_cast<std::size_t>(i)].inRoot(model, q);
    const auto pixel = at ? snapshot->view.camera.project(X_WC.inverse() * *at) : Result<Eigen::Vector2d>(ErrorCode::kNotFound, "");
    if (!pixel || !snapshot->view.camera.containsPixel(*pixel, -4)) continue;
    const auto place = panel->canvas()->widgetOfPixel(*pixel);
    if (!place || !panel->canvas()->rect().contains(place->toPoint())) continue;
    panel->landmarks()->setCurrentRow(i);
    hand.click(panel->canvas(), *place);
    ++clicked;
  }
  return clicked;
}

TEST_F(CalibrateWithRobot, AKnockedCameraIsNoticedBlocksTheMotionAndIsPutRightByMouseAlone) {
  openScenario(QStringLiteral("grab_pipe"), {1920, 1080});
  const auto ends = pipeEnds();
  aimAt((ends[0] + ends[1]) / 2);
  takePair();
  const FeatureId sound = markPipe(ends);
  const double nominal_m = missOfPipe(sound, ends);
  EXPECT_EQ(bench->health().whyNotTrust(sound), QString()) << "nothing was knocked yet";
  auto* grab = window->macros()->button(QStringLiteral("grab_pipe"));
  ASSERT_TRUE(SimulatedHand::waitFor([grab] { return grab->isEnabled(); }, 20)) << grab->toolTip().toStdString();

  // Something hits the right camera in the middle of the task.
  const Pose before_knock = trueCamera("head_right");
  ASSERT_TRUE(bench->robot().runtime()->callService("/virtual_robot/fault", R"({"name": "knocked_camera", "target": "head_right"})", 10).ok());
  const double knock_deg = angleBetween(before_knock.linear(), trueCamera("head_right").linear()) * 180 / 3.14159265358979;
  EXPECT_NEAR(knock_deg, 1, 0.1);
  takePair();
  const FeatureId off = markPipe(ends);
  markPipe(ends);
  EXPECT_EQ(bench->health().of("head_right").level, HealthLevel::kKnocked) << bench->health().of("head_right").why;
  look(QStringLiteral("knocked-target-1920"));
  EXPECT_TRUE(window->strip()->cameraLamp()->toolTip().contains(QStringLiteral("knocked"))) << window->strip()->cameraLamp()->toolTip().toStdString();
  const double knocked_m = missOfPipe(off, ends);
  hand.click(grab);
  SimulatedHand::pump(300);
  EXPECT_TRUE(window->strip()->message().contains(QStringLiteral("knocked"))) << window->strip()->message().toStdString();
  EXPECT_FALSE(bench->document().plan().has_value()) << "blocked";

  // The two-minute way back: the lamp leads to the library, the library to the pose page.
  hand.click(window->strip()->cameraLamp(), QRectF(window->strip()->cameraLamp()->rect()).center());
  auto* library = window->calibrate()->library();
  ASSERT_TRUE(SimulatedHand::waitFor([library] { return library->isVisible(); }, 5));
  // Misses cannot tell which of the two it was; known corners can.
  for (int row = 0; row < library->cameras()->rowCount(); ++row) {
    auto* item = library->cameras()->item(row, 0);
    if (item->text() == QStringLiteral("head_right")) hand.click(library->cameras()->viewport(), library->cameras()->visualItemRect(item).center());
  }
  look(QStringLiteral("knocked-library-1920"));
  hand.click(library->reposeButton());
  auto* panel = window->calibrate()->pose();
  ASSERT_TRUE(SimulatedHand::waitFor([panel] { return panel->isVisible(); }, 5));
  ASSERT_EQ(panel->camera()->currentData().toString(), QStringLiteral("head_right"));
  auto& pose = bench->pose();
  ASSERT_TRUE(pose.snapshot() != nullptr);
  const int clicked = clickCorners("head_right", 24);
  ASSERT_GE(clicked, 6) << "corners that the camera sees";
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return !pose.solving(); }, 60));
  look(QStringLiteral("knocked-pose-1920"));
  ASSERT_TRUE(pose.outcome().has_value()) << pose.why().toStdString();
  ASSERT_TRUE(panel->applyButton()->isEnabled()) << panel->applyButton()->toolTip().toStdString();
  ASSERT_TRUE(hand.hold(panel->applyButton(), [this] { return bench->calibration().recordInUse("head_right").has_value(); }, 10));

  window->tasks()->setTask(Task::kTarget);
  takePair();
  const FeatureId mended = markPipe(ends);
  markPipe(ends);
  EXPECT_NE(bench->health().of("head_right").level, HealthLevel::kKnocked) << bench->health().of("head_right").why;
  const double mended_m = missOfPipe(mended, ends);
  std::printf("pipe's ends missed by %.1f mm, %.1f mm with a camera knocked by %.2f deg, %.1f mm after its pose was calibrated from %d corners\n", 1000 * nominal_m, 1000 * knocked_m,
              knock_deg, 1000 * mended_m, clicked);
  EXPECT_GT(knocked_m, 2 * nominal_m);
  EXPECT_LT(mended_m, 1.5 * nominal_m);
  ASSERT_TRUE(SimulatedHand::waitFor([grab] { return grab->isEnabled(); }, 20)) << grab->toolTip().toStdString();
  hand.click(grab);
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->document().plan().has_value(); }, 60)) << window->strip()->message().toStdString();
  EXPECT_TRUE(bench->document().plan()->plan.ok()) << bench->document().plan()->plan.reason;
  look(QStringLiteral("knocked-mended-1920"));
}

}  // namespace
}  // namespace longarm
