// The whole window without a robot: pictures from files, sketched on with a simulated mouse.
#include <QAbstractButton>
#include <QDockWidget>
#include <QFile>
#include <QTableView>
#include <QTest>

#include "tests/support/test_data.h"
#include "tests/ui/window_fixture.h"

namespace longarm {
namespace {

using session::ToolKind;
using ui::ActionId;
using ui::SimulatedHand;
using vision::PaneSide;

// Bouguet's published calibration of the pair that Debian's opencv-doc ships.
const char* const kCameras[] = {
    "image_width: 640\nimage_height: 480\ncamera_name: left\ncamera_matrix: {rows: 3, cols: 3, data: [533.52331, 0, 341.60376, 0, "
    "533.52699, 235.19287, 0, 0, 1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [-0.28838, 0.09714, "
    "0.00109, -0.0003, 0]}\npose: {parent: base_link, xyz: [0, 0, 0], quaternion_xyzw: [0, 0, 0, 1]}\n",
    "image_width: 640\nimage_height: 480\ncamera_name: right\ncamera_matrix: {rows: 3, cols: 3, data: [536.81377, 0, 326.28657, 0, "
    "536.47649, 250.10121, 0, 0, 1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [-0.28943, 0.1069, "
    "-0.00059, 0.00014, 0]}\npose: {parent: base_link, xyz: [0.09980449612, -0.00077392343, 0.00040705358], quaternion_xyzw: "
    "[-0.0033449892, -0.0022599927, 0.0017499944, 0.9999903205]}\n"};

class WindowWithPictures : public tests::WindowFixture {
 protected:
  void openPair() {
    session::PictureFiles files[2];
    for (int i = 0; i < 2; ++i) {
      const QString camera = folder.filePath(QStringLiteral("camera%1.yaml").arg(i));
      QFile file(camera);
      ASSERT_TRUE(file.open(QIODevice::WriteOnly));
      file.write(kCameras[i]);
      files[i].camera = camera.toStdString();
      files[i].image = tests::dataFolder() + (i == 0 ? "/opencv_stereo_chess/left01.jpg" : "/opencv_stereo_chess/right01.jpg");
    }
    window->files()->openPictures(files[0], files[1]);
    ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->document().paneSnapshot(PaneSide::kRight) != nullptr; }, 10))
        << window->strip()->message().toStdString();
  }
  QPointF place(PaneSide side, double u, double v) { return *window->pictures()->pane(side)->canvas()->widgetOfPixel({u, v}); }
  void stroke(PaneSide side, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    hand.drag(window->pictures()->pane(side)->canvas(), place(side, a.x(), a.y()), place(side, b.x(), b.y()));
  }
};

TEST_F(WindowWithPictures, MeasuresAChessboardEdgeWithTwoStrokes) {
  LONGARM_SKIP_WITHOUT_DATA();
  openWindow();
  look(QStringLiteral("empty-1280-dark"));
  openPair();
  look(QStringLiteral("pair-1280-dark"));
  window->actions().at(ActionId::kToolLine)->trigger();
  look(QStringLiteral("line-1280-dark"));
  stroke(PaneSide::kLeft, {244.7, 94.2}, {475.3, 106.5});
  stroke(PaneSide::kRight, {131.0, 100.0}, {360.0, 112.0});
  look(QStringLiteral("measured-1280-dark"));
  ASSERT_EQ(bench->document().items().size(), 1U);
  EXPECT_EQ(window->features()->view()->model()->rowCount(), 1);
  for (auto* dock : window->findChildren<QDockWidget*>()) {
    dock->raise();
    SimulatedHand::pump(30);
    const QSize least = window->minimumSizeHint();
    EXPECT_LE(least.width(), 1280) << "STOP would be off the screen beside " << dock->windowTitle().toStdString();
    EXPECT_LE(least.height(), 800) << dock->windowTitle().toStdString();
  }
  window->findChild<QDockWidget*>(QStringLiteral("features"))->raise();
  EXPECT_EQ(window->size(), QSize(1280, 800));
  window->resize(1920, 1080);
  look(QStringLiteral("measured-1920-dark"));
  appearance->setTheme(QStringLiteral("light"));
  look(QStringLiteral("measured-1920-light"));
  window->resize(1280, 800);
  look(QStringLiteral("measured-1280-light"));
}

}  // namespace
}  // namespace longarm
