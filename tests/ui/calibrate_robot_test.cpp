// The task Calibrate with the virtual robot: a board held before a live camera, and a camera that was knocked.
#include <cmath>
#include <random>

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QListWidget>
#include <QPushButton>
#include <QTabWidget>
#include <QTableWidget>
#include <QToolButton>

#include "core/resource_path.h"
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
  static constexpr double kBetween[] = {0.03, 0.23, 0.47, 0.68};   // settings that nobody calibrated

  static constexpr std::size_t kViews = 8;         // of a board at each setting

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
  void expectLens(const vision::CameraModel& found, const calibration::LensMatrix& covariance, const calibration::LensMask& estimated, const vision::CameraModel& truth,
                  const std::string& what);
  static QPointF visibleItem(QTableWidget* table, int row) {
    table->scrollToItem(table->item(row, 0));
    SimulatedHand::pump(20);
    return table->visualItemRect(table->item(row, 0)).center();
  }
  void calibrateAtZoom(const QString& camera, double setting);
  Pose fixtureInCamera(const std::string& camera);
  double missOfPipe(FeatureId id) {
    const auto ends = pipeEnds();
    const auto& feature = bench->document().measurement(id).feature;
    EXPECT_TRUE(feature.has_value()) << bench->document().measurement(id).reason;
    if (!feature) return 1e9;
    return std::max((feature->vertices[0].xyz - ends[0]).norm(), (feature->vertices[1].xyz - ends[1]).norm());
  }
};

// Within three sigma of what is so.
void CalibrateWithRobot::expectLens(const vision::CameraModel& found, const calibration::LensMatrix& covariance, const calibration::LensMask& estimated,
                                    const vision::CameraModel& truth, const std::string& what) {
  const calibration::LensVector is = calibration::lensVector(found), should = calibration::lensVector(truth);
  for (const int i : estimated.indices()) {
    const double sigma = std::sqrt(covariance(i, i)), error = is[i] - should[i];
    std::printf("%s: %s %.4f, true %.4f, sigma %.4f: %.2f sigma\n", what.c_str(), calibration::lensParameterName(i), is[i], should[i], sigma, error / sigma);
    // Tangential distortion too weak to be estimated looks like a principal point moved by three focal lengths of it.
    const bool point = i == calibration::kCx || i == calibration::kCy;
    const double hidden = point && !estimated.free[calibration::kP1] ? 3 * truth.fx * std::hypot(truth.distortion[2], truth.distortion[3]) : 0;
    EXPECT_LT(std::abs(error), 3 * sigma + hidden) << what << ": " << calibration::lensParameterName(i);
  }
}

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
  expectLens(result.camera, result.covariance, result.estimated, bench->calibration().fileInUse("head_left")->camera, "head_left");
  EXPECT_LT(result.rms_px, 0.5);
}

TEST_F(CalibrateWithRobot, ABoardHeldBeforeBothHeadCamerasGivesHowTheyStand) {
  openScenario("calibration_board");
  window->tasks()->setTask(Task::kCalibrate);
  auto* panel = window->calibrate()->stereo();
  window->calibrate()->showTool(panel);
  calibration::BoardSpec board;
  board.square = 0.03;
  panel->boardForm()->setBoard(board);
  ASSERT_EQ(panel->camera(0)->currentData().toString(), QStringLiteral("head_left"));
  ASSERT_EQ(panel->camera(1)->currentData().toString(), QStringLiteral("head_right"));
  auto& wizard = bench->stereo();
  const auto kept = [&] { return std::count_if(wizard.pairs().begin(), wizard.pairs().end(), [](const auto& pair) { return pair.usable(); }); };
  panel->live()->click();
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return kept() >= 3; }, 240)) << wizard.liveWords().toStdString();
  look(QStringLiteral("stereo-live-1280"));
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return kept() >= 8; }, 240)) << kept() << " pairs: " << wizard.liveWords().toStdString();
  panel->live()->click();
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return !wizard.solving() && wizard.outcome().has_value(); }, 60)) << wizard.why().toStdString();
  window->resize(1920, 1080);
  look(QStringLiteral("stereo-live-result-1920"));
  const auto& result = wizard.outcome()->result;
  const Pose truth = trueCamera("head_left").inverse() * trueCamera("head_right");
  Vector6d off;
  off << logSO3(result.X_LR.linear() * truth.linear().transpose()), result.X_LR.translation() - truth.translation();
  for (int i = 0; i < 6; ++i) {
    const double sigma = std::sqrt(result.covariance(i, i));
    std::printf("stereo %d: %.6f, sigma %.6f: %.2f sigma\n", i, off[i], sigma, off[i] / sigma);
    EXPECT_LT(std::abs(off[i]), 3 * sigma) << "component " << i;
  }
  EXPECT_LT(off.tail<3>().norm(), 0.002);
  ASSERT_TRUE(panel->applyButton()->isEnabled()) << panel->applyButton()->toolTip().toStdString();
  ASSERT_TRUE(hand.hold(panel->applyButton(), [this] { return bench->calibration().recordInUse("head_right").has_value(); }, 10));
}

