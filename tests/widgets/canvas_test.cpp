// ImageCanvas: where pixels are at every zoom, what the mouse says, what is painted.
#include <cmath>
#include <vector>

#include <QApplication>
#include <QImage>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>
#include <gtest/gtest.h>

#include "tests/widgets/barrel_camera.h"
#include "widgets/canvas_view.h"
#include "widgets/image_canvas.h"
#include "widgets/loupe.h"
#include "widgets/overlay_painter.h"

namespace longarm::widgets {
namespace {

using vision::PointerEvent;
using vision::PointerPhase;

constexpr double kPixelTol = 1e-9;             // pure arithmetic
constexpr double kLensTol = 1e-6;              // the lens is inverted by iteration

cv::Mat grey(int width, int height, int value = 128) { return {height, width, CV_8UC3, cv::Scalar(value, value, value)}; }

struct Pane {
  ImageCanvas canvas{vision::PaneSide::kRight};
  std::vector<PointerEvent> events;
  std::vector<vision::SketchKey> keys;

  explicit Pane(const cv::Mat& picture, QSize size = {400, 300}) {
    canvas.resize(size);
    canvas.show();
    QApplication::processEvents();
    canvas.setPicture(picture);
    QObject::connect(&canvas, &ImageCanvas::pointer, &canvas, [this](const PointerEvent& e) { events.push_back(e); });
    QObject::connect(&canvas, &ImageCanvas::sketchKey, &canvas, [this](vision::SketchKey key) { keys.push_back(key); });
  }
  void mouse(QEvent::Type type, QPointF at, Qt::MouseButton button, Qt::MouseButtons buttons,
             Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
    QMouseEvent event(type, at, canvas.mapToGlobal(at.toPoint()), button, buttons, modifiers);
    QApplication::sendEvent(&canvas, &event);
  }
  void press(QPointF at) { mouse(QEvent::MouseButtonPress, at, Qt::LeftButton, Qt::LeftButton); }
  void drag(QPointF at) { mouse(QEvent::MouseMove, at, Qt::NoButton, Qt::LeftButton); }
  void release(QPointF at) { mouse(QEvent::MouseButtonRelease, at, Qt::LeftButton, Qt::NoButton); }
  void key(int code, QEvent::Type type = QEvent::KeyPress, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
    QKeyEvent event(type, code, modifiers);
    QApplication::sendEvent(&canvas, &event);
  }
  void setScale(double scale) { canvas.zoomAbout(QRectF(canvas.rect()).center(), scale / canvas.scale()); }
  QImage shot() { return canvas.grab().toImage().convertToFormat(QImage::Format_RGB32); }
};

TEST(CanvasView, PutsTheCentreOfTheFirstPixelHalfAPixelFromTheCorner) {
  CanvasView view;
  EXPECT_EQ(view.toWidget({0, 0}), QPointF(0.5, 0.5));
  view.setScaleAbout({0, 0}, 4);
  EXPECT_EQ(view.toWidget({0, 0}), QPointF(2, 2));
  EXPECT_EQ(view.toWidget({-0.5, -0.5}), QPointF(0, 0));
}

TEST(CanvasView, KeepsThePointUnderTheCursorWhileZooming) {
  CanvasView view;
  view.fit({640, 480}, {400, 300});
  const QPointF cursor(123.4, 77.7);
  const Eigen::Vector2d before = view.toPicture(cursor);
  for (int i = 0; i < 20; ++i) view.zoomAbout(cursor, 1.2);
  for (int i = 0; i < 7; ++i) view.zoomAbout(cursor, 1 / 1.2);
  EXPECT_NEAR((view.toPicture(cursor) - before).norm(), 0, kPixelTol);
}

TEST(CanvasView, ClampsItsScale) {
  CanvasView view;
  view.setScaleAbout({0, 0}, 1e9);
  EXPECT_EQ(view.scale(), CanvasView::kMaxScale);
  view.setScaleAbout({0, 0}, 0);
  EXPECT_EQ(view.scale(), CanvasView::kMinScale);
}

TEST(ImageCanvas, FitsThePictureUntilItIsZoomed) {
  Pane pane(grey(640, 480));
  EXPECT_DOUBLE_EQ(pane.canvas.scale(), 0.625);
  pane.canvas.resize(800, 600);
  QApplication::processEvents();
  EXPECT_DOUBLE_EQ(pane.canvas.scale(), 1.25);
  pane.setScale(2);
  pane.canvas.resize(400, 300);
  QApplication::processEvents();
  EXPECT_DOUBLE_EQ(pane.canvas.scale(), 2);
}

TEST(ImageCanvas, SaysRawPixelsAt25And100And400Percent) {
  for (const double scale : {0.25, 1.0, 4.0}) {
    Pane pane(grey(640, 480));
    pane.setScale(scale);
    for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(319.5, 239.5), Eigen::Vector2d(300.1, 250.7)}) {
      const QPointF at = *pane.canvas.widgetOfPixel(pixel);
      pane.events.clear();
      pane.mouse(QEvent::MouseMove, at, Qt::NoButton, Qt::NoButton);
      ASSERT_EQ(pane.events.size(), 1u);
      EXPECT_NEAR((pane.events[0].pixel - pixel).norm(), 0, kPixelTol) << "at scale " << scale;
      EXPECT_DOUBLE_EQ(pane.events[0].pixels_per_image_px, scale);
      EXPECT_EQ(pane.events[0].side, vision::PaneSide::kRight);
      EXPECT_EQ(pane.events[0].phase, PointerPhase::kHover);
    }
  }
}

