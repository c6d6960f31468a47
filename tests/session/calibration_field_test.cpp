// The other wizards without their window: pose from known corners, knocked cameras, lens by hand, fixture, zoom.
#include <fstream>

#include <opencv2/imgproc.hpp>

#include "session/calibration/fixture_controller.h"
#include "session/calibration/health_controller.h"
#include "session/calibration/lens_controller.h"
#include "session/calibration/zoom_controller.h"
#include "tests/session/field_rig.h"
#include "tests/support/report_zoom_file.h"
#include "vision/snapshot/image_file.h"

namespace longarm::session {
namespace {

using calibration::HealthLevel;
using calibration::LoopUnknown;
using tests::kDegree;
using tests::Random;

TEST_F(Field, AKnockedCameraIsPutRightFromKnownCorners) {
  Random random(81);
  PoseController pose(document, calibration, jobs);
  HealthController health(document, calibration, pose);
  pose.setCamera("drive");
  EXPECT_NE(pose.why().indexOf("Take a picture"), -1) << pose.why().toStdString();
  const Pose knock = tests::poseOf({1.0 * kDegree, -0.6 * kDegree, 0.4 * kDegree}, {0.004, -0.003, 0.006});
  int clicked = 0;
  for (const auto& state : {arm(0, 0.9, 1.2, 1.0), arm(0.3, 0.8, 1.5, 0.8), arm(-0.3, 0.7, 1.3, 0.6)}) {
    const SnapshotId id = addSnapshot("drive", state);
    clicked += clickAll(&pose, document, id, document.snapshot(id)->view.X_WC * knock, &random, 8);
  }
  ASSERT_GE(clicked, 12) << "landmarks: " << pose.landmarks().size();
  ASSERT_TRUE(solved(pose));
  ASSERT_TRUE(pose.outcome().has_value()) << pose.why().toStdString();
  EXPECT_GT(*pose.missInUse(), 4) << "1 degree is 9 px";
  EXPECT_EQ(health.of("drive").level, HealthLevel::kKnocked) << health.of("drive").why;
  EXPECT_EQ(health.worstCamera(), QString("drive"));
  ASSERT_TRUE(pose.whyNotApply().isEmpty()) << pose.whyNotApply().toStdString();
  const Pose X_LC = *pose.change().X_LC;
  EXPECT_LT(angleBetween(X_LC.linear(), knock.linear()) / kDegree, 0.2);
  EXPECT_LT((X_LC.translation() - knock.translation()).norm(), 0.006);
  EXPECT_NE(pose.resultText().indexOf("Least certain"), -1);
  ASSERT_TRUE(calibration.apply(pose.change()).ok());
  EXPECT_LT(*pose.missInUse(), 1.2) << "the same clicks, with the camera put right";
  EXPECT_NE(health.of("drive").level, HealthLevel::kKnocked) << "what was clicked before says nothing of the new calibration";
  EXPECT_FALSE(calibration.library().find(calibration.recordInUse("drive")->id)->raw.empty());
}

TEST_F(Field, AnObjectIsFoundWhereItStands) {
  Random random(82);
  PoseController pose(document, calibration, jobs);
  pose.setCamera("head_left");
  pose.setObject("crate");
  pose.setUnknown(LoopUnknown::kObj);
  const JointState state = arm(0, -0.15, 2.15);
  const SnapshotId id = addSnapshot("head_left", state);
  const Pose truth = poseFromRpy({1.35, 0.05, 0.32}, {0, 0, 0.7});
  pose.setSnapshot(id);
  ASSERT_EQ(pose.landmarks().size(), 8U);
  int clicked = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const auto view = document.snapshot(id)->view;
    const auto pixel = view.project(truth * pose.landmarks()[i].xyz);
    if (!pixel || !view.camera.containsPixel(*pixel)) continue;
    pose.setLandmark(static_cast<int>(i));
    pose.pick(*pixel + Eigen::Vector2d(random.normal(0.3), random.normal(0.3)));
    ++clicked;
  }
  ASSERT_GE(clicked, 5);
  ASSERT_TRUE(solved(pose));
  ASSERT_TRUE(pose.outcome().has_value()) << pose.why().toStdString();
  EXPECT_LT((pose.solvedObjectPose().translation() - truth.translation()).norm(), 0.03);
  EXPECT_LT(angleBetween(pose.solvedObjectPose().linear(), truth.linear()) / kDegree, 2);
  const Pose found = pose.solvedObjectPose();
  PlaceChange change = pose.placeChange();
  ASSERT_TRUE(calibration.apply(change).ok());
  EXPECT_TRUE(document.workcell()->objects.front().X_WO.isApprox(found));
  EXPECT_TRUE(afterRestart()->objects.front().X_WO.isApprox(found)) << "it outlives the window";
  const auto record = calibration.recordInUse(Subject::kObject, "crate");
  ASSERT_TRUE(record.has_value());
  EXPECT_EQ(record->observations, clicked);
  EXPECT_FALSE(record->raw.empty());
  change.placement.covariance *= 4;
  EXPECT_NE(calibration.whyWorse(change).indexOf("Less certain"), -1) << "a worse placement is said to be";
  change.name = "nothing";
  EXPECT_FALSE(calibration.apply(change).ok());
  QString again;
  QObject::connect(&calibration, &CalibrationController::solvedAgain, [&again](const QString& kept) { again = kept; });
  calibration.solveAgain(record->id);
  ASSERT_TRUE(waitFor([&] { return !again.isEmpty(); }));
  const auto solved_again = readPlacement(calibration.library().find(again.toStdString())->file);
  ASSERT_TRUE(solved_again.ok());
  EXPECT_TRUE(solved_again->pose.pose.isApprox(found, 1e-5)) << "the raw data give the same place";
  EXPECT_EQ(calibration.recordInUse(Subject::kObject, "crate")->id, record->id) << "kept, not used";
  ASSERT_TRUE(calibration.usePlacement(Subject::kObject, "crate", {}).ok());
  EXPECT_TRUE(document.workcell()->objects.front().X_WO.isApprox(plain->objects.front().X_WO)) << "gone back from";
}

TEST_F(Field, AKnockedZoomCameraIsPutRightAtEverySetting) {
  const auto cell = planning::loadBuiltInWorkcell("ptz");
  ASSERT_TRUE(cell.ok()) << cell.error().message;
  plain = std::make_shared<planning::Workcell>(*cell);
  calibration.setWorkcell(plain);
  document.setWorkcell(calibration.workcellInUse());
  const std::string camera = "ptz_left";
  Random random(86);
  PoseController pose(document, calibration, jobs);
  pose.setCamera(QString::fromStdString(camera));
  const Pose knock = tests::poseOf({0.01, -0.014, 0.004}, {0.004, -0.003, 0.002});   // in the camera's link
  // Looks down at the arm, which is held at several places.
  int clicked = 0;
  std::vector<SnapshotId> ids;
  for (const double a1 : {0.2, 0.0, -0.2}) {
    JointState state = arm(a1, -0.15, 2.15);
    state.names.push_back("ptz_left_tilt_joint");
    state.positions.conservativeResize(5);
    state.positions[4] = 0.2;
    state.velocities = Eigen::VectorXd::Zero(5);
    ids.push_back(addSnapshot(camera, state, 1e9, 0.0));
    const Pose X_WL = *linkPose(state, camera), X_LC = X_WL.inverse() * document.snapshot(ids.back())->view.X_WC;
    clicked += clickAll(&pose, document, ids.back(), X_WL * knock * X_LC, &random, 14);
  }
  ASSERT_GE(clicked, 15);
  ASSERT_TRUE(solved(pose));
  ASSERT_TRUE(pose.outcome().has_value()) << pose.why().toStdString();
  ASSERT_TRUE(pose.whyNotApply().isEmpty()) << pose.whyNotApply().toStdString();
  const auto before = [&](double zoom) { return calibration.fileInUse(camera, zoom).value().pose->pose; };
  const Pose wide = before(0.0), close = before(0.6);
  ASSERT_TRUE(calibration.apply(pose.change()).ok());
  for (const auto& [zoom, old] : {std::pair<double, Pose>{0.0, wide}, {0.6, close}}) {
    const Pose now = calibration.fileInUse(camera, zoom).value().pose->pose, truth = knock * old;
    EXPECT_LT(angleBetween(now.linear(), truth.linear()) / kDegree, 0.15) << zoom;
    EXPECT_LT((now.translation() - truth.translation()).norm(), 0.004) << zoom;
    EXPECT_GT(angleBetween(now.linear(), old.linear()) / kDegree, 0.8);
  }
  EXPECT_FALSE(calibration.recordInUse(camera)->raw.empty());
  // Pictures of two zooms do not go together, and a board's lens belongs to the table.
  pose.setSnapshot(addSnapshot(camera, document.snapshot(ids.back())->robot_state, 1e9, 0.5));
  pose.setLandmark(0);
  pose.pick({320, 240});
  EXPECT_NE(pose.why().indexOf("different zooms"), -1) << pose.why().toStdString();
  CameraChange lens;
  lens.camera = camera;
  lens.lens = calibration.fileInUse(camera, 0.1)->camera;
  const Status refused = calibration.apply(lens);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("page Zoom"), std::string::npos) << refused.error().message;
}

