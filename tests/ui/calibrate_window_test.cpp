// The task Calibrate in the whole window, with real pictures and a simulated hand.
#include <QComboBox>
#include <QCheckBox>
#include <QDir>
#include <QMenuBar>
#include <QPushButton>
#include <QSlider>
#include <QTabWidget>
#include <QTableWidget>
#include <QTest>

#include "calibration/intrinsics/board_detector.h"
#include "planning/world/workcell.h"
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
  QStringList leftPictures() {
    const QDir data(QString::fromStdString(tests::dataFolder()) + QStringLiteral("/opencv_stereo_chess"));
    QStringList files;
    for (const QString& name : data.entryList({QStringLiteral("left*.jpg")}, QDir::Files, QDir::Name)) files << data.filePath(name);
    return files;
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
  EXPECT_GE(panel->parameters()->rowCount(), 6);
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

TEST_F(CalibrateWindow, EveryPageSaysWhatToDoAndWhyAButtonIsGrey) {
  openCalibrate();
  auto* page = window->calibrate();
  const std::pair<QWidget*, const char*> pages[] = {{page->intrinsics(), "lens"}, {page->lens(), "hand"}, {page->fixture(), "fixture"},
                                                    {page->pose(), "pose"}, {page->zoom(), "zoom"}, {page->library(), "library"}};
  for (const auto& [panel, name] : pages) {
    page->showTool(panel);
    SimulatedHand::pump(100);
    EXPECT_TRUE(panel->isVisible()) << name;
    EXPECT_LE(panel->width(), window->width()) << name;
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