// The screen pixel that holds a widget position.
QPoint screenPixel(const QPointF& at) {
  return {static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y()))};
}

// The painted square must be where the mapping says: one white pixel, its middle and its surroundings.
TEST(ImageCanvas, PaintsEachPixelWhereItsEventsAre) {
  for (const double scale : {1.0, 4.0, 8.0}) {
    cv::Mat picture = grey(64, 48, 0);
    picture.at<cv::Vec3b>(20, 30) = {255, 255, 255};
    Pane pane(picture);
    pane.setScale(scale);
    pane.canvas.zoomTo100();
    pane.setScale(scale);
    const QImage shot = pane.shot();
    const QPointF at = *pane.canvas.widgetOfPixel({30, 20});
    EXPECT_GT(qRed(shot.pixel(screenPixel(at))), 120) << "at scale " << scale;
    const QPointF beside = *pane.canvas.widgetOfPixel({33, 20});
    EXPECT_LT(qRed(shot.pixel(screenPixel(beside))), 40) << "at scale " << scale;
  }
}

TEST(ImageCanvas, PassesPressDragReleaseWithButtonsAndModifiers) {
  Pane pane(grey(640, 480));
  pane.press({100, 100});
  pane.drag({110, 100});
  pane.release({120, 100});
  ASSERT_EQ(pane.events.size(), 3u);
  EXPECT_EQ(pane.events[0].phase, PointerPhase::kPress);
  EXPECT_EQ(pane.events[1].phase, PointerPhase::kDrag);
  EXPECT_EQ(pane.events[2].phase, PointerPhase::kRelease);
  EXPECT_TRUE(pane.events[0].left);
  EXPECT_FALSE(pane.events[0].modifiers.control);
}

TEST(ImageCanvas, TellsAtOnceWhenTheReleasingKeyGoesDownDuringADrag) {
  Pane pane(grey(640, 480));
  pane.press({100, 100});
  pane.drag({110, 100});
  pane.key(Qt::Key_Control, QEvent::KeyPress, Qt::ControlModifier);
  ASSERT_EQ(pane.events.size(), 3u);
  EXPECT_EQ(pane.events[2].phase, PointerPhase::kDrag);
  EXPECT_TRUE(pane.events[2].modifiers.control);
  EXPECT_EQ(pane.events[2].pixel, pane.events[1].pixel);
  pane.key(Qt::Key_Control, QEvent::KeyRelease);
  ASSERT_EQ(pane.events.size(), 4u);
  EXPECT_FALSE(pane.events[3].modifiers.control);
}

TEST(ImageCanvas, PansWithMiddleAndRightDragsAndTellsTheToolNothing) {
  for (const Qt::MouseButton button : {Qt::MiddleButton, Qt::RightButton}) {
    Pane pane(grey(640, 480));
    pane.setScale(2);
    const QPointF before = *pane.canvas.widgetOfPixel({300, 200});
    pane.mouse(QEvent::MouseButtonPress, {100, 100}, button, button);
    pane.mouse(QEvent::MouseMove, {117, 109}, Qt::NoButton, button);
    pane.mouse(QEvent::MouseButtonRelease, {117, 109}, button, Qt::NoButton);
    EXPECT_EQ(*pane.canvas.widgetOfPixel({300, 200}) - before, QPointF(17, 9));
    EXPECT_TRUE(pane.events.empty());
  }
}