TEST_F(Field, TooFewPointsAndALineOfPointsAreToldWithWhatToDo) {
  PoseController pose(document, calibration, jobs);
  pose.setCamera("drive");
  const SnapshotId id = addSnapshot("drive", arm(0, -0.15, 2.15));
  pose.setSnapshot(id);
  EXPECT_NE(pose.why().indexOf("0 of at least 3"), -1) << pose.why().toStdString();
  pose.setUnknown(LoopUnknown::kDev);
  EXPECT_NE(pose.why().indexOf("no pan-tilt"), -1) << pose.why().toStdString();
  pose.setUnknown(LoopUnknown::kExt);
  ASSERT_GE(pose.landmark(), 0) << "the landmark that helps most is chosen by itself";
  pose.pick({320, 240});
  EXPECT_EQ(pose.picks().size(), 1U);
  EXPECT_NE(pose.landmark(), -1);
  EXPECT_FALSE(pose.whyNotApply().isEmpty());
  pose.remove(0);
  EXPECT_TRUE(pose.picks().empty());
}

// A point that both head cameras see, marked freely in both.
SketchItem freePoint(Document* document, SnapshotId left, SnapshotId right, const Eigen::Vector2d& a, const Eigen::Vector2d& b, PickState state) {
  SketchItem item;
  item.id = document->nextFeatureId();
  item.name = document->freeName(vision::FeatureKind::kPoint);
  item.setPick(left, 0, {a, PickState::kFree});
  item.setPick(right, 0, {b, state});
  document->insertItem(document->items().size(), item);
  return item;
}

