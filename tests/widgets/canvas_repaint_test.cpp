// ImageCanvas repaints what has changed: never less, and while dragging much less than the whole picture.
#include <cmath>
#include <random>

#include <QApplication>
#include <QImage>
#include <QMouseEvent>
#include <QPaintEvent>
#include <QPainter>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tests/widgets/barrel_camera.h"
#include "widgets/image_canvas.h"

namespace longarm::widgets {
namespace {

using vision::Overlay;
using vision::OverlayRole;
using vision::OverlayShape;

// The screen as it is: of every paint event only the part that was asked for is taken over.
class Screen : public QObject {
 public:
  explicit Screen(ImageCanvas& canvas) : m_canvas(canvas) {
    canvas.installEventFilter(this);
    QApplication::processEvents();
    m_shown = full();
    m_painted = {};
  }
  bool eventFilter(QObject* object, QEvent* event) override {
    if (event->type() == QEvent::Paint && !m_taking) m_painted += static_cast<QPaintEvent*>(event)->region();
    return QObject::eventFilter(object, event);
  }
  // The canvas paints what it has asked for.
  void settle() {
    QApplication::processEvents();
    const QImage now = full();
    QPainter painter(&m_shown);
    painter.setClipRegion(m_painted);
    painter.drawImage(0, 0, now);
  }
  // Pixels on the screen that a repaint of everything would change.
  int stale() {
    const QImage now = full();
    int count = 0;
    for (int y = 0; y < now.height(); ++y) {
      for (int x = 0; x < now.width(); ++x) count += now.pixel(x, y) != m_shown.pixel(x, y) ? 1 : 0;
    }
    return count;
  }
  double paintedShare() const {
    double area = 0;
    for (const QRect& rect : m_painted) area += double(rect.width()) * rect.height();
    return area / (double(m_canvas.width()) * m_canvas.height());
  }
  void forget() { m_painted = {}; }

