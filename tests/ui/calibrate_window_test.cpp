// The task Calibrate in the whole window, with real pictures and a simulated hand.
#include <QComboBox>
#include <QCheckBox>
#include <QDir>
#include <QFileDialog>
#include <QMenuBar>
#include <QPushButton>
#include <QSlider>
#include <QTabWidget>
#include <QTableWidget>
#include <QTest>

#include "calibration/intrinsics/board_detector.h"
#include "planning/world/workcell.h"
#include "session/controllers/snapshot_maker.h"
#include "tests/support/test_data.h"
#include "tests/ui/window_fixture.h"

namespace longarm {
namespace {

using ui::ActionId;
using ui::CalibrateIntrinsicsPanel;
using ui::SimulatedHand;
using ui::Task;

class CalibrateWindow : public tests::WindowFixture {
 protected:
  void openCalibrate(const QSize& size = {1280, 800}) {
    openWindow(QStringLiteral("dark"), size);
    bench->setWorkcell(std::make_shared<planning::Workcell>(planning::loadBuiltInWorkcell().value()));
    window->tasks()->setTask(Task::kCalibrate);
    SimulatedHand::pump(50);
  }
  QStringList pictures(const char* pattern) {
    const QDir data(QString::fromStdString(tests::dataFolder()) + QStringLiteral("/opencv_stereo_chess"));
    QStringList files;
    for (const QString& name : data.entryList({QString::fromLatin1(pattern)}, QDir::Files, QDir::Name)) files << data.filePath(name);
    return files;
  }
  QStringList leftPictures() { return pictures("left*.jpg"); }
  // A workcell with a crate before the head, and a picture that the head took of it.
  void openWithCrate(const QSize& size) {
    openWindow(QStringLiteral("dark"), size);
    auto workcell = std::make_shared<planning::Workcell>(planning::loadBuiltInWorkcell().value());
    planning::WorldObject crate;
    crate.name = "crate";
    crate.shape = planning::Box{{0.4, 0.3, 0.25}};
    crate.X_WO = poseFromRpy({1.4, 0.1, 0.3}, {0, 0, 0.4});
    crate.rgba = {0.75, 0.6, 0.4, 1};
    workcell->objects.push_back(crate);
    bench->setWorkcell(workcell);
    vision::Snapshot snapshot;
    snapshot.id = bench->document().nextSnapshotId();
    JointState state;
    state.names = {"arm_2_joint", "arm_3_joint"};
    state.positions = Eigen::Vector2d(-0.15, 2.15);
    state.velocities = Eigen::Vector2d::Zero();
    snapshot.view = session::cameraView(*workcell, "head_left", state).value();
    snapshot.image = cv::Mat(480, 640, CV_8UC3, cv::Scalar(90, 90, 90));
    snapshot.robot_state = state;
    snapshot.source = "live";
    snapshot.wall_time_s = 1e9;
    bench->document().insertSnapshot(0, std::make_shared<const vision::Snapshot>(snapshot));
    window->tasks()->setTask(Task::kCalibrate);
    SimulatedHand::pump(50);
  }
  void chooseInLibrary(const QString& name) {
    auto* library = window->calibrate()->library();
    for (int row = 0; row < library->cameras()->rowCount(); ++row) {
      auto* item = library->cameras()->item(row, 0);
      if (item->text() == name) hand.click(library->cameras()->viewport(), library->cameras()->visualItemRect(item).center());
    }
    SimulatedHand::pump(50);
  }
  bool settled() {
    const auto& wizard = bench->calibration().intrinsics();
    return SimulatedHand::waitFor([&] { return !wizard.searching() && !wizard.solving(); }, 90);
  }
};

TEST_F(CalibrateWindow, ATabAndItsKeyShowTheTaskAndSilenceTheKeysOfTheOther) {
  openWindow();
  QApplication::setActiveWindow(window.get());
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return QApplication::activeWindow() == window.get(); }, 10));
  const auto enabled = [this](const QString& menu) {
    for (const auto* action : window->menuBar()->actions()) {
      if (action->text().remove(QLatin1Char('&')) == menu) return action->isEnabled();
    }
    return false;
  };
  QTest::keyClick(window.get(), Qt::Key_F7);
  EXPECT_EQ(window->tasks()->task(), Task::kCalibrate);
  EXPECT_TRUE(window->calibrate()->isVisible());
  EXPECT_FALSE(window->pictures()->isVisible());
  EXPECT_TRUE(window->stopPanel()->isVisible()) << "STOP is never hidden";
  EXPECT_FALSE(enabled(QStringLiteral("Edit"))) << "Del must not delete a feature that is not seen";
  EXPECT_FALSE(enabled(QStringLiteral("Sketch")));
  EXPECT_TRUE(enabled(QStringLiteral("Robot")));
  QTest::keyClick(window.get(), Qt::Key_F5);
  EXPECT_TRUE(window->pictures()->isVisible());
  EXPECT_TRUE(enabled(QStringLiteral("Edit")));
}

