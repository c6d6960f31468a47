// The intrinsics wizard without its window.
#include <QDir>
#include <QFileInfo>
#include <QStringList>

#include "session/calibration/intrinsics_controller.h"
#include "tests/calibration/synthetic.h"
#include "tests/session/event_loop.h"
#include "tests/support/test_data.h"
#include "vision/snapshot/image_file.h"

namespace longarm::session {
namespace {

using calibration::BoardView;
using tests::Random;
using Verdict = AutoCapture::Verdict;

BoardView boardAt(double u, double v, double size = 20) {
  BoardView view{"board", {}};
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 9; ++c) view.corners.push_back({{0.03 * c, 0.03 * r, 0}, {u + size * c, v + size * r}, 0});
  }
  return view;
}

TEST(AutoCapture, KeepsABoardOnceItRestsAndIsSharpAndIsSomewhereNew) {
  AutoCapture capture;
  EXPECT_EQ(capture.offer(boardAt(100, 100), 1, 640, 0.0), Verdict::kMoving) << "nothing to compare with yet";
  EXPECT_EQ(capture.offer(boardAt(100.3, 100), 1, 640, 0.2), Verdict::kMoving) << "not for long enough";
  EXPECT_EQ(capture.offer(boardAt(100.1, 100), 1, 640, 0.5), Verdict::kKeep);
  capture.kept(boardAt(100.1, 100));
  EXPECT_EQ(capture.offer(boardAt(100.2, 100), 1, 640, 0.7), Verdict::kKnownPlace);
  EXPECT_EQ(capture.offer(boardAt(200, 150), 1, 640, 0.9), Verdict::kMoving);
  EXPECT_EQ(capture.offer(boardAt(204, 150), 1, 640, 1.4), Verdict::kMoving) << "still on its way";
  EXPECT_EQ(capture.offer(boardAt(204, 150), 0.3, 640, 2.0), Verdict::kBlurred);
  EXPECT_EQ(capture.offer(boardAt(204, 150), 0.9, 640, 2.2), Verdict::kKeep);
  EXPECT_EQ(capture.offerNothing(), Verdict::kNoBoard);
  EXPECT_EQ(capture.offer(boardAt(204, 150), 0.9, 640, 2.4), Verdict::kMoving) << "it was gone between";
}

TEST(AutoCapture, AChessboardNumberedFromItsOtherEndIsTheSame) {
  AutoCapture capture;
  capture.kept(boardAt(100, 100));
  BoardView turned = boardAt(100, 100);
  for (std::size_t i = 0; i < turned.corners.size(); ++i) turned.corners[i].pixel = boardAt(100, 100).corners[turned.corners.size() - 1 - i].pixel;
  EXPECT_EQ(capture.offer(turned, 1, 640, 0), Verdict::kKnownPlace);
}

TEST(BoardCollection, RefusesAPictureOfAnotherSizeAndSaysWhatIsMissing) {
  BoardCollection boards;
  EXPECT_NE(boards.whyNotReady().find("no pictures"), std::string::npos);
  ASSERT_TRUE(boards.add({"a", cv::Mat(480, 640, CV_8U), boardAt(100, 100), "", true}).ok());
  const Status other = boards.add({"b", cv::Mat(240, 320, CV_8U), boardAt(10, 10), "", true});
  ASSERT_FALSE(other.ok());
  EXPECT_NE(other.error().message.find("320 x 240"), std::string::npos) << other.error().message;
  EXPECT_NE(boards.whyNotReady().find("at least 3"), std::string::npos) << boards.whyNotReady();
}

TEST(BoardCollection, OnlyPicturesOfTheNewestZoomBelongToOneLens) {
  BoardCollection boards;
  const auto add = [&](std::optional<double> zoom) {
    ASSERT_TRUE(boards.add({"board", cv::Mat(480, 640, CV_8U), boardAt(100, 100), "", true, zoom}).ok());
  };
  for (int i = 0; i < 3; ++i) add(0.2);
  EXPECT_EQ(boards.usable().size(), 3U);
  add(0.4);
  EXPECT_EQ(boards.usable(), std::vector<std::size_t>{3}) << "the lens was turned";
  EXPECT_EQ(boards.zoom(), 0.4);
  add(0.401);
  EXPECT_EQ(boards.usable().size(), 2U) << "the drive trembles";
  boards.setIncluded(3, false);
  boards.setIncluded(4, false);
  EXPECT_EQ(boards.usable().size(), 3U) << "back to the setting before";
  add(std::nullopt);
  EXPECT_EQ(boards.usable(), std::vector<std::size_t>{5}) << "a lens that does not zoom is another one";
}

class Intrinsics : public longarm::testing::EventLoopTest {
 protected:
  void settle(const IntrinsicsController& wizard) {
    ASSERT_TRUE(waitFor([&] { return !wizard.searching() && !wizard.solving(); }));
  }
  JobRunner jobs{1};
};

