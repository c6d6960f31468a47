// Accepted calibrations: kept, used, gone back from; and what a damaged library does.
#include <filesystem>
#include <fstream>

#include <QTemporaryDir>

#include "session/calibration/calibration_controller.h"
#include "session/controllers/snapshot_maker.h"
#include "tests/session/event_loop.h"

namespace longarm::session {
namespace {

class Library : public longarm::testing::EventLoopTest {
 protected:
  void SetUp() override {
    workcell = std::make_shared<planning::Workcell>(planning::loadBuiltInWorkcell().value());
    open();
  }
  void open() {
    calibration = std::make_unique<CalibrationController>(document, jobs, folder.path());
    calibration->setWorkcell(workcell);
    document.setWorkcell(calibration->workcellInUse());
    QObject::connect(calibration.get(), &CalibrationController::applied, [this] { document.setWorkcell(calibration->workcellInUse()); });
  }
  CameraChange lensChange(double fx, double sigma) {
    CameraChange change;
    change.camera = "drive";
    change.kind = "intrinsics";
    change.lens = calibration->fileInUse("drive")->camera;
    change.lens->fx = fx;
    change.lens_covariance = sigma * sigma * Eigen::Matrix<double, 10, 10>::Identity();
    change.lens_covariance.bottomRightCorner<5, 5>() *= 1e-6;
    change.raw = "view,x,y,z,u,v\n";
    change.raw_ending = "csv";
    return change;
  }
  double focal() { return calibration->fileInUse("drive")->camera.fx; }

  QTemporaryDir folder;
  JobRunner jobs{1};
  Document document;
  std::shared_ptr<planning::Workcell> workcell;
  std::unique_ptr<CalibrationController> calibration;
};

TEST_F(Library, AnAcceptedLensIsUsedKeptOverARestartAndCanBeGoneBackFrom) {
  const double own = focal();
  ASSERT_TRUE(calibration->apply(lensChange(530, 0.3)).ok());
  EXPECT_DOUBLE_EQ(focal(), 530);
  open();
  EXPECT_DOUBLE_EQ(focal(), 530) << "after a restart";
  const auto record = calibration->recordInUse("drive");
  ASSERT_TRUE(record.has_value());
  EXPECT_EQ(record->kind, "intrinsics");
  EXPECT_TRUE(std::filesystem::exists(record->raw)) << record->raw;
  EXPECT_GT(record->uncertainty_px, 0);
  ASSERT_TRUE(calibration->apply(lensChange(540, 0.3)).ok());
  EXPECT_EQ(calibration->library().records(workcell->name, "drive").size(), 2U);
  ASSERT_TRUE(calibration->use("drive", record->id).ok());
  EXPECT_DOUBLE_EQ(focal(), 530);
  ASSERT_TRUE(calibration->use("drive", "").ok());
  EXPECT_DOUBLE_EQ(focal(), own);
  EXPECT_FALSE(calibration->use("drive", "no such").ok());
  EXPECT_FALSE(calibration->use("nobody", "").ok());
}

TEST_F(Library, ANewLensKeepsTheMountAndANewMountKeepsTheLens) {
  ASSERT_TRUE(calibration->apply(lensChange(530, 0.3)).ok());
  CameraChange mount;
  mount.camera = "drive";
  mount.kind = "pose";
  mount.X_LC = poseFromRpy({0.01, 0.02, -0.01}, {0.02, -0.01, 0.03});
  mount.pose_covariance = 1e-6 * Matrix6d::Identity();
  JointState state;
  const auto before = cameraView(*document.workcell(), "drive", state);
  ASSERT_TRUE(before.ok()) << before.error().message;
  ASSERT_TRUE(calibration->apply(mount).ok());
  EXPECT_DOUBLE_EQ(focal(), 530);
  const auto after = cameraView(*document.workcell(), "drive", state);
  ASSERT_TRUE(after.ok());
  EXPECT_TRUE(after->X_WC.isApprox(before->X_WC * *mount.X_LC, 1e-9)) << "the mount stands in the camera's link";
  ASSERT_TRUE(calibration->apply(lensChange(531, 0.3)).ok());
  const auto again = cameraView(*document.workcell(), "drive", state);
  EXPECT_TRUE(again->X_WC.isApprox(after->X_WC, 1e-9));
  EXPECT_GT(again->pose_covariance.trace(), 0);
}

TEST_F(Library, AWorseCalibrationIsSaidToBe) {
  ASSERT_TRUE(calibration->apply(lensChange(530, 0.3)).ok());
  EXPECT_TRUE(calibration->whyWorse(lensChange(530, 0.2)).isEmpty());
  EXPECT_FALSE(calibration->whyWorse(lensChange(530, 3)).isEmpty());
}

TEST_F(Library, ALensForPicturesOfAnotherSizeIsRefused) {
  CameraChange change = lensChange(530, 0.3);
  change.lens->width = 320;
  const Status applied = calibration->apply(change);
  ASSERT_FALSE(applied.ok());
  EXPECT_NE(applied.error().message.find("640 x 480"), std::string::npos) << applied.error().message;
  change.camera = "nobody";
  EXPECT_FALSE(calibration->apply(change).ok());
}

// Kept beside the others, in use at every zoom, and gone back from.
TEST_F(Library, ATableOfAZoomCameraIsUsedAtItsZoom) {
  auto ptz = planning::loadBuiltInWorkcell("ptz");
  ASSERT_TRUE(ptz.ok()) << ptz.error().message;
  const auto cell = std::make_shared<const planning::Workcell>(std::move(*ptz));
  calibration->setWorkcell(cell);
  const auto focalAt = [&](double zoom) {
    const auto view = cameraView(*calibration->workcellInUse(), "ptz_left", {}, zoom);
    return view ? view->camera.fx : -1;
  };
  const double own = focalAt(0.2);
  vision::ZoomFile table = *vision::readZoomFile(cell->camera("ptz_left")->calibration);
  for (auto& node : table.cameras.front().nodes) node.interior[0] *= 1.01;
  table.cameras.front().nodes.pop_back();                  // calibrated up to 0.7 only
  ASSERT_TRUE(calibration->applyTable("ptz_left", table).ok());
  EXPECT_NEAR(focalAt(0.2), 1.01 * own, 1e-6);
  EXPECT_EQ(focalAt(0.75), -1) << "beyond its settings nothing is measured";
  EXPECT_EQ(calibration->recordInUse("ptz_left")->kind, "zoom");
  EXPECT_FALSE(calibration->applyTable("wrist", table).ok());
  ASSERT_TRUE(calibration->use("ptz_left", "").ok());
  EXPECT_DOUBLE_EQ(focalAt(0.2), own);
}

TEST_F(Library, ADamagedRecordIsLeftOutAndTold) {
  ASSERT_TRUE(calibration->apply(lensChange(530, 0.3)).ok());
  const auto record = *calibration->recordInUse("drive");
  std::ofstream(std::filesystem::path(record.file).parent_path() / "record.json") << "{\"workcell\": 3";
  open();
  EXPECT_FALSE(calibration->recordInUse("drive").has_value());
  EXPECT_EQ(calibration->library().warnings().size(), 2U) << "the record, and that it was in use";
  std::ofstream(folder.filePath("in_use.json").toStdString()) << "[1, 2";
  open();
  EXPECT_FALSE(calibration->library().warnings().empty());
}

}  // namespace
}  // namespace longarm::session
