// Points that stick to known geometry, the foot of a pan-tilt, advice on the next picture, two cameras on one head.
#include <QDir>

#include "session/calibration/solve_again.h"
#include "session/calibration/stereo_controller.h"
#include "tests/session/field_rig.h"
#include "tests/support/test_data.h"
#include "vision/snapshot/image_file.h"

namespace longarm::session {
namespace {

using calibration::LoopUnknown;
using tests::kDegree;
using tests::Random;
using Kind = GeometryPoint::Kind;

bool everything(const std::string&, const std::string&) { return true; }
bool onlyCrate(const std::string& thing, const std::string&) { return thing == "crate"; }

class Geometry : public Field {
 protected:
  void SetUp() override {
    Field::SetUp();
    q = plain->model->neutral();
    X_WO = plain->objects.front().X_WO;
  }
  // A ray from before the crate, high on its left, to a place of the crate's frame.
  std::optional<GeometryPoint> at(const Eigen::Vector3d& p_O, const KnownGeometry& geometry, double snap_rad = 0.02, const KnownGeometry::Serves& serves = everything) {
    const Eigen::Vector3d eye = X_WO * Eigen::Vector3d(-1.0, -0.8, 0.9);
    return geometry.pointOn(eye, (X_WO * p_O - eye).normalized(), snap_rad, q, serves);
  }
  Eigen::Vector3d inCrate(const GeometryPoint& point) { return X_WO.inverse() * (point.landmark.X_LO * point.landmark.xyz); }
  Eigen::VectorXd q;
  Pose X_WO;
};

TEST_F(Geometry, APointSnapsToCornersThenEdgesElseLiesOnTheSurface) {
  const KnownGeometry geometry(plain, {});
  const Eigen::Vector3d corner(-0.2, -0.15, 0.125);
  const auto on_corner = at(corner + Eigen::Vector3d(0.01, 0.012, 0), geometry);
  ASSERT_TRUE(on_corner.has_value());
  EXPECT_EQ(on_corner->kind, Kind::kCorner);
  EXPECT_EQ(on_corner->landmark.thing, "crate");
  EXPECT_LT((inCrate(*on_corner) - corner).norm(), 1e-9);
  const auto on_edge = at({-0.05, -0.145, 0.125}, geometry);
  ASSERT_TRUE(on_edge.has_value());
  EXPECT_EQ(on_edge->kind, Kind::kEdge);
  EXPECT_NEAR(inCrate(*on_edge).y(), -0.15, 1e-9);
  EXPECT_NEAR(inCrate(*on_edge).z(), 0.125, 1e-9);
  EXPECT_NEAR(inCrate(*on_edge).x(), -0.05, 0.01);
  const auto on_top = at({0.02, 0.01, 0.125}, geometry);
  ASSERT_TRUE(on_top.has_value());
  EXPECT_EQ(on_top->kind, Kind::kSurface);
  EXPECT_LT((inCrate(*on_top) - Eigen::Vector3d(0.02, 0.01, 0.125)).norm(), 1e-9);
  EXPECT_GT(on_top->landmark.sigma_m, on_corner->landmark.sigma_m);
  EXPECT_FALSE(at({0, 0, 4}, geometry).has_value()) << "the sky is no known surface";
}

TEST_F(Geometry, AHiddenCornerDoesNotSnapAndWhatMayNotServeOnlyHides) {
  const KnownGeometry geometry(plain, {});
  const Eigen::Vector3d hidden(0.2, 0.15, -0.125);   // behind and below
  const auto through = at(hidden, geometry, 0.005);
  ASSERT_TRUE(through.has_value());
  EXPECT_NE(through->kind, Kind::kCorner);
  EXPECT_GT((inCrate(*through) - hidden).norm(), 0.1);
  EXPECT_FALSE(at({0.02, 0.01, 0.125}, geometry, 0.02, [](const auto& thing, const auto&) { return thing != "crate"; }).has_value());
}

TEST_F(Geometry, LinksMeshesAndSketchedBodiesServeToo) {
  WorldItem pipe;
  pipe.name = "Pipe 1";
  pipe.kind = WorldKind::kPipe;
  pipe.X_WO = poseFromRpy({1.0, -0.6, 0.4}, {0, 1.5707963, 0});
  pipe.size = {0.06, 0.06, 0.3};
  const KnownGeometry geometry(plain, {pipe});
  const auto on_pipe = geometry.pointOn({1.0, -0.6, 1.4}, {0, 0, -1}, 0.001, q, everything);
  ASSERT_TRUE(on_pipe.has_value());
  EXPECT_EQ(on_pipe->landmark.thing, "Pipe 1");
  EXPECT_NEAR((on_pipe->landmark.X_LO * on_pipe->landmark.xyz).z(), 0.43, 1e-9);
  // The hull of the vehicle is a mesh.
  const auto on_robot = geometry.pointOn({0, 2, 0.2}, {0, -1, 0}, 0.001, q, [](const auto&, const auto& link) { return link == "base_link"; });
  ASSERT_TRUE(on_robot.has_value());
  EXPECT_EQ(on_robot->landmark.link, "base_link");
  EXPECT_GT(geometry.edges(q, [](const auto&, const auto& link) { return link == "base_link"; }).size(), 12U);
  // A finger's point moves with the finger.
  const auto fingers = geometry.edges(q, [](const auto&, const auto& link) { return link == "finger_left_link"; });
  ASSERT_FALSE(fingers.empty());
  Eigen::VectorXd turned = q;
  turned[plain->model->joints()[static_cast<std::size_t>(plain->model->jointIndex("arm_1_joint").value())].q_index] += 0.3;
  EXPECT_FALSE(geometry.edges(turned, [](const auto&, const auto& link) { return link == "finger_left_link"; }).front().first.isApprox(fingers.front().first, 1e-3));
}

TEST_F(Geometry, AMovedObjectIsWhereItWasPut) {
  KnownGeometry geometry(plain, {});
  X_WO = X_WO * Eigen::Translation3d(0.5, 0, 0);
  geometry.place("crate", X_WO);
  const auto on_top = at({0.02, 0.01, 0.125}, geometry, 0.001, onlyCrate);
  ASSERT_TRUE(on_top.has_value());
  EXPECT_LT((inCrate(*on_top) - Eigen::Vector3d(0.02, 0.01, 0.125)).norm(), 1e-9);
}

TEST_F(Field, ClickedSurfacesBecomeLandmarksThatServeLikeCorners) {
  PoseController pose(document, calibration, jobs);
  pose.setCamera("head_left");
  const SnapshotId id = addSnapshot("head_left", arm(0, -0.15, 2.15));
  pose.setSnapshot(id);
  const auto view = document.snapshot(id)->view;
  const Pose X_WO = plain->objects.front().X_WO;
  const auto pixel = [&](const Eigen::Vector3d& p_O) { return view.project(X_WO * p_O).value(); };
  const std::size_t before = pose.landmarks().size();
  ASSERT_TRUE(pose.stickAtPixel(pixel({-0.05, 0.02, 0.125}), 6).ok());
  ASSERT_EQ(pose.landmarks().size(), before + 1);
  EXPECT_EQ(pose.landmarks().back().name, "crate surface point 1");
  EXPECT_EQ(pose.landmark(), static_cast<int>(before));
  // A corner that the list has is chosen, not doubled.
  const int corner = pose.landmarkNear(pixel({-0.2, -0.15, 0.125}), 2);
  ASSERT_GE(corner, 0);
  ASSERT_TRUE(pose.stickAtPixel(pixel({-0.2, -0.15, 0.125}), 6).ok());
  EXPECT_EQ(pose.landmarks().size(), before + 1);
  EXPECT_EQ(pose.landmark(), corner);
  const auto sky = pose.stick(view.X_WC.translation(), {0, 0, 1}, 0.01);
  ASSERT_FALSE(sky.ok());
  EXPECT_NE(sky.error().message.find("no known surface"), std::string::npos);
  // Surface points alone give the camera.
  Random random(91);
  const Pose knock = tests::poseOf({0.8 * kDegree, -0.7 * kDegree, 0.3 * kDegree}, {0.003, -0.002, 0.002});
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(-0.1, -0.1, 0.125), {0.12, -0.1, 0.125}, {-0.12, 0.1, 0.125}, {0.1, 0.12, 0.125}, {0.02, 0, 0.125}, {-0.2, 0, 0}, {-0.2, -0.1, -0.05}, {-0.2, 0.1, 0.05}}) {
    if (!pose.stickAtPixel(pixel(p), 2).ok()) continue;
    const Eigen::Vector3d p_W = X_WO * p;
    pose.pick(view.camera.project((view.X_WC * knock).inverse() * p_W).value() + Eigen::Vector2d(random.normal(0.3), random.normal(0.3)));
  }
  ASSERT_GE(pose.picks().size(), 6U);
  ASSERT_TRUE(solved(pose));
  ASSERT_TRUE(pose.outcome().has_value()) << pose.why().toStdString();
  EXPECT_LT(angleBetween((view.X_WC * knock).linear(), pose.viewNow()->X_WC.linear()) / kDegree, 0.6);
  EXPECT_NE(pose.nextPicture().indexOf("turn head to pan"), -1) << pose.nextPicture().toStdString();
  pose.clear();
  EXPECT_EQ(pose.landmarks().size(), before) << "points that were made go with the clicks";
}