TEST_F(Field, MissesOfReleasedPicksTellOfAKnockAndBlockTheMotion) {
  Random random(83);
  PoseController pose(document, calibration, jobs);
  HealthController health(document, calibration, pose);
  const JointState state = arm(0, -0.15, 2.15);
  const SnapshotId left = addSnapshot("head_left", state), right = addSnapshot("head_right", state);
  const auto a = document.snapshot(left)->view, b = document.snapshot(right)->view;
  const auto mark = [&](double knock_deg, PickState how) {
    vision::View knocked = b;
    knocked.X_WC = b.X_WC * tests::poseOf({knock_deg * kDegree, 0, 0}, {0, 0, 0});
    while (true) {
      const Eigen::Vector3d p = a.X_WC * Eigen::Vector3d(random.uniform(-0.2, 0.4), random.uniform(-0.2, 0.2), random.uniform(0.9, 1.6));
      const auto u = a.project(p), v = knocked.project(p);
      if (!u || !v || !a.camera.containsPixel(*u) || !b.camera.containsPixel(*v)) continue;
      const auto tremble = [&] { return Eigen::Vector2d(random.normal(0.5), random.normal(0.5)); };
      return freePoint(&document, left, right, *u + tremble(), *v + tremble(), how).id;
    }
  };
  for (int i = 0; i < 4; ++i) mark(0, PickState::kReleased);
  EXPECT_EQ(health.of("head_left").level, HealthLevel::kGood);
  EXPECT_EQ(health.of("head_left").samples, 4);
  // Outlines of a pipe and places along an edge are other ones in every picture: they tell nothing of the cameras.
  for (const bool pipe : {true, false}) {
    SketchItem item;
    item.id = document.nextFeatureId();
    item.kind = vision::FeatureKind::kLine;
    item.pipe = pipe;
    item.edge = !pipe;
    item.name = document.freeName(item.kind, pipe);
    for (int vertex = 0; vertex < item.vertices(); ++vertex) {
      item.setPick(left, vertex, {{200.0 + 20 * vertex, 150.0 + 40 * vertex}, PickState::kFree});
      item.setPick(right, vertex, {{190.0 + 20 * vertex, 190.0 + 40 * vertex}, PickState::kFree});
    }
    document.insertItem(document.items().size(), item);
    EXPECT_EQ(health.of("head_left").samples, 4) << (pipe ? "pipe" : "edge");
  }
  for (const auto& item : std::vector<SketchItem>(document.items())) document.removeItem(item.id);
  const FeatureId slid = mark(1, PickState::kConstrained);
  mark(1, PickState::kConstrained);
  EXPECT_EQ(health.of("head_left").level, HealthLevel::kUnknown) << "picks slid along their curve have no miss to tell";
  for (int i = 0; i < 3; ++i) mark(1, PickState::kReleased);
  EXPECT_EQ(health.of("head_right").level, HealthLevel::kKnocked) << health.of("head_right").why;
  EXPECT_NEAR(health.of("head_right").off_px, 741 * kDegree, 3);
  EXPECT_NE(health.whyNotTrust(slid).indexOf("knocked"), -1);
  EXPECT_EQ(health.level(), HealthLevel::kKnocked);
}