TEST_F(CalibrateWithRobot, OnePictureOfAFixtureGivesLensAndPlace) {
  openScenario("calibration_fixture");
  window->tasks()->setTask(Task::kCalibrate);
  auto* panel = window->calibrate()->fixture();
  window->calibrate()->showTool(panel);
  auto& wizard = bench->fixture();
  wizard.openFixture(QString::fromStdString(resourcePath("examples/fixture/steps.csv").value()));
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return wizard.fixture().has_value(); }, 10));
  auto* take = panel->takeButton();
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return take->isEnabled(); }, 30)) << take->toolTip().toStdString();
  SimulatedHand::pump(1500);                       // what was carried there stands
  hand.click(take);
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return !wizard.dots().empty(); }, 30));
  look(QStringLiteral("fixture-live-1280"));
  // Two dots of each step, by hand.
  const auto lens = bench->calibration().fileInUse("head_left")->camera;
  const Pose X_CF = fixtureInCamera("head_left");
  for (const int row : {0, 31, 35, 60, 64, 95, 18}) {
    const auto& point = wizard.fixture()->points[static_cast<std::size_t>(row)];
    const auto pixel = lens.project(X_CF * point.xyz);
    ASSERT_TRUE(pixel.ok());
    hand.click(panel->points()->viewport(), visibleItem(panel->points(), row));
    const auto at = panel->canvas()->widgetOfPixel(*pixel + Eigen::Vector2d(1.5, -1));
    ASSERT_TRUE(at.has_value());
    hand.click(panel->canvas(), *at);
  }
  ASSERT_EQ(wizard.matches().size(), 7U);
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return panel->matchButton()->isEnabled(); }, 20)) << panel->matchButton()->toolTip().toStdString();
  hand.click(panel->matchButton());
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return wizard.matches().size() > 80 && !wizard.busy() && wizard.result().has_value(); }, 30))
      << wizard.matches().size() << " matched; " << window->strip()->message().toStdString() << wizard.why().toStdString();
  look(QStringLiteral("fixture-live-result-1280"));
  window->resize(1920, 1080);
  look(QStringLiteral("fixture-live-result-1920"));
  const auto& result = *wizard.result();
  expectLens(result.camera, result.covariance.topLeftCorner<10, 10>(), result.estimated, lens, "fixture");
  const Pose truth = X_CF.inverse();
  Vector6d off;
  off << logSO3(result.X_WC.linear() * truth.linear().transpose()), result.X_WC.translation() - truth.translation();
  for (int i = 0; i < 6; ++i) EXPECT_LT(std::abs(off[i]), 3 * std::sqrt(result.covariance(10 + i, 10 + i))) << "component " << i << ": " << off[i];
  ASSERT_TRUE(panel->applyButton()->isEnabled()) << panel->applyButton()->toolTip().toStdString();
  ASSERT_TRUE(hand.hold(panel->applyButton(), [this] { return bench->calibration().recordInUse("head_left").has_value(); }, 10));
}