TEST_F(Field, WhereTwoPosesFitTheOperatorTakesTheOneThatLiesOnThePicture) {
  PoseController pose(document, calibration, jobs);
  pose.setCamera("head_left");
  pose.setObject("crate");
  pose.setUnknown(LoopUnknown::kObj);
  const SnapshotId id = addSnapshot("head_left", arm(0, -0.15, 2.15));
  const auto view = document.snapshot(id)->view;
  const Pose truth = plain->objects.front().X_WO * tests::poseOf({0, 0, 0.2}, {0.03, 0.02, 0});
  // Three corners have several answers.
  bool offered = false;
  for (const auto& corners : {std::array<int, 3>{0, 1, 4}, {0, 2, 4}, {4, 5, 6}, {0, 4, 6}, {4, 6, 7}}) {
    pose.clear();
    for (const int i : corners) {
      pose.setLandmark(i);
      pose.pick(view.project(truth * pose.landmarks()[static_cast<std::size_t>(i)].xyz).value());
    }
    ASSERT_TRUE(solved(pose));
    if (!pose.outcome() || pose.outcome()->result.alternatives.empty()) continue;
    offered = true;
    const Pose first = pose.solvedObjectPose(), other = pose.outcome()->result.alternatives.front().T.inverse();
    pose.takeAlternative();
    ASSERT_TRUE(solved(pose));
    ASSERT_TRUE(pose.outcome().has_value()) << pose.why().toStdString();
    EXPECT_TRUE(pose.solvedObjectPose().isApprox(other, 1e-4));
    EXPECT_LT(pose.outcome()->result.rms_px, 0.01);
    bool back = false;
    for (const auto& each : pose.outcome()->result.alternatives) back = back || each.T.inverse().isApprox(first, 1e-4);
    EXPECT_TRUE(back) << "the first is an alternative now";
  }
  EXPECT_TRUE(offered);
}