TEST(Health, FindsKnocksAndRaisesNoFalseAlarms) {
  Random random(84);
  const int trials = 4000;
  int found = 0, false_alarms = 0;
  for (int t = 0; t < trials; ++t) {
    std::vector<calibration::MissSample> quiet, knocked;
    for (int i = 0; i < 5; ++i) {
      const double noise = random.normal(0.7);
      quiet.push_back({"a", "b", noise, 0.7});
      knocked.push_back({"a", "b", noise + 3, 0.7});
    }
    found += calibration::healthOf(knocked, {}).at("a").level == HealthLevel::kKnocked ? 1 : 0;
    false_alarms += calibration::healthOf(quiet, {}).at("a").level == HealthLevel::kKnocked ? 1 : 0;
  }
  EXPECT_GE(found, 0.95 * trials);
  EXPECT_LE(false_alarms, 0.01 * trials);
}

// Five picks in both pictures and five clicks on known corners, through the geometry of the built-in head; the right camera was
// turned by `knock_rad` about any axis across its sight.
int alarms(Random* random, const vision::View& left, const vision::View& right, double knock_rad, int trials) {
  int raised = 0;
  for (int t = 0; t < trials; ++t) {
    const double angle = random->uniform(-3.14159, 3.14159);
    Pose X_WC = right.X_WC;
    X_WC.linear() = X_WC.linear() * expSO3(knock_rad * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0));
    const auto hand = [&](double sigma) { return Eigen::Vector2d(random->normal(sigma), random->normal(sigma)); };
    std::vector<calibration::MissSample> misses;
    std::vector<calibration::LandmarkSample> known;
    while (misses.size() < 5) {
      const Eigen::Vector3d p_W = left.X_WC * Eigen::Vector3d(random->uniform(-0.3, 0.3), random->uniform(-0.25, 0.25), random->uniform(0.8, 1.8));
      const auto a = left.project(p_W), b = right.camera.project(X_WC.inverse() * p_W), thought = right.project(p_W);
      if (!a || !b || !thought) continue;
      const auto miss = missOf(left, *a + hand(left.sigma_px), right, *b + hand(right.sigma_px));
      if (!miss) continue;
      misses.push_back(*miss);
      known.push_back({right.name, *b + hand(1) - *thought, 1.5});
    }
    raised += calibration::healthOf(misses, known).at(right.name).level == HealthLevel::kKnocked ? 1 : 0;
  }
  return raised;
}