 private:
  QImage full() {
    m_taking = true;
    QImage image = m_canvas.grab().toImage().convertToFormat(QImage::Format_RGB32);
    m_taking = false;
    return image;
  }
  ImageCanvas& m_canvas;
  QImage m_shown;
  QRegion m_painted;
  bool m_taking = false;
};

cv::Mat noise(int width, int height) {
  cv::Mat picture(height, width, CV_8UC3);
  cv::RNG rng(5);
  rng.fill(picture, cv::RNG::UNIFORM, 0, 256);
  return picture;
}

// Shapes of every kind and role, also outside of the picture.
Overlay randomOverlay(std::mt19937& rng) {
  std::uniform_real_distribution<double> u(-100, 740), v(-100, 580);
  std::uniform_int_distribution<int> role(0, static_cast<int>(OverlayRole::kDimension)), count(1, 9), kind(0, 3);
  Overlay overlay;
  for (int i = count(rng); i > 0; --i) {
    OverlayShape shape;
    shape.kind = static_cast<OverlayShape::Kind>(kind(rng));
    shape.role = static_cast<OverlayRole>(role(rng));
    for (int k = count(rng); k > 0; --k) shape.points.emplace_back(u(rng), v(rng));
    shape.text = "0.123 m " + std::to_string(i);
    overlay.shapes.push_back(shape);
  }
  return overlay;
}

struct Shown {
  explicit Shown(bool undistorted = false) {
    canvas.resize(500, 420);
    canvas.show();
    canvas.setPicture(noise(640, 480));
    canvas.setCamera(barrel(640, 480));
    canvas.setUndistorted(undistorted);
  }
  void mouse(QEvent::Type type, QPointF at, Qt::MouseButton button, Qt::MouseButtons buttons) {
    QMouseEvent event(type, at, canvas.mapToGlobal(at.toPoint()), button, buttons, Qt::NoModifier);
    QApplication::sendEvent(&canvas, &event);
  }
  ImageCanvas canvas{vision::PaneSide::kLeft};
};

TEST(CanvasRepaint, ShowsEveryOverlayWhole) {
  for (const bool undistorted : {false, true}) {
    Shown shown(undistorted);
    Screen screen(shown.canvas);
    std::mt19937 rng(3);
    for (int step = 0; step < 60; ++step) {
      screen.forget();
      if (step % 3 == 2) {
        shown.canvas.setPathOverlay(randomOverlay(rng));
      } else {
        shown.canvas.setOverlay(randomOverlay(rng));
      }
      if (step % 7 == 6) shown.canvas.zoomAbout({200, 180}, step % 2 == 0 ? 1.4 : 0.8);
      screen.settle();
      ASSERT_EQ(screen.stale(), 0) << "step " << step;
    }
  }
}

Overlay handleAt(const Eigen::Vector2d& at) {
  Overlay overlay;
  overlay.shapes.push_back({OverlayShape::Kind::kPolyline, OverlayRole::kSelected, {{100, 400}, at}, {}});
  overlay.shapes.push_back({OverlayShape::Kind::kMarker, OverlayRole::kActiveHandle, {at}, {}});
  overlay.shapes.push_back({OverlayShape::Kind::kText, OverlayRole::kLabel, {at}, "0.300 m +- 2 mm"});
  for (int tick = 0; tick < 6; ++tick) {
    const Eigen::Vector2d place(60 + 70 * tick + 0.4 * at.x() * (tick % 2), 90);
    overlay.shapes.push_back({OverlayShape::Kind::kText, OverlayRole::kDepthTick, {place}, "1.25 m"});
  }
  return overlay;
}

TEST(CanvasRepaint, FollowsADragWithItsLoupe) {
  Shown shown;
  Screen screen(shown.canvas);
  const auto show = [&](const vision::PointerEvent& event) { shown.canvas.setOverlay(handleAt(event.pixel)); };
  QObject::connect(&shown.canvas, &ImageCanvas::pointer, &shown.canvas, show);
  shown.mouse(QEvent::MouseButtonPress, {150, 200}, Qt::LeftButton, Qt::LeftButton);
  screen.settle();
  ASSERT_TRUE(shown.canvas.loupeVisible());
  for (int step = 0; step < 40; ++step) {
    screen.forget();
    const QPointF at(150 + 9 * step, 200 + 120 * std::sin(0.3 * step));
    shown.mouse(QEvent::MouseMove, at, Qt::NoButton, Qt::LeftButton);
    screen.settle();
    ASSERT_EQ(screen.stale(), 0) << "step " << step;
    EXPECT_LT(screen.paintedShare(), 0.75);
  }
  shown.mouse(QEvent::MouseButtonRelease, {510, 200}, Qt::LeftButton, Qt::NoButton);
  screen.settle();
  EXPECT_FALSE(shown.canvas.loupeVisible());
  EXPECT_EQ(screen.stale(), 0) << "the loupe is still on the screen";
}

TEST(CanvasRepaint, LeavesAloneWhatStaysTheSame) {
  Shown shown;
  std::mt19937 rng(9);
  Overlay many = randomOverlay(rng);
  shown.canvas.setOverlay(many);
  Screen screen(shown.canvas);
  shown.canvas.setOverlay(many);
  screen.settle();
  EXPECT_EQ(screen.paintedShare(), 0);
  many.shapes.push_back({OverlayShape::Kind::kMarker, OverlayRole::kHandle, {{320, 240}}, {}});
  shown.canvas.setOverlay(many);
  screen.settle();
  EXPECT_GT(screen.paintedShare(), 0);
  EXPECT_LT(screen.paintedShare(), 0.25);
  EXPECT_EQ(screen.stale(), 0);
}

TEST(CanvasRepaint, WhatIsDrawnAtNoNumberIsNowhere) {
  Shown shown;
  Screen screen(shown.canvas);
  const double none = std::nan(""), far = 1e300;
  Overlay broken;
  for (const auto kind : {OverlayShape::Kind::kMarker, OverlayShape::Kind::kPolyline}) {
    broken.shapes.push_back({kind, OverlayRole::kHandle, {{none, 10}, {20, none}}, {}});
    broken.shapes.push_back({kind, OverlayRole::kHandle, {{far, -far}, {-far, far}}, {}});
  }
  broken.shapes.push_back({OverlayShape::Kind::kText, OverlayRole::kLabel, {{none, none}}, "nowhere"});
  shown.canvas.setOverlay(broken);
  screen.settle();
  EXPECT_EQ(screen.stale(), 0);
}

}  // namespace
}  // namespace longarm::widgets