TEST_F(Field, AdviceForACameraThatStandsStillSaysWhereToHoldTheGripper) {
  Random random(92);
  PoseController pose(document, calibration, jobs);
  pose.setCamera("drive");
  const SnapshotId id = addSnapshot("drive", arm(0, 0.9, 1.2, 1.0));
  ASSERT_GE(clickAll(&pose, document, id, document.snapshot(id)->view.X_WC, &random, 8), 5);
  ASSERT_TRUE(solved(pose));
  ASSERT_TRUE(pose.outcome().has_value()) << pose.why().toStdString();
  EXPECT_NE(pose.nextPicture().indexOf("hold the gripper"), -1) << pose.nextPicture().toStdString();
  EXPECT_NE(pose.resultText().indexOf("Next picture"), -1);
}

TEST_F(Field, TheFootOfAPanTiltIsPutRightKeptAndGoneBackFrom) {
  const auto pan = panJointOf(*plain, "head").value();
  const Pose own = plain->model->joints()[static_cast<std::size_t>(pan)].X_PJ;
  const Pose truth = own * tests::poseOf({0.9 * kDegree, -1.1 * kDegree, 0.8 * kDegree}, {0.006, -0.004, 0.005});
  const auto true_model = plain->model->withJointPose(pan, truth);
  ASSERT_FALSE(truth.isApprox(own, 1e-4));
  EXPECT_TRUE(plain->model->joints()[static_cast<std::size_t>(pan)].X_PJ.isApprox(own)) << "the workcell's own robot stays as it is";
  Vector6d squares = Vector6d::Zero();
  const int runs = 24;
  for (int run = 0; run < runs; ++run) {
    Random random(300 + static_cast<unsigned>(run));
    PoseController pose(document, calibration, jobs);
    pose.setCamera("head_left");
    pose.setUnknown(LoopUnknown::kDev);
    for (const double turn : {-0.3, 0.0, 0.35}) {
      JointState state = arm(0, -0.15, 2.15);
      state.names.insert(state.names.end(), {"head_pan_joint", "head_tilt_joint"});
      state.positions.conservativeResize(6);
      state.positions.tail<2>() << turn, 0.35 + 0.3 * turn;
      state.velocities = Eigen::VectorXd::Zero(6);
      const SnapshotId id = run == 0 ? addSnapshot("head_left", state) : pose.snapshots()[turn < -0.1 ? 0 : turn < 0.1 ? 1 : 2]->id;
      Eigen::VectorXd q = true_model->neutral();
      true_model->assign(state, q);
      clickAll(&pose, document, id, true_model->forward(q, true_model->linkIndex("head_left_optical").value()), &random, 10);
    }
    ASSERT_TRUE(solved(pose));
    ASSERT_TRUE(pose.outcome().has_value()) << pose.why().toStdString();
    ASSERT_TRUE(pose.whyNotApply().isEmpty()) << pose.whyNotApply().toStdString();
    const PlaceChange change = pose.placeChange();
    EXPECT_EQ(change.placement.pose.parent, "torso_link");
    const Pose& found = change.placement.pose.pose;
    Vector6d error;
    error << logSO3(found.linear() * truth.linear().transpose()), found.translation() - truth.translation();
    squares += error.cwiseAbs2().cwiseQuotient(change.placement.covariance.diagonal());
    if (run > 0) continue;
    EXPECT_LT(angleBetween(found.linear(), truth.linear()) / kDegree, 0.25);
    EXPECT_LT((found.translation() - truth.translation()).norm(), 0.006);
    ASSERT_TRUE(calibration.apply(change).ok());
    EXPECT_TRUE(document.workcell()->model->joints()[static_cast<std::size_t>(pan)].X_PJ.isApprox(found)) << "both cameras of the head move with it";
    EXPECT_TRUE(afterRestart()->model->joints()[static_cast<std::size_t>(pan)].X_PJ.isApprox(found, 1e-9));
    ASSERT_TRUE(calibration.usePlacement(Subject::kPanTilt, "head", {}).ok());
    EXPECT_TRUE(document.workcell()->model->joints()[static_cast<std::size_t>(pan)].X_PJ.isApprox(own));
    QString told;
    QObject::connect(&calibration, &CalibrationController::failed, [&told](const QString& sentence) { told = sentence; });
    calibration.solveAgain(calibration.library().records(plain->name, "head", Subject::kPanTilt).front().id);
    ASSERT_TRUE(waitFor([&] { return !told.isEmpty(); }));
    EXPECT_NE(told.indexOf("own page"), -1) << told.toStdString();
  }
  EXPECT_NEAR(squares.mean() / runs, 1, 0.5) << "stated against true errors, per component";
}

