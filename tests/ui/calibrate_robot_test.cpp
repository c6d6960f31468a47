// The task Calibrate with the virtual robot: a board held before a live camera, and a camera that was knocked.
#include <cmath>
#include <random>

#include <QComboBox>
#include <QListWidget>
#include <QPushButton>
#include <QTabWidget>
#include <QTableWidget>
#include <QToolButton>

#include "tests/ui/played_window.h"

namespace longarm {
namespace {

using calibration::HealthLevel;
using session::PickState;
using ui::SimulatedHand;
using ui::Task;
using vision::PaneSide;

class CalibrateWithRobot : public tests::PlayedWindow {
 protected:
  Pose trueCamera(const std::string& camera) { return op->look()->links.at(bench->document().workcell()->camera(camera)->link); }
  // Draws a line over the pipe with the mouse; in the right picture where it is seen, off the curve.
  FeatureId markPipe() {
    const Status marked = op->mark(ui::ActionId::kToolLine, pipeEnds(), {}, true);
    EXPECT_TRUE(marked.ok()) << marked.error().message;
    return bench->document().items().empty() ? FeatureId() : bench->document().items().back().id;
  }
  ui::SimulatedOperator::Points pipeEnds() {
    return pointsOn("pipe", {{0, 0, -0.2}, {0, 0, 0.2}}).value();
  }
  // Marks the pipe some times; root mean square of how far its ends are missed.
  double missOfMarks(int count) {
    double squares = 0;
    for (int i = 0; i < count; ++i) squares += std::pow(missOfPipe(markPipe()), 2);
    return std::sqrt(squares / count);
  }
  int clickCorners(const std::string& camera, int most);
  double missOfPipe(FeatureId id) {
    const auto ends = pipeEnds();
    const auto& feature = bench->document().measurement(id).feature;
    EXPECT_TRUE(feature.has_value()) << bench->document().measurement(id).reason;
    if (!feature) return 1e9;
    return std::max((feature->vertices[0].xyz - ends[0]).norm(), (feature->vertices[1].xyz - ends[1]).norm());
  }
};

TEST_F(CalibrateWithRobot, ABoardHeldBeforeALiveCameraGivesItsTrueLens) {
  openScenario("calibration_board");
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
  std::mt19937_64 random(5);
  std::normal_distribution<double> tremble(0, 0.5);
  int clicked = 0;
  for (int i = 0; i < panel->landmarks()->count() && clicked < most; ++i) {
    const auto at = pose.landmarks()[static_cast<std::size_t>(i)].inRoot(model, q);
    const auto pixel = at ? snapshot->view.camera.project(X_WC.inverse() * *at) : Result<Eigen::Vector2d>(ErrorCode::kNotFound, "");
    if (!pixel || !snapshot->view.camera.containsPixel(*pixel, -4)) continue;
    const auto place = panel->canvas()->widgetOfPixel(*pixel + Eigen::Vector2d(tremble(random), tremble(random)));
    if (!place || !panel->canvas()->rect().contains(place->toPoint())) continue;
    panel->landmarks()->setCurrentRow(i);
    hand.click(panel->canvas(), *place);
    ++clicked;
  }
  return clicked;
}

TEST_F(CalibrateWithRobot, AKnockedCameraIsNoticedBlocksTheMotionAndIsPutRightByMouseAlone) {
  openScenario("grab_pipe", {1920, 1080});
  demand(op->aim([this] { return Result<ui::SimulatedOperator::Points>(pipeEnds()); }));
  demand(op->takePair());
  op->setTremble(0.5, 4);
  const double nominal_m = missOfMarks(12);
  EXPECT_EQ(bench->health().whyNotTrust(bench->document().items().back().id), QString()) << "nothing was knocked yet";
  auto* grab = window->macros()->button(QStringLiteral("grab_pipe"));
  ASSERT_TRUE(SimulatedHand::waitFor([grab] { return grab->isEnabled(); }, 20)) << grab->toolTip().toStdString();

  // Something hits the right camera in the middle of the task.
  const Pose before_knock = trueCamera("head_right");
  ASSERT_TRUE(bench->robot().runtime()->callService("/virtual_robot/fault", R"({"name": "knocked_camera", "target": "head_right"})", 10).ok());
  const double knock_deg = angleBetween(before_knock.linear(), trueCamera("head_right").linear()) * 180 / 3.14159265358979;
  EXPECT_NEAR(knock_deg, 1, 0.1);
  demand(op->takePair());
  const double knocked_m = missOfMarks(2);
  EXPECT_EQ(bench->health().of("head_right").level, HealthLevel::kKnocked) << bench->health().of("head_right").why;
  look(QStringLiteral("knocked-target-1920"));
  EXPECT_TRUE(window->strip()->cameraLamp()->toolTip().contains(QStringLiteral("knocked"))) << window->strip()->cameraLamp()->toolTip().toStdString();
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
  const int clicked = clickCorners("head_right", 60);
  ASSERT_GE(clicked, 6) << "corners that the camera sees";
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return !pose.solving(); }, 60));
  look(QStringLiteral("knocked-pose-1920"));
  ASSERT_TRUE(pose.outcome().has_value()) << pose.why().toStdString();
  // Found where it truly is, within what is said of it.
  const auto found = pose.change();
  const Pose X_WC = trueCamera("head_right"), X_WL = pose.viewNow()->X_WC * found.X_LC->inverse(), truth = X_WL.inverse() * X_WC;
  Eigen::Matrix<double, 6, 1> off;
  off << logSO3(found.X_LC->linear() * truth.linear().transpose()), found.X_LC->translation() - truth.translation();
  for (int i = 0; i < 6; ++i) EXPECT_LT(std::abs(off[i]), 3 * std::sqrt(found.pose_covariance(i, i))) << "component " << i;
  ASSERT_TRUE(panel->applyButton()->isEnabled()) << panel->applyButton()->toolTip().toStdString();
  ASSERT_TRUE(hand.hold(panel->applyButton(), [this] { return bench->calibration().recordInUse("head_right").has_value(); }, 10));

  window->tasks()->setTask(Task::kTarget);
  demand(op->takePair());
  op->setTremble(0.5, 4);                // the same hand as before the knock
  const double mended_m = missOfMarks(12);
  EXPECT_NE(bench->health().of("head_right").level, HealthLevel::kKnocked) << bench->health().of("head_right").why;
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