TEST_F(Intrinsics, RealPicturesGiveTheCameraAndABadOneIsLeftOut) {
  LONGARM_SKIP_WITHOUT_DATA();
  IntrinsicsController wizard(jobs);
  calibration::BoardSpec board;
  board.square = 0.03;
  wizard.setBoard(board);
  const QDir folder(QString::fromStdString(tests::dataFolder()) + "/opencv_stereo_chess");
  QStringList files;
  for (const QString& name : folder.entryList({"left*.jpg"}, QDir::Files, QDir::Name)) files << folder.filePath(name);
  ASSERT_EQ(files.size(), 13);
  wizard.addFiles(files);
  settle(wizard);
  ASSERT_TRUE(wizard.outcome().has_value()) << wizard.why().toStdString();
  const auto& camera = wizard.outcome()->result.camera;
  EXPECT_NEAR(camera.fx, 533.5, 3);
  EXPECT_NEAR(camera.cx, 341.6, 4);
  EXPECT_EQ(wizard.boards().pictures().size(), 13U);
  EXPECT_EQ(QFileInfo(QString::fromStdString(wizard.boards().pictures()[0].name)).fileName(), "left01.jpg") << "in the order given";
  EXPECT_GT(wizard.outcome()->coverage.picture, 0.7);
  EXPECT_LT(wizard.outcome()->uncertainty.mean_px, 0.5);
  EXPECT_LT(wizard.outcome()->uncertainty.max_px, 3) << "in the corners, where no board was";

  for (std::size_t i = 0; i < 11; ++i) wizard.setIncluded(i, false);
  settle(wizard);
  EXPECT_FALSE(wizard.outcome().has_value()) << "two pictures are not enough";
  EXPECT_NE(wizard.why().indexOf("at least 3"), -1) << wizard.why().toStdString();
  for (std::size_t i = 0; i < 11; ++i) wizard.setIncluded(i, true);
  settle(wizard);
  ASSERT_TRUE(wizard.outcome().has_value());
  EXPECT_NEAR(wizard.outcome()->result.camera.fx, camera.fx, 1e-6);

  board.columns = 10;
  board.rows = 7;
  wizard.setBoard(board);
  settle(wizard);
  EXPECT_EQ(wizard.boards().usable().size(), 0U) << "another board: all are searched again";
  EXPECT_NE(wizard.boards().pictures()[0].why.find("9x6 board was found"), std::string::npos) << wizard.boards().pictures()[0].why;
}

TEST_F(Intrinsics, ABoardHeldStillBeforeALiveCameraIsKept) {
  LONGARM_SKIP_WITHOUT_DATA();
  IntrinsicsController wizard(jobs);
  const cv::Mat picture = vision::loadImage(tests::dataFolder() + "/opencv_stereo_chess/left01.jpg").value();
  int shown = 0;
  QObject::connect(&wizard, &IntrinsicsController::liveChanged, [&shown] { ++shown; });
  for (int i = 0; i < 4; ++i) {
    wizard.offerLive(picture, 0.3 * i);
    ASSERT_TRUE(waitFor([&] { return shown == i + 1; }));
  }
  ASSERT_EQ(wizard.boards().pictures().size(), 1U) << "once, not with every picture";
  EXPECT_EQ(wizard.live()->verdict, Verdict::kKnownPlace);
  wizard.setAutoCapture(false);
  wizard.capture();
  EXPECT_EQ(wizard.boards().pictures().size(), 2U) << "by hand all the same";
  wizard.leaveLive();
  EXPECT_FALSE(wizard.whyNotCapture().isEmpty());
}

TEST_F(Intrinsics, APlaceOfTheBoardIsNewThroughAnotherZoom) {
  LONGARM_SKIP_WITHOUT_DATA();
  IntrinsicsController wizard(jobs);
  const cv::Mat picture = vision::loadImage(tests::dataFolder() + "/opencv_stereo_chess/left01.jpg").value();
  int shown = 0;
  QObject::connect(&wizard, &IntrinsicsController::liveChanged, [&shown] { ++shown; });
  const auto show = [&](int first, double zoom) {
    for (int i = first; i < first + 4; ++i) {
      wizard.offerLive(picture, 0.3 * i, zoom);
      ASSERT_TRUE(waitFor([&] { return shown == i + 1; }));
    }
  };
  show(0, 0.0);
  ASSERT_EQ(wizard.boards().pictures().size(), 1U);
  wizard.leaveLive();                              // meanwhile another page is looked at
  ASSERT_TRUE(waitFor([&] { return shown == 5; }));
  shown = 4;
  show(4, 0.5);
  ASSERT_EQ(wizard.boards().pictures().size(), 2U) << "the same place, seen through another lens";
  EXPECT_EQ(wizard.boards().pictures()[0].zoom, 0.0);
  EXPECT_EQ(wizard.boards().pictures()[1].zoom, 0.5);
  show(8, 0.0);
  EXPECT_EQ(wizard.boards().pictures().size(), 2U) << "back at a setting where it was seen";
}

TEST_F(Intrinsics, AFileThatIsNoPictureIsToldAndTheOthersGoOn) {
  LONGARM_SKIP_WITHOUT_DATA();
  IntrinsicsController wizard(jobs);
  QStringList told;
  QObject::connect(&wizard, &IntrinsicsController::failed, [&told](const QString& sentence) { told << sentence; });
  const QString folder = QString::fromStdString(tests::dataFolder()) + "/opencv_stereo_chess/";
  wizard.addFiles({folder + "SOURCE.txt", folder + "left01.jpg"});
  settle(wizard);
  ASSERT_EQ(told.size(), 1);
  EXPECT_NE(told[0].indexOf("SOURCE.txt"), -1) << told[0].toStdString();
  EXPECT_EQ(wizard.boards().usable().size(), 1U);
}

}  // namespace
}  // namespace longarm::session