TEST_F(Field, ACameraAndAnObjectThatNobodyKnowsAreFoundTogether) {
  const Pose own = document.workcell()->objects.front().X_WO;
  const Pose X_WO = own * tests::poseOf({0.02, -0.03, 0.06}, {0.04, -0.03, 0.02});
  const Pose X_LC = tests::poseOf({1.1 * kDegree, -0.8 * kDegree, 0.6 * kDegree}, {0.006, -0.005, 0.004});
  const auto& model = *plain->model;
  const int link = model.linkIndex("head_left_optical").value();
  Random random(91);
  PoseController pose(document, calibration, jobs);
  pose.setCamera("head_left");
  pose.setUnknown(LoopUnknown::kObj);
  pose.setObject("crate");
  pose.setCameraToo(true);
  ASSERT_TRUE(pose.cameraToo());
  const std::pair<double, double> angles[] = {{-0.35, 0.1}, {0.0, 0.45}, {0.3, 0.2}, {-0.15, 0.5}, {0.2, -0.05}};
  for (const auto& [pan, tilt] : angles) {
    JointState state = arm(0, -0.15, 2.15);
    state.names.insert(state.names.end(), {"head_pan_joint", "head_tilt_joint"});
    state.positions.conservativeResize(6);
    state.positions.tail<2>() << pan, tilt;
    state.velocities = Eigen::VectorXd::Zero(6);
    const SnapshotId id = addSnapshot("head_left", state);
    pose.setSnapshot(id);
    const auto snapshot = document.snapshot(id);
    Eigen::VectorXd q = model.neutral();
    model.assign(state, q);
    const Pose X_WC = model.forward(q, link) * X_LC;
    for (std::size_t i = 0; i < pose.landmarks().size(); ++i) {
      const auto pixel = snapshot->view.camera.project(X_WC.inverse() * X_WO * pose.landmarks()[i].xyz);
      if (!pixel || !snapshot->view.camera.containsPixel(*pixel, -3)) continue;
      pose.setLandmark(static_cast<int>(i));
      pose.pick(*pixel + Eigen::Vector2d(random.normal(0.5), random.normal(0.5)));
    }
  }
  ASSERT_GE(pose.picks().size(), 18U);
  ASSERT_TRUE(solved(pose));
  ASSERT_TRUE(pose.outcome().has_value()) << pose.why().toStdString();
  ASSERT_TRUE(pose.whyNotApply().isEmpty()) << pose.whyNotApply().toStdString();
  EXPECT_GT(*pose.missInUse(), 8) << "with what is in use";
  EXPECT_LT(pose.outcome()->result.rms_px, 1);
  const CameraChange camera = pose.change();
  const PlaceChange place = pose.placeChange();
  const auto off = [](const Pose& found, const Pose& truth) {
    Vector6d error;
    error << logSO3(found.linear() * truth.linear().transpose()), found.translation() - truth.translation();
    return error;
  };
  const Vector6d e_camera = off(*camera.X_LC, X_LC), e_object = off(place.placement.pose.pose, X_WO);
  for (int i = 0; i < 6; ++i) {
    EXPECT_LT(std::abs(e_camera[i]), 3.5 * std::sqrt(camera.pose_covariance(i, i))) << "camera " << i;
    EXPECT_LT(std::abs(e_object[i]), 3.5 * std::sqrt(place.placement.covariance(i, i))) << "object " << i;
  }
  EXPECT_LT(e_camera.head<3>().norm() / kDegree, 1) << "it was 1.5 off, and nothing else was known";
  EXPECT_LT(e_object.tail<3>().norm(), 0.02) << "it was 54 mm off";
  EXPECT_TRUE(pose.resultText().contains("Camera in link")) << pose.resultText().toStdString();
  // What is drawn lies on the picture with both as found.
  const auto view = pose.viewNow();
  ASSERT_TRUE(view.has_value());
  const auto corner = view->project(place.placement.pose.pose * pose.picks().back().landmark.xyz);
  ASSERT_TRUE(corner.ok());
  EXPECT_LT((*corner - pose.picks().back().pixel).norm(), 3);
  ASSERT_TRUE(calibration.apply(place).ok());
  ASSERT_TRUE(calibration.apply(camera).ok());
  EXPECT_TRUE(document.workcell()->objects.front().X_WO.isApprox(place.placement.pose.pose, 1e-9));
  EXPECT_TRUE(calibration.fileInUse("head_left")->pose->pose.isApprox(*camera.X_LC, 1e-9));
  // One angle alone cannot tell the two apart.
  PoseController still(document, calibration, jobs);
  still.setCamera("head_left");
  still.setUnknown(LoopUnknown::kObj);
  still.setObject("crate");
  still.setCameraToo(true);
  clickAll(&still, document, still.snapshots().front()->id, document.snapshot(still.snapshots().front()->id)->view.X_WC, &random, 7);
  ASSERT_TRUE(solved(still));
  EXPECT_FALSE(still.outcome().has_value());
  EXPECT_FALSE(still.why().isEmpty());
}