TEST_F(CalibrateWindow, RealPicturesOfABoardGiveALensThatTheCameraThenUses) {
  LONGARM_SKIP_WITHOUT_DATA();
  openCalibrate();
  auto* panel = window->calibrate()->intrinsics();
  look(QStringLiteral("calibrate-empty-1280"));
  calibration::BoardSpec board;
  board.square = 0.03;
  panel->setBoard(board);
  bench->calibration().intrinsics().addFiles(leftPictures());
  ASSERT_TRUE(settled());
  ASSERT_EQ(panel->views()->rowCount(), 13);
  look(QStringLiteral("calibrate-board-1280"));
  panel->steps()->setCurrentIndex(1);
  panel->views()->selectRow(1);
  look(QStringLiteral("calibrate-views-1280"));
  panel->steps()->setCurrentIndex(2);
  panel->show(CalibrateIntrinsicsPanel::Show::kUncertainty);
  look(QStringLiteral("calibrate-result-1280"));
  panel->show(CalibrateIntrinsicsPanel::Show::kCoverage);
  window->resize(1920, 1080);
  look(QStringLiteral("calibrate-coverage-1920"));
  panel->show(CalibrateIntrinsicsPanel::Show::kPicture);
  ASSERT_GE(panel->parameters()->rowCount(), 6);
  EXPECT_TRUE(panel->parameters()->item(0, 3)->text().startsWith(QStringLiteral("fy"))) << "focal lengths grow together: " << panel->parameters()->item(0, 3)->text().toStdString();
  panel->target()->setCurrentIndex(panel->target()->findData(QStringLiteral("drive")));
  ASSERT_TRUE(panel->applyButton()->isEnabled()) << panel->applyButton()->toolTip().toStdString();
  const double before = bench->calibration().fileInUse("drive")->camera.cx;
  hand.click(panel->applyButton());
  EXPECT_EQ(bench->calibration().fileInUse("drive")->camera.cx, before) << "a click alone changes nothing";
  EXPECT_TRUE(hand.hold(panel->applyButton(), [this] { return bench->calibration().recordInUse("drive").has_value(); }, 10));
  EXPECT_NEAR(bench->calibration().fileInUse("drive")->camera.cx, 341.6, 4);
  EXPECT_NE(panel->applyButton()->toolTip(), QString());
}

TEST_F(CalibrateWindow, APictureTakenOutOfTheListNoLongerCounts) {
  LONGARM_SKIP_WITHOUT_DATA();
  openCalibrate();
  auto* panel = window->calibrate()->intrinsics();
  bench->calibration().intrinsics().addFiles(leftPictures());
  ASSERT_TRUE(settled());
  const auto used = [this] { return bench->calibration().intrinsics().outcome()->views.size(); };
  ASSERT_EQ(used(), 13U);
  panel->steps()->setCurrentIndex(1);
  panel->views()->item(2, 0)->setCheckState(Qt::Unchecked);
  ASSERT_TRUE(settled());
  EXPECT_EQ(used(), 12U);
  EXPECT_TRUE(panel->views()->item(2, 3)->text().contains(QStringLiteral("left out by you"))) << panel->views()->item(2, 3)->text().toStdString();
}