TEST(ImageCanvas, AsksForAMenuOnARightClickButNotAfterARightDrag) {
  Pane pane(grey(640, 480));
  int menus = 0;
  QObject::connect(&pane.canvas, &ImageCanvas::menuRequested, &pane.canvas, [&] { ++menus; });
  pane.mouse(QEvent::MouseButtonPress, {100, 100}, Qt::RightButton, Qt::RightButton);
  pane.mouse(QEvent::MouseButtonRelease, {102, 101}, Qt::RightButton, Qt::NoButton);
  EXPECT_EQ(menus, 1);
  pane.mouse(QEvent::MouseButtonPress, {100, 100}, Qt::RightButton, Qt::RightButton);
  pane.mouse(QEvent::MouseMove, {140, 100}, Qt::NoButton, Qt::RightButton);
  pane.mouse(QEvent::MouseButtonRelease, {140, 100}, Qt::RightButton, Qt::NoButton);
  EXPECT_EQ(menus, 1);
}

TEST(ImageCanvas, NeverLosesThePictureByPanning) {
  Pane pane(grey(640, 480));
  pane.mouse(QEvent::MouseButtonPress, {100, 100}, Qt::MiddleButton, Qt::MiddleButton);
  pane.mouse(QEvent::MouseMove, {90000, -70000}, Qt::NoButton, Qt::MiddleButton);
  const QRectF picture(*pane.canvas.widgetOfPixel({-0.5, -0.5}), *pane.canvas.widgetOfPixel({639.5, 479.5}));
  EXPECT_TRUE(picture.intersects(QRectF(pane.canvas.rect())));
}

TEST(ImageCanvas, ZoomsAboutTheCursorWithTheWheel) {
  Pane pane(grey(640, 480));
  const QPointF cursor(130, 90);
  const Eigen::Vector2d before = pane.canvas.pixelOfWidget(cursor);
  QWheelEvent wheel(cursor, pane.canvas.mapToGlobal(cursor.toPoint()), {}, {0, 240}, Qt::NoButton, Qt::NoModifier,
                    Qt::NoScrollPhase, false);
  QApplication::sendEvent(&pane.canvas, &wheel);
  EXPECT_NEAR(pane.canvas.scale(), 0.625 * 1.44, 1e-12);
  EXPECT_NEAR((pane.canvas.pixelOfWidget(cursor) - before).norm(), 0, kPixelTol);
}

TEST(ImageCanvas, FitsOnAMiddleDoubleClick) {
  Pane pane(grey(640, 480));
  pane.setScale(5);
  pane.mouse(QEvent::MouseButtonDblClick, {20, 20}, Qt::MiddleButton, Qt::MiddleButton);
  EXPECT_DOUBLE_EQ(pane.canvas.scale(), 0.625);
}

TEST(ImageCanvas, PassesTheKeysOfSketchToolsAndLeavesTheOthers) {
  Pane pane(grey(640, 480));
  for (const int key : {Qt::Key_Escape, Qt::Key_Delete, Qt::Key_Left, Qt::Key_Tab, Qt::Key_Return}) pane.key(key);
  const std::vector<vision::SketchKey> expected = {vision::SketchKey::kEscape, vision::SketchKey::kDelete,
                                                   vision::SketchKey::kLeft, vision::SketchKey::kTab,
                                                   vision::SketchKey::kReturn};
  EXPECT_EQ(pane.keys, expected);
  QKeyEvent other(QEvent::KeyPress, Qt::Key_Q, Qt::NoModifier);
  other.accept();
  QApplication::sendEvent(&pane.canvas, &other);
  EXPECT_EQ(pane.keys.size(), expected.size());
}

TEST(ImageCanvas, SaysTheSameRawPixelWhetherStraightenedOrNot) {
  Pane pane(grey(640, 480));
  pane.canvas.setCamera(barrel(640, 480));
  pane.canvas.setUndistorted(true);
  ASSERT_TRUE(pane.canvas.undistorted());
  for (const Eigen::Vector2d& raw : {Eigen::Vector2d(40, 30), Eigen::Vector2d(600, 400), Eigen::Vector2d(319.5, 239.5)}) {
    const auto at = pane.canvas.widgetOfPixel(raw);
    ASSERT_TRUE(at);
    pane.events.clear();
    pane.mouse(QEvent::MouseMove, *at, Qt::NoButton, Qt::NoButton);
    ASSERT_EQ(pane.events.size(), 1u);
    EXPECT_NEAR((pane.events[0].pixel - raw).norm(), 0, kLensTol);
  }
  // Barrel distortion: away from the middle the straightened place is further out.
  const QPointF straight = *pane.canvas.widgetOfPixel({40, 30});
  pane.canvas.setUndistorted(false);
  const QPointF raw = *pane.canvas.widgetOfPixel({40, 30});
  EXPECT_LT(straight.x(), raw.x() - 2);
}