TEST_F(Field, APoseLessCertainThanTheOneInUseIsSaidToBe) {
  CameraChange change;
  change.camera = "drive";
  change.kind = "pose";
  change.X_LC = Pose::Identity();
  change.pose_covariance = 1e-6 * Matrix6d::Identity();
  ASSERT_TRUE(calibration.apply(change).ok());
  EXPECT_TRUE(calibration.whyWorse(change).isEmpty());
  change.pose_covariance *= 9;
  EXPECT_NE(calibration.whyWorse(change).indexOf("Less certain"), -1) << calibration.whyWorse(change).toStdString();
}

class StereoPair : public Field {
 protected:
  bool settled(const StereoController& wizard) {
    return waitFor([&] { return !wizard.searching() && !wizard.solving(); });
  }
  QStringList pictures(const char* pattern) {
    const QDir data(QString::fromStdString(tests::dataFolder()) + QStringLiteral("/opencv_stereo_chess"));
    QStringList out;
    for (const QString& name : data.entryList({QString::fromLatin1(pattern)}, QDir::Files, QDir::Name)) out << data.filePath(name);
    return out;
  }
};

TEST_F(StereoPair, RealPairsGiveTheBaselineAndBothCamerasAreSavedAndUsed) {
  LONGARM_SKIP_WITHOUT_DATA();
  StereoController wizard(document, calibration, jobs);
  EXPECT_NE(wizard.why().indexOf("left and the right camera"), -1) << wizard.why().toStdString();
  wizard.setCameras("head_left", "head_right");
  EXPECT_NE(wizard.why().indexOf("no pairs"), -1) << wizard.why().toStdString();
  calibration::BoardSpec board;
  board.square = 0.03;
  wizard.setBoard(board);
  wizard.setRefine(true);
  wizard.addFiles(pictures("left*.jpg") + pictures("right*.jpg"));
  ASSERT_TRUE(settled(wizard));
  ASSERT_TRUE(wizard.outcome().has_value()) << wizard.why().toStdString();
  EXPECT_EQ(wizard.pairs().size(), 13U);
  const auto& result = wizard.outcome()->result;
  EXPECT_NEAR(result.X_LR.translation().norm(), 0.1, 0.003) << "Bouguet's rig: 3.33 squares of 30 mm";
  EXPECT_NE(wizard.resultText().indexOf("Baseline"), -1);
  QStringList saved;
  QObject::connect(&wizard, &StereoController::saved, [&saved](const QString& left, const QString& right) { saved << left << right; });
  wizard.save(folder.filePath("left.yaml"), folder.filePath("right.yaml"));
  ASSERT_EQ(saved.size(), 2);
  const auto left = vision::readCameraFile(saved[0].toStdString()), right = vision::readCameraFile(saved[1].toStdString());
  ASSERT_TRUE(left.ok() && right.ok());
  EXPECT_TRUE((left->pose->pose.inverse() * right->pose->pose).isApprox(result.X_LR, 1e-9));
  EXPECT_EQ(right->covariance->rows(), 16);
  ASSERT_TRUE(wizard.whyNotApply().isEmpty()) << wizard.whyNotApply().toStdString();
  const auto changes = wizard.changes();
  ASSERT_EQ(changes.size(), 2U);
  const Pose X_LR = result.X_LR;
  for (const auto& change : changes) ASSERT_TRUE(calibration.apply(change).ok());
  const JointState state = arm(0, 0, 0);
  const auto in_use_left = cameraView(*document.workcell(), "head_left", state).value(), in_use_right = cameraView(*document.workcell(), "head_right", state).value();
  EXPECT_TRUE((in_use_left.X_WC.inverse() * in_use_right.X_WC).isApprox(X_LR, 1e-9));
  ASSERT_TRUE(settled(wizard));
}