TEST_F(CalibrateWithRobot, GuidesAlongRowsOfDotsGiveTheTrueDistortion) {
  openScenario("calibration_fixture");
  window->tasks()->setTask(Task::kCalibrate);
  auto* panel = window->calibrate()->lens();
  window->calibrate()->showTool(panel);
  auto& wizard = bench->lens();
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return panel->takeButton()->isEnabled(); }, 30)) << panel->takeButton()->toolTip().toStdString();
  SimulatedHand::pump(1500);
  hand.click(panel->takeButton());
  ASSERT_EQ(wizard.camera(), "head_left");
  const auto truth = bench->calibration().fileInUse("head_left")->camera;
  wizard.straightenNothing();
  panel->straightened()->setChecked(false);
  const Pose X_CF = fixtureInCamera("head_left");
  std::mt19937_64 random(3);
  std::normal_distribution<double> tremble(0, 0.3);
  const auto clickDot = [&](int column, int row) {
    const Eigen::Vector3d dot(-0.22 + 0.04 * column, 0.14 - 0.04 * row, 0.06 * (column / 4));
    const auto at = panel->canvas()->widgetOfPixel(*truth.project(X_CF * dot) + Eigen::Vector2d(tremble(random), tremble(random)));
    ASSERT_TRUE(at.has_value());
    hand.click(panel->canvas(), *at);
  };
  // Twelve columns of eight dots, straight in the world.
  for (int column = 0; column < 12; ++column) {
    for (int row = 0; row < 8; ++row) clickDot(column, row);
    wizard.endGuide();
  }
  ASSERT_EQ(wizard.guides().size(), 12U);
  panel->coefficients()->setCurrentIndex(panel->coefficients()->findText(QStringLiteral("k1 k2 p1 p2")));
  hand.click(panel->solveButton());
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return wizard.result().has_value() && !wizard.solving(); }, 30));
  EXPECT_FALSE(wizard.result()->warnings.empty()) << "columns alone hardly tell p1";
  for (int line = 0; line < 24; ++line) {          // rows, each of one step
    for (int column = 0; column < 4; ++column) clickDot(4 * (line / 8) + column, line % 8);
    wizard.endGuide();
  }
  ASSERT_EQ(wizard.guides().size(), 36U);
  hand.click(panel->solveButton());
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return wizard.result().has_value() && !wizard.solving(); }, 30));
  look(QStringLiteral("lens-live-result-1280"));
  const auto& result = *wizard.result();
  calibration::LensMask estimated;
  for (const int i : {calibration::kK1, calibration::kK2, calibration::kP1, calibration::kP2}) estimated.free[static_cast<std::size_t>(i)] = true;
  expectLens(result.camera, result.covariance, estimated, truth, "guides");
  EXPECT_LT(result.rms_px, 0.5);
}

// One round of the zoom wizard: turn the lens, show it the board, add what comes of it.
void CalibrateWithRobot::calibrateAtZoom(const QString& camera, double setting) {
  auto* zoom = window->calibrate()->zoom();
  window->calibrate()->showTool(zoom);
  zoom->camera()->setCurrentIndex(zoom->camera()->findData(camera));
  zoom->setting()->setValue(setting);
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return zoom->goButton()->isEnabled(); }, 20)) << zoom->goButton()->toolTip().toStdString();
  hand.click(zoom->goButton());
  const auto there = [&] { return std::abs(bench->zoomDrive().zoom(camera).value_or(-1) - setting) < 0.002; };
  ASSERT_TRUE(SimulatedHand::waitFor(there, 30));
  auto* lens = window->calibrate()->intrinsics();
  window->calibrate()->showTool(lens);
  lens->source()->setCurrentIndex(lens->source()->findData(camera));
  auto& wizard = bench->calibration().intrinsics();
  const auto kept = [&] {
    const auto& boards = wizard.boards();
    return session::BoardCollection::sameZoom(boards.zoom(), setting) ? boards.usable().size() : 0;
  };
  if (!SimulatedHand::waitFor([&] { return kept() >= kViews; }, 120)) {
    look(QStringLiteral("zoom-without-views"));
    FAIL() << kept() << " views at zoom " << setting;
  }
  lens->source()->setCurrentIndex(0);
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return !wizard.solving() && wizard.outcome() && wizard.outcome()->views.size() >= kViews; }, 60)) << wizard.why().toStdString();
  const auto& result = wizard.outcome()->result;
  expectLens(result.camera, result.covariance, result.estimated, bench->calibration().fileInUse(camera.toStdString(), setting)->camera, "zoom " + std::to_string(setting));
  window->calibrate()->showTool(zoom);
  ASSERT_TRUE(zoom->addButton()->isEnabled()) << zoom->addButton()->toolTip().toStdString();
  hand.click(zoom->addButton());
  ASSERT_TRUE(SimulatedHand::waitFor([&] {
    const auto& nodes = bench->zoom().table().nodes;
    return std::any_of(nodes.begin(), nodes.end(), [&](const auto& node) { return std::abs(node.zoom - setting) < 1e-9; });
  }, 10));
}