TEST_F(CalibrateWindow, ALibraryComparesGoesBackSolvesAgainAndExports) {
  LONGARM_SKIP_WITHOUT_DATA();
  openCalibrate();
  auto* panel = window->calibrate()->intrinsics();
  calibration::BoardSpec board;
  board.square = 0.03;
  panel->setBoard(board);
  bench->calibration().intrinsics().addFiles(leftPictures());
  ASSERT_TRUE(settled());
  panel->steps()->setCurrentIndex(2);
  panel->target()->setCurrentIndex(panel->target()->findData(QStringLiteral("drive")));
  const double own = bench->calibration().fileInUse("drive")->camera.cx;
  ASSERT_TRUE(hand.hold(panel->applyButton(), [this] { return bench->calibration().recordInUse("drive").has_value(); }, 10));
  auto* library = window->calibrate()->library();
  window->calibrate()->showTool(library);
  SimulatedHand::pump(50);
  chooseInLibrary(QStringLiteral("drive"));
  ASSERT_EQ(library->records()->rowCount(), 2) << "the new one and the workcell's own file";
  EXPECT_FALSE(library->useButton()->isEnabled()) << "it is in use";
  // Compare with the workcell's own file, then go back to it.
  hand.click(library->records()->viewport(), library->records()->visualItemRect(library->records()->item(1, 0)).center());
  EXPECT_TRUE(library->difference().contains(QStringLiteral("px rms"))) << library->difference().toStdString();
  EXPECT_TRUE(library->difference().contains(QStringLiteral("mm at"))) << library->difference().toStdString();
  EXPECT_FALSE(library->againButton()->isEnabled()) << "a file without raw data";
  look(QStringLiteral("library-compare-1280"));
  ASSERT_TRUE(library->useButton()->isEnabled()) << library->useButton()->toolTip().toStdString();
  ASSERT_TRUE(hand.hold(library->useButton(), [this] { return !bench->calibration().recordInUse("drive").has_value(); }, 10));
  EXPECT_DOUBLE_EQ(bench->calibration().fileInUse("drive")->camera.cx, own);
  // Solve again: kept beside the first, not in use.
  chooseInLibrary(QStringLiteral("drive"));
  hand.click(library->records()->viewport(), library->records()->visualItemRect(library->records()->item(0, 0)).center());
  ASSERT_TRUE(library->againButton()->isEnabled()) << library->againButton()->toolTip().toStdString();
  hand.click(library->againButton());
  ASSERT_TRUE(SimulatedHand::waitFor([library] { return library->records()->rowCount() == 3; }, 60)) << window->strip()->message().toStdString();
  const auto records = bench->calibration().library().records(bench->document().workcell()->name, "drive");
  ASSERT_EQ(records.size(), 2U);
  const auto again = vision::readCameraFile(records[0].file), first = vision::readCameraFile(records[1].file);
  ASSERT_TRUE(again.ok() && first.ok());
  EXPECT_NEAR(again->camera.fx, first->camera.fx, 1e-6) << "the same raw data give the same camera";
  EXPECT_FALSE(bench->calibration().recordInUse("drive").has_value());
  // Export.
  hand.click(library->exportButton());
  QFileDialog* dialog = nullptr;
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return (dialog = library->findChild<QFileDialog*>()) != nullptr && dialog->isVisible(); }, 10));
  const QString file = folder.filePath(QStringLiteral("exported.yaml"));
  Q_EMIT dialog->fileSelected(file);
  EXPECT_TRUE(vision::readCameraFile(file.toStdString()).ok()) << window->strip()->message().toStdString();
  dialog->close();
}