TEST_F(StereoPair, AWrongSquareShowsInTheBaseline) {
  LONGARM_SKIP_WITHOUT_DATA();
  // A head whose cameras stand as those that took the pictures.
  CameraChange mount;
  mount.camera = "head_right";
  mount.kind = "pose";
  const JointState state = arm(0, 0, 0);
  const auto left = cameraView(*plain, "head_left", state).value(), right = cameraView(*plain, "head_right", state).value();
  mount.X_LC = right.X_WC.inverse() * left.X_WC * Eigen::Translation3d(0.1, 0, 0);
  mount.pose_covariance = 1e-6 * Matrix6d::Identity();
  ASSERT_TRUE(calibration.apply(mount).ok());
  StereoController wizard(document, calibration, jobs);
  wizard.setCameras("head_left", "head_right");
  wizard.setRefine(true);
  calibration::BoardSpec board;
  board.square = 0.025;                            // they are 30 mm
  wizard.setBoard(board);
  wizard.addFiles(pictures("left0[1-5].jpg") + pictures("right0[1-5].jpg"));
  ASSERT_TRUE(settled(wizard));
  ASSERT_TRUE(wizard.outcome().has_value()) << wizard.why().toStdString();
  EXPECT_NE(wizard.resultText().indexOf("are the squares 3"), -1) << wizard.resultText().toStdString();
  board.square = 0.03;
  wizard.setBoard(board);
  ASSERT_TRUE(settled(wizard));
  EXPECT_EQ(wizard.resultText().indexOf("are the squares"), -1) << wizard.resultText().toStdString();
}