TEST_F(CalibrateWithRobot, AZoomLensIsWalkedThroughUntilItsTableIsGood) {
  openScenario("calibration_zoom");
  window->tasks()->setTask(Task::kCalibrate);
  const QString camera = QStringLiteral("ptz_left");
  calibration::BoardSpec board;
  board.square = 0.03;
  window->calibrate()->intrinsics()->setBoard(board);
  const auto truth = [&] {
    std::vector<vision::CameraModel> out;
    for (const double setting : kBetween) out.push_back(bench->calibration().fileInUse(camera.toStdString(), setting)->camera);
    return out;
  }();
  auto* panel = window->calibrate()->zoom();
  auto& wizard = bench->zoom();
  for (const double end : {0.8, 0.0}) {
    calibrateAtZoom(camera, end);
    if (HasFatalFailure()) return;
  }
  for (int round = 0; round < 4 && wizard.light() == calibration::TrafficLight::kRed; ++round) {
    ASSERT_FALSE(wizard.advised().empty());
    calibrateAtZoom(camera, wizard.advised().front());
    if (HasFatalFailure()) return;
    std::printf("%s\n", panel->advice().toStdString().c_str());
  }
  look(QStringLiteral("zoom-walked-1280"));
  window->resize(1920, 1080);
  look(QStringLiteral("zoom-walked-1920"));
  for (const auto& miss : wizard.misses()) std::printf("zoom %.3f: focal %.2f %%, boresight %.1f px\n", miss.zoom, 100 * miss.focal_error, miss.boresight_px.norm());
  EXPECT_NE(wizard.light(), calibration::TrafficLight::kRed);
  ASSERT_TRUE(panel->useButton()->isEnabled()) << panel->useButton()->toolTip().toStdString();
  ASSERT_TRUE(hand.hold(panel->useButton(), [&] { return bench->calibration().recordInUse(camera.toStdString()).has_value(); }, 10));
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto file = bench->calibration().fileInUse(camera.toStdString(), kBetween[i]);
    ASSERT_TRUE(file.ok()) << file.error().message;
    ASSERT_TRUE(file->covariance.has_value());
    const auto& C = *file->covariance;
    std::printf("zoom %.2f: fx %.1f, true %.1f, sigma %.1f; cx %.1f, true %.1f, sigma %.1f; cy %.1f, true %.1f\n", kBetween[i], file->camera.fx, truth[i].fx, std::sqrt(C(0, 0)),
                file->camera.cx, truth[i].cx, std::sqrt(C(3, 3)), file->camera.cy, truth[i].cy);
    EXPECT_NEAR(file->camera.fx / truth[i].fx, 1, 0.03);
    EXPECT_LT(std::abs(file->camera.fx - truth[i].fx), 3 * std::sqrt(C(0, 0)));
  }
}

// The flight of steps of the scenario calibration_fixture, in the frame of its file, as a camera truly sees it.
Pose CalibrateWithRobot::fixtureInCamera(const std::string& camera) {
  Pose X_BF = Pose::Identity();                    // the step's x is the fixture's z, its y the fixture's x; its face is at z = 0.06
  X_BF.linear() << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  X_BF.translation().x() = -0.055;
  return trueCamera(camera).inverse() * op->look()->objects.at("step_middle") * X_BF;
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