TEST(ImageCanvas, ShowsAMarkAtTheSamePlaceInTheStraightenedPicture) {
  cv::Mat picture = grey(640, 480, 0);
  picture(cv::Rect(95, 75, 11, 11)).setTo(cv::Scalar(255, 255, 255));     // centre (100, 80)
  Pane pane(picture, {640, 480});
  pane.canvas.setCamera(barrel(640, 480));
  pane.canvas.setUndistorted(true);
  const QImage shot = pane.shot();
  const QPoint at = pane.canvas.widgetOfPixel({100, 80})->toPoint();
  EXPECT_GT(qRed(shot.pixel(at)), 200);
  EXPECT_LT(qRed(shot.pixel(at + QPoint(12, 0))), 40);
  EXPECT_LT(qRed(shot.pixel(at - QPoint(0, 12))), 40);
}

TEST(ImageCanvas, HasNothingToStraightenWithoutACamera) {
  Pane pane(grey(640, 480));
  pane.canvas.setUndistorted(true);
  EXPECT_FALSE(pane.canvas.undistorted());
}

TEST(ImageCanvas, DoesNotResampleThePictureWhileAHandleIsDragged) {
  Pane pane(grey(1920, 1080), {900, 700});
  pane.shot();
  const int before = pane.canvas.resampleCount();
  pane.press({100, 100});
  for (int i = 0; i < 10; ++i) {
    vision::Overlay overlay;
    overlay.shapes.push_back({vision::OverlayShape::Kind::kMarker, vision::OverlayRole::kActiveHandle, {{300.0 + i, 200}}, {}});
    pane.canvas.setOverlay(overlay);
    pane.drag(QPointF(100 + i, 100));
    pane.shot();
  }
  EXPECT_EQ(pane.canvas.resampleCount(), before);
}

TEST(ImageCanvas, PaintsOverlaysInTheirRolesColour) {
  Pane pane(grey(640, 480, 60), {640, 480});
  vision::Overlay overlay;
  overlay.shapes.push_back({vision::OverlayShape::Kind::kPolyline, vision::OverlayRole::kSelected, {{50, 100}, {600, 100}}, {}});
  overlay.shapes.push_back({vision::OverlayShape::Kind::kPolyline, vision::OverlayRole::kEpipolar, {{50, 200}, {600, 200}}, {}});
  pane.canvas.setOverlay(overlay);
  for (const double scale : {1.0, 4.0}) {
    pane.setScale(scale);
    const QImage shot = pane.shot();
    for (const auto& [v, role] : {std::pair{100, vision::OverlayRole::kSelected}, {200, vision::OverlayRole::kEpipolar}}) {
      const QPointF at = *pane.canvas.widgetOfPixel({320, v});
      if (!QRectF(pane.canvas.rect()).contains(at)) continue;
      const QPoint on = screenPixel(at);
      const QColor wanted = Theme::dark().role(role).color;
      const auto distance = [&](int dy) {
        const QColor seen(shot.pixel(on + QPoint(0, dy)));
        return std::max(std::abs(seen.red() - wanted.red()), std::abs(seen.blue() - wanted.blue()));
      };
      // A thin line between two rows of the screen colours both by half.
      EXPECT_LE(std::min({distance(-1), distance(0), distance(1)}), scale == 1 ? 60 : 110) << "v " << v << " scale " << scale;
      // Cosmetic: a line is as thin at 400 % as at 100 %.
      EXPECT_NEAR(qRed(shot.pixel(on + QPoint(0, 6))), 60, 12);
    }
  }
}

TEST(ImageCanvas, ShowsTheLoupeWhileDraggingOrWithAltAndReadsATenthOfAPixel) {
  Pane pane(grey(640, 480));
  EXPECT_FALSE(pane.canvas.loupeVisible());
  pane.mouse(QEvent::MouseMove, {50, 50}, Qt::NoButton, Qt::NoButton, Qt::AltModifier);
  EXPECT_TRUE(pane.canvas.loupeVisible());
  pane.mouse(QEvent::MouseMove, {50, 50}, Qt::NoButton, Qt::NoButton);
  EXPECT_FALSE(pane.canvas.loupeVisible());
  pane.press({50, 50});
  EXPECT_TRUE(pane.canvas.loupeVisible());
  pane.release({50, 50});
  EXPECT_FALSE(pane.canvas.loupeVisible());
  EXPECT_EQ(pixelReadOut({123.44, 5.06}), QStringLiteral("u 123.4  v 5.1"));
}