TEST_F(StereoPair, PairsLeftOutAndOddNumbersAreToldAndCamerasOnDifferentBodiesAreNoMount) {
  LONGARM_SKIP_WITHOUT_DATA();
  StereoController wizard(document, calibration, jobs);
  QStringList told;
  QObject::connect(&wizard, &StereoController::failed, [&told](const QString& sentence) { told << sentence; });
  wizard.setCameras("head_left", "wrist");
  calibration::BoardSpec board;
  board.square = 0.03;
  wizard.setBoard(board);
  wizard.addFiles(pictures("left01.jpg"));
  ASSERT_EQ(told.size(), 1);
  EXPECT_NE(told[0].indexOf("expected pairs"), -1) << told[0].toStdString();
  wizard.addFiles(pictures("left0[1-5].jpg") + pictures("right0[1-5].jpg"));
  ASSERT_TRUE(settled(wizard));
  ASSERT_TRUE(wizard.outcome().has_value()) << wizard.why().toStdString();
  EXPECT_NE(wizard.whyNotApply().indexOf("joint between"), -1) << wizard.whyNotApply().toStdString();
  for (std::size_t i = 0; i < 3; ++i) wizard.setIncluded(i, false);
  ASSERT_TRUE(settled(wizard));
  EXPECT_FALSE(wizard.outcome().has_value());
  EXPECT_NE(wizard.why().indexOf("2 pairs"), -1) << wizard.why().toStdString();
  wizard.clear();
  EXPECT_TRUE(wizard.pairs().empty());
}

TEST_F(StereoPair, ABoardAtRestBeforeBothLiveCamerasIsKeptOnce) {
  LONGARM_SKIP_WITHOUT_DATA();
  StereoController wizard(document, calibration, jobs);
  wizard.setCameras("head_left", "head_right");
  const cv::Mat left = vision::loadImage(pictures("left01.jpg").front().toStdString()).value(), right = vision::loadImage(pictures("right01.jpg").front().toStdString()).value();
  int shown = 0;
  QObject::connect(&wizard, &StereoController::liveChanged, [&shown] { ++shown; });
  wizard.offerLive(0, left, 5);
  wizard.offerLive(1, right, 9);
  EXPECT_EQ(shown, 0) << "four seconds apart";
  for (int i = 0; i < 5; ++i) {
    const int before = shown;
    wizard.offerLive(0, left, 10 + 0.3 * i);
    wizard.offerLive(1, right, 10 + 0.3 * i);
    ASSERT_TRUE(waitFor([&] { return shown > before; }));
  }
  EXPECT_EQ(wizard.pairs().size(), 1U);
  EXPECT_TRUE(wizard.pairs().front().usable());
}

}  // namespace
}  // namespace longarm::session