TEST_F(CalibrateWindow, RealPairsAreSolvedLookedAtAndUsed) {
  LONGARM_SKIP_WITHOUT_DATA();
  openCalibrate();
  auto* panel = window->calibrate()->stereo();
  window->calibrate()->showTool(panel);
  SimulatedHand::pump(100);
  look(QStringLiteral("stereo-empty-1280"));
  EXPECT_EQ(panel->camera(0)->currentData().toString(), QStringLiteral("head_left"));
  EXPECT_EQ(panel->camera(1)->currentData().toString(), QStringLiteral("head_right"));
  calibration::BoardSpec board;
  board.square = 0.03;
  panel->boardForm()->setBoard(board);
  panel->refine()->setChecked(true);
  auto& wizard = bench->stereo();
  wizard.addFiles(pictures("left*.jpg") + pictures("right*.jpg"));
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return !wizard.searching() && !wizard.solving(); }, 90));
  ASSERT_EQ(panel->table()->rowCount(), 13);
  EXPECT_TRUE(panel->answer().contains(QStringLiteral("Baseline"))) << panel->answer().toStdString();
  hand.click(panel->table()->viewport(), panel->table()->visualItemRect(panel->table()->item(4, 1)).center());
  look(QStringLiteral("stereo-result-1280"));
  window->resize(1920, 1080);
  look(QStringLiteral("stereo-result-1920"));
  ASSERT_TRUE(panel->applyButton()->isEnabled()) << panel->applyButton()->toolTip().toStdString();
  ASSERT_TRUE(hand.hold(panel->applyButton(), [this] { return bench->calibration().recordInUse("head_right").has_value(); }, 10));
  EXPECT_TRUE(bench->calibration().recordInUse("head_left").has_value()) << "both lenses were refined";
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return !wizard.solving(); }, 60));
}

TEST_F(CalibrateWindow, PointsStickToWhatIsClickedInTheSceneAndAnObjectStaysWhereItWasFound) {
  openWithCrate({1920, 1080});
  auto* panel = window->calibrate()->pose();
  window->calibrate()->showTool(panel);
  panel->camera()->setCurrentIndex(panel->camera()->findData(QStringLiteral("head_left")));
  panel->unknown()->setCurrentIndex(2);
  ASSERT_TRUE(SimulatedHand::waitFor([panel] { return panel->scene() != nullptr && panel->scene()->isVisible(); }, 10));
  look(QStringLiteral("pose-scene-empty-1920"));
  auto& pose = bench->pose();
  const std::size_t listed = pose.landmarks().size();
  const Pose X_WO = bench->document().workcell()->objects.front().X_WO;
  auto* surface = panel->scene()->findChild<QWidget*>();
  ASSERT_NE(surface, nullptr);
  const auto snapshot = pose.snapshot();
  ASSERT_TRUE(snapshot != nullptr);
  const Pose truth = poseFromRpy({1.36, 0.07, 0.31}, {0, 0, 0.52});
  int stuck = 0;
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(-0.1, -0.08, 0.125), {0.1, -0.1, 0.125}, {-0.1, 0.1, 0.125}, {0.12, 0.1, 0.125}, {0.03, 0.02, 0.125}, {-0.2, 0.05, 0.02}, {-0.2, -0.08, -0.04}}) {
    const auto at = panel->scene()->widgetOfPoint(X_WO * p);
    if (!at) continue;
    const std::size_t before = pose.landmarks().size();
    hand.click(surface, *at);
    if (pose.landmarks().size() == before) continue;   // another side of the crate faces the eye
    ++stuck;
    const auto& mark = pose.landmarks().back();
    EXPECT_EQ(mark.thing, "crate");
    const auto pixel = snapshot->view.project(truth * mark.xyz);
    if (pixel && snapshot->view.camera.containsPixel(*pixel)) hand.click(panel->canvas(), *panel->canvas()->widgetOfPixel(*pixel));
  }
  EXPECT_GE(stuck, 4);
  EXPECT_GT(pose.landmarks().size(), listed);
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return !pose.solving(); }, 60));
  ASSERT_TRUE(pose.outcome().has_value()) << pose.why().toStdString();
  look(QStringLiteral("pose-scene-solved-1920"));
  window->resize(1280, 800);
  look(QStringLiteral("pose-scene-solved-1280"));
  const Pose found = pose.solvedObjectPose();
  EXPECT_LT((found.translation() - truth.translation()).norm(), 0.02);
  ASSERT_TRUE(panel->applyButton()->isEnabled()) << panel->applyButton()->toolTip().toStdString();
  ASSERT_TRUE(hand.hold(panel->applyButton(), [this] { return bench->calibration().recordInUse(session::Subject::kObject, "crate").has_value(); }, 10));
  EXPECT_TRUE(bench->document().workcell()->objects.front().X_WO.isApprox(found, 1e-9));
  auto* library = window->calibrate()->library();
  window->calibrate()->showTool(library);
  SimulatedHand::pump(50);
  chooseInLibrary(QStringLiteral("object crate"));
  ASSERT_EQ(library->records()->rowCount(), 2);
  hand.click(library->records()->viewport(), library->records()->visualItemRect(library->records()->item(1, 0)).center());
  EXPECT_TRUE(library->difference().contains(QStringLiteral("from the one in use"))) << library->difference().toStdString();
  look(QStringLiteral("library-object-1280"));
  ASSERT_TRUE(hand.hold(library->useButton(), [this] { return !bench->calibration().recordInUse(session::Subject::kObject, "crate").has_value(); }, 10));
  EXPECT_TRUE(bench->document().workcell()->objects.front().X_WO.isApprox(X_WO, 1e-9));
}