TEST_F(Field, HalfADegreeAndThreePixelsAreFoundThroughTheGeometryWithoutFalseAlarms) {
  Random random(85);
  const JointState state = arm(0, 0, 0);
  const auto left = cameraView(*plain, "head_left", state).value(), right = cameraView(*plain, "head_right", state).value();
  const int trials = 1000;
  const int half_degree = alarms(&random, left, right, 0.5 * kDegree, trials), three_px = alarms(&random, left, right, 3 / right.camera.fx, trials);
  const int quiet = alarms(&random, left, right, 0, 2 * trials);
  std::printf("knock of 0.5 deg found %d of %d, of 3 px %d of %d; false alarms %d of %d\n", half_degree, trials, three_px, trials, quiet, 2 * trials);
  EXPECT_GE(half_degree, 0.95 * trials);
  EXPECT_GE(three_px, 0.95 * trials);
  EXPECT_LE(quiet, 0.01 * 2 * trials);
}

TEST(Health, KnownPointsTellWhichOfTwoCamerasMoved) {
  std::vector<calibration::MissSample> misses;
  std::vector<calibration::LandmarkSample> known;
  for (int i = 0; i < 4; ++i) {
    misses.push_back({"a", "b", 6 + 0.1 * i, 0.7});
    known.push_back({"a", {0.2 * i - 0.3, 0.1}, 0.7});
  }
  const auto health = calibration::healthOf(misses, known);
  EXPECT_EQ(health.at("a").level, HealthLevel::kGood);
  EXPECT_EQ(health.at("b").level, HealthLevel::kKnocked);
  EXPECT_NEAR(calibration::chiSquareLimit(1, 0.05), 3.841, 0.02);
  EXPECT_NEAR(calibration::chiSquareLimit(2, 0.001), 13.816, 0.05);
  EXPECT_NEAR(calibration::chiSquareLimit(10, 0.01), 23.209, 0.3);
}

TEST_F(Field, GuidesAlongStraightEdgesGiveTheLens) {
  LensController lens(calibration, jobs);
  lens.setCamera("drive");
  lens.setPicture(cv::Mat(480, 640, CV_8U, cv::Scalar(90)));
  const auto truth = calibration.fileInUse("drive")->camera;
  lens.straightenNothing();
  const double edges[4][4] = {{-0.5, -0.4, 0.5, -0.35}, {-0.5, 0.35, 0.5, 0.4}, {-0.52, -0.35, -0.5, 0.35}, {0.48, -0.35, 0.52, 0.35}};
  for (const auto& e : edges) {
    for (int i = 0; i <= 6; ++i) lens.addPoint(truth.pixelOfNormalised({e[0] + (e[2] - e[0]) * i / 6, e[1] + (e[3] - e[1]) * i / 6}));
    lens.endGuide();
  }
  ASSERT_EQ(lens.guides().size(), 4U);
  EXPECT_GT(*lens.straightness(), 1);
  EXPECT_FALSE(lens.result().has_value());
  lens.solve(2);
  ASSERT_TRUE(waitFor([&] { return !lens.solving(); }));
  ASSERT_TRUE(lens.result().has_value());
  EXPECT_NEAR(lens.lens().distortion[0], truth.distortion[0], 0.01);
  EXPECT_LT(*lens.straightness(), 0.1);
  ASSERT_TRUE(lens.whyNotApply().isEmpty()) << lens.whyNotApply().toStdString();
  ASSERT_TRUE(calibration.apply(lens.change()).ok());
  EXPECT_DOUBLE_EQ(calibration.fileInUse("drive")->camera.fx, truth.fx) << "focal lengths stay";
  lens.setCoefficient(0, -0.1);
  EXPECT_FALSE(lens.result().has_value()) << "moved by hand, it is solved no more";
  lens.removeGuide();
  EXPECT_EQ(lens.guides().size(), 3U);
}