TEST(ImageCanvas, MagnifiesEightTimesInTheLoupe) {
  cv::Mat picture = grey(64, 48, 0);
  picture.at<cv::Vec3b>(24, 32) = {255, 255, 255};
  QImage glass(136, 156, QImage::Format_RGB32);
  glass.fill(Qt::red);
  QPainter painter(&glass);
  const QImage shown = toQImage(picture);
  paintLoupe(painter, {0, 0, 136, 156}, {&shown, {32, 24}, {32, 24}}, {}, Theme::dark(),
             [](const Eigen::Vector2d& raw) { return std::optional<Eigen::Vector2d>(raw); });
  painter.end();
  EXPECT_GT(qRed(glass.pixel(68, 68)), 200);
  EXPECT_GT(qRed(glass.pixel(68 + 3, 68 + 3)), 200);       // the pixel is 8 screen pixels wide ...
  EXPECT_LT(qRed(glass.pixel(68 + 6, 68 + 6)), 60);        // ... and no wider
}

TEST(ImageCanvas, KeepsTheLoupeInsideAndOffThePixel) {
  for (const QPointF at : {QPointF(0, 0), QPointF(399, 0), QPointF(0, 299), QPointF(399, 299), QPointF(200, 150)}) {
    const QRectF glass = loupeRect(at, {400, 300});
    EXPECT_TRUE(QRectF(0, 0, 400, 300).contains(glass));
    EXPECT_FALSE(glass.contains(at));
  }
}

TEST(ImageCanvas, SaysHowOldALivePictureIsAndTakesTheColourOutOfAFrozenOne) {
  cv::Mat red(480, 640, CV_8UC3, cv::Scalar(0, 0, 200));
  Pane pane(red, {640, 480});
  pane.canvas.setAge(0.1);
  EXPECT_EQ(pane.canvas.freshness(), Freshness::kFresh);
  EXPECT_GT(QColor(pane.shot().pixel(320, 400)).saturation(), 100);
  pane.canvas.setAge(0.3);
  EXPECT_EQ(pane.canvas.freshness(), Freshness::kLate);
  pane.canvas.setAge(3.2);
  EXPECT_EQ(pane.canvas.freshness(), Freshness::kFrozen);
  EXPECT_LT(QColor(pane.shot().pixel(320, 400)).saturation(), 20);
  pane.canvas.setAge(0.0);
  EXPECT_GT(QColor(pane.shot().pixel(320, 400)).saturation(), 100);
}

TEST(ImageCanvas, StandsPicturesOfEveryKindAndNone) {
  Pane pane(cv::Mat(480, 640, CV_8UC1, cv::Scalar(9)));
  pane.canvas.setPicture(cv::Mat(480, 640, CV_8UC4, cv::Scalar(1, 2, 3, 255)));
  pane.shot();
  pane.canvas.setPicture(cv::Mat(1, 1, CV_8UC3, cv::Scalar(1, 2, 3)));
  pane.shot();
  pane.canvas.setPicture(cv::Mat(4, 4, CV_16UC1, cv::Scalar(1)));      // not a kind we show: nothing, no crash
  pane.shot();
  pane.canvas.clearPicture(QStringLiteral("No picture"));
  pane.press({10, 10});
  pane.release({10, 10});
  EXPECT_TRUE(pane.events.empty());
  pane.shot();
}

TEST(ImageCanvas, DrawsNothingForPointsWithoutAPlace) {
  Pane pane(grey(640, 480));
  pane.canvas.setCamera(barrel(640, 480));
  pane.canvas.setUndistorted(true);
  vision::Overlay overlay;
  overlay.shapes.push_back({vision::OverlayShape::Kind::kPolyline, vision::OverlayRole::kPath,
                            {{10, 10}, {1e7, 1e7}, {std::nan(""), 3}, {200, 200}}, {}});
  overlay.shapes.push_back({vision::OverlayShape::Kind::kText, vision::OverlayRole::kLabel, {}, "nowhere"});
  overlay.shapes.push_back({vision::OverlayShape::Kind::kMarker, vision::OverlayRole::kHandle, {{-1e8, 5}}, {}});
  pane.canvas.setOverlay(overlay);
  pane.shot();
}

}  // namespace
}  // namespace longarm::widgets