TEST_F(CalibrateWindow, EveryPageSaysWhatToDoAndWhyAButtonIsGrey) {
  openCalibrate();
  auto* page = window->calibrate();
  const std::pair<QWidget*, const char*> pages[] = {{page->intrinsics(), "lens"}, {page->stereo(), "stereo"}, {page->lens(), "hand"}, {page->fixture(), "fixture"},
                                                    {page->pose(), "pose"}, {page->zoom(), "zoom"}, {page->library(), "library"}};
  for (const auto& [panel, name] : pages) {
    page->showTool(panel);
    SimulatedHand::pump(100);
    EXPECT_TRUE(panel->isVisible()) << name;
    EXPECT_LE(panel->width(), window->width()) << name;
    EXPECT_LE(panel->height(), panel->parentWidget()->height()) << name << " must be scrolled, though the window is as large as promised";
    for (const auto* button : panel->findChildren<QPushButton*>()) {
      if (!button->isVisible() || button->isEnabled()) continue;
      EXPECT_TRUE(button->toolTip().contains(QStringLiteral("Not now"))) << name << ": " << button->text().toStdString();
    }
    look(QStringLiteral("page-%1-1280").arg(QString::fromLatin1(name)));
  }
}

TEST_F(CalibrateWindow, GuidesAreLaidByClicksAndStraightenThePicture) {
  LONGARM_SKIP_WITHOUT_DATA();
  openCalibrate();
  auto* panel = window->calibrate()->lens();
  window->calibrate()->showTool(panel);
  auto& lens = bench->lens();
  lens.openFile(QString::fromStdString(tests::dataFolder()) + QStringLiteral("/opencv_stereo_chess/left01.jpg"));
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return !lens.picture().empty(); }, 30));
  panel->straightened()->setChecked(false);
  lens.straightenNothing();
  // Rows of the board: straight in the world.
  const auto board = calibration::detectBoard(lens.picture(), {}, "left01").value();
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 9; column += 2) {
      hand.click(panel->canvas(), *panel->canvas()->widgetOfPixel(board.corners[static_cast<std::size_t>(9 * row + column)].pixel));
    }
    lens.endGuide();
  }
  ASSERT_EQ(lens.guides().size(), 6U);
  ASSERT_EQ(lens.guides()[0].size(), 5U);
  const double bent = *lens.straightness();
  look(QStringLiteral("lens-guides-1280"));
  for (auto* box : panel->findChildren<QComboBox*>()) {
    if (const int k1 = box->findText(QStringLiteral("k1"), Qt::MatchExactly); k1 >= 0) box->setCurrentIndex(k1);
  }
  hand.click(panel->solveButton());
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return lens.result().has_value() && !lens.solving(); }, 30));
  EXPECT_LT(*lens.straightness(), 0.6 * bent);
  EXPECT_LT(lens.lens().distortion[0], -0.15) << "the lens of these pictures is a barrel: k1 is -0.29";
  panel->straightened()->setChecked(true);
  window->resize(1920, 1080);
  look(QStringLiteral("lens-straightened-1920"));
  panel->slider(0)->setValue(0);
  EXPECT_NEAR(lens.lens().distortion[0], 0, 1e-9);
}

}  // namespace
}  // namespace longarm