TEST_F(Field, AFixtureIsMatchedFromAFewClicksAndGivesTheCamera) {
  const auto camera = tests::cameraOf(600, 598, 322, 241);
  const Pose X_CW = tests::poseOf({0.5, -0.55, 0.1}, {-0.15, 0.05, 1.2});
  std::string yaml = "name: bench\npanel: {columns: 5, rows: 4, pitch: 0.1, depths: [0, 0.2]}\n";
  const QString fixture = folder.filePath("bench.yaml"), picture = folder.filePath("bench.png");
  std::ofstream(fixture.toStdString()) << yaml;
  cv::Mat image(480, 640, CV_8U, cv::Scalar(210));
  std::vector<Eigen::Vector2d> truth;
  for (const auto& point : calibration::parseFixture(yaml, "bench.yaml")->points) {
    truth.push_back(camera.project(X_CW * point.xyz).value());
    cv::circle(image, {static_cast<int>(std::lround(16 * truth.back().x())), static_cast<int>(std::lround(16 * truth.back().y()))}, 5 * 16, {40}, cv::FILLED, cv::LINE_AA, 4);
  }
  cv::GaussianBlur(image, image, {5, 5}, 0.8);
  ASSERT_TRUE(vision::saveImage(picture.toStdString(), image).ok());
  FixtureController wizard(jobs);
  EXPECT_FALSE(wizard.whyNotMatch().isEmpty());
  wizard.openFixture(fixture);
  wizard.openPicture(picture);
  ASSERT_TRUE(waitFor([&] { return wizard.fixture().has_value() && !wizard.picture().empty(); }));
  for (const int i : {0, 4, 15, 19, 20, 24, 35, 39}) {
    wizard.setPoint(i);
    wizard.click(truth[static_cast<std::size_t>(i)] + Eigen::Vector2d(1.5, -1), 8);
  }
  ASSERT_TRUE(waitFor([&] { return !wizard.busy(); }));
  ASSERT_TRUE(wizard.whyNotMatch().isEmpty()) << wizard.whyNotMatch().toStdString();
  wizard.matchRest();
  ASSERT_TRUE(waitFor([&] { return !wizard.busy() && wizard.matches().size() > 30; })) << wizard.matches().size() << " of 40, " << wizard.dots().size() << " dots";
  ASSERT_TRUE(waitFor([&] { return wizard.result().has_value(); })) << wizard.why().toStdString();
  EXPECT_NEAR(wizard.result()->camera.fx, 600, 8);
  EXPECT_LT(wizard.result()->rms_px, 0.2);
  const QString out = folder.filePath("camera.yaml");
  wizard.save("bench_camera", out);
  const auto file = vision::readCameraFile(out.toStdString());
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->pose->parent, "bench");
  wizard.setDistortion(0);
  wizard.clearMatches();
  EXPECT_FALSE(wizard.result().has_value());
}

TEST_F(Field, AZoomTableIsJudgedAndSaysWhereItLacksACalibration) {
  ZoomController zoom(calibration, jobs);
  EXPECT_FALSE(zoom.whyNotSave().isEmpty());
  const QString file = folder.filePath("zoom.xml");
  std::ofstream(file.toStdString()) << tests::kReportZoomFile;
  zoom.openFile(file);
  ASSERT_TRUE(waitFor([&] { return !zoom.table().nodes.empty(); }));
  EXPECT_EQ(zoom.table().nodes.size(), 8U);
  EXPECT_EQ(zoom.misses().size(), 6U);
  EXPECT_FALSE(zoom.advised().empty());
  EXPECT_FALSE(zoom.whyNotAddLens("ptz_left", 0.5).isEmpty()) << "no board was calibrated";
  EXPECT_FALSE(zoom.whyNotAddLens("ptz_left", 1.5).isEmpty());
  const QString again = folder.filePath("again.xml");
  zoom.save(again);
  const auto reread = vision::readZoomFile(again.toStdString());
  ASSERT_TRUE(reread.ok()) << reread.error().message;
  EXPECT_EQ(reread->cameras.front().nodes.size(), 8U);
  zoom.removeNode(0);
  EXPECT_EQ(zoom.table().nodes.size(), 7U);
  EXPECT_EQ(ZoomController::approach(0.5).size(), 2U);
  EXPECT_LT(ZoomController::approach(0.5)[0], 0.5);
  EXPECT_EQ(ZoomController::approach(0).size(), 1U);
}

}  // namespace
}  // namespace longarm::session
