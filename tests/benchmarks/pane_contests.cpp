// The video pane against a GL widget with the same picture, and how long a drag takes to be seen.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>

#include <QElapsedTimer>
#include <QHBoxLayout>
#include <QMouseEvent>
#include <vtkActor.h>                        // vtkRenderingCore
#include <vtkCellArray.h>                    // vtkCommonDataModel
#include <vtkCamera.h>                       // vtkRenderingCore
#include <vtkGenericOpenGLRenderWindow.h>    // vtkRenderingOpenGL2
#include <vtkImageData.h>                    // vtkCommonDataModel
#include <vtkNew.h>                          // vtkCommonCore
#include <vtkPlaneSource.h>                  // vtkFiltersSources
#include <vtkPoints.h>                       // vtkCommonCore
#include <vtkPolyData.h>                     // vtkCommonDataModel
#include <vtkPolyDataMapper.h>               // vtkRenderingCore
#include <vtkProperty.h>                     // vtkRenderingCore
#include <vtkRenderer.h>                     // vtkRenderingCore
#include <vtkTexture.h>                      // vtkRenderingCore
#include <opencv2/imgproc.hpp>

#include "session/commands/sketch_commands.h"
#include "session/tools/tool_host.h"
#include "tests/benchmarks/application.h"
#include "tests/benchmarks/gate.h"
#include "tests/vision/stereo_rig.h"
#include "vision/sketch/overlay.h"
#include "widgets/image_canvas.h"

namespace longarm::benchmarks {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using vision::PaneSide;
using widgets::ImageCanvas;

constexpr int kWidth = 640, kHeight = 480, kFrames = 4, kOutline = 60;

std::vector<cv::Mat> frames(int width, int height) {
  std::vector<cv::Mat> out;
  cv::RNG rng(1);
  for (int i = 0; i < kFrames; ++i) {
    cv::Mat frame(height, width, CV_8UC3);
    rng.fill(frame, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(frame, frame, {}, 2);
    out.push_back(frame);
  }
  return out;
}

// An outline of sixty vertices about a centre that wanders, and a line.
std::vector<Vector2d> outlineAt(int step) {
  std::vector<Vector2d> points;
  for (int i = 0; i <= kOutline; ++i) {
    const double angle = 2 * M_PI * i / kOutline;
    points.emplace_back(320 + step % 20 + 150 * std::cos(angle), 240 + 100 * std::sin(angle));
  }
  return points;
}

struct CanvasPane {
  CanvasPane() {
    canvas.resize(kWidth, kHeight);
    canvas.show();
    QApplication::processEvents();
  }
  void showFrame() {
    canvas.setPicture(pictures[static_cast<std::size_t>(step % kFrames)]);
    vision::Overlay overlay;
    overlay.shapes.push_back({vision::OverlayShape::Kind::kPolyline, vision::OverlayRole::kSketch, outlineAt(step), {}});
    overlay.shapes.push_back({vision::OverlayShape::Kind::kPolyline, vision::OverlayRole::kEpipolar, {{10, 200}, {630, 260}}, {}});
    canvas.setOverlay(overlay);
    canvas.repaint();
    QGuiApplication::sync();
    ++step;
  }
  ImageCanvas canvas{PaneSide::kLeft};
  std::vector<cv::Mat> pictures = frames(kWidth, kHeight);
  int step = 0;
};

// The same picture as a textured quad, the outline and the line as VTK's lines.
struct GlPane {
  GlPane() : widget(window.GetPointer()) {
    texture_image->SetDimensions(kWidth, kHeight, 1);
    texture_image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    texture->SetInputData(texture_image);
    texture->InterpolateOn();
    quad->SetOrigin(0, 0, 0);
    quad->SetPoint1(kWidth, 0, 0);
    quad->SetPoint2(0, kHeight, 0);
    quad_mapper->SetInputConnection(quad->GetOutputPort());
    quad_actor->SetMapper(quad_mapper);
    quad_actor->SetTexture(texture);
    quad_actor->GetProperty()->LightingOff();
    line_mapper->SetInputData(lines);
    line_actor->SetMapper(line_mapper);
    line_actor->GetProperty()->LightingOff();
    line_actor->GetProperty()->SetLineWidth(2);
    renderer->AddActor(quad_actor);
    renderer->AddActor(line_actor);
    renderer->GetActiveCamera()->ParallelProjectionOn();
    renderer->GetActiveCamera()->SetParallelScale(kHeight / 2.0);
    renderer->GetActiveCamera()->SetFocalPoint(kWidth / 2.0, kHeight / 2.0, 0);
    renderer->GetActiveCamera()->SetPosition(kWidth / 2.0, kHeight / 2.0, 100);
    window->AddRenderer(renderer);
    widget.resize(kWidth, kHeight);
    widget.show();
    QApplication::processEvents();
    for (int i = 0; i < 3; ++i) showFrame();
  }
  void showFrame() {
    const cv::Mat& picture = pictures[static_cast<std::size_t>(step % kFrames)];
    cv::Mat target(kHeight, kWidth, CV_8UC3, texture_image->GetScalarPointer());
    cv::cvtColor(picture, target, cv::COLOR_BGR2RGB);
    texture_image->Modified();
    setLines();
    window->Render();
    widget.repaint();
    QGuiApplication::sync();
    ++step;
  }
  void setLines() {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    auto outline = outlineAt(step);
    cells->InsertNextCell(static_cast<vtkIdType>(outline.size()));
    for (const auto& p : outline) cells->InsertCellPoint(points->InsertNextPoint(p.x(), kHeight - p.y(), 1));
    cells->InsertNextCell(2);
    cells->InsertCellPoint(points->InsertNextPoint(10, kHeight - 200, 1));
    cells->InsertCellPoint(points->InsertNextPoint(630, kHeight - 260, 1));
    lines->SetPoints(points);
    lines->SetLines(cells);
  }
  vtkNew<vtkGenericOpenGLRenderWindow> window;
  QVTKOpenGLNativeWidget widget;
  vtkNew<vtkImageData> texture_image;
  vtkNew<vtkTexture> texture;
  vtkNew<vtkPlaneSource> quad;
  vtkNew<vtkPolyDataMapper> quad_mapper, line_mapper;
  vtkNew<vtkActor> quad_actor, line_actor;
  vtkNew<vtkPolyData> lines;
  vtkNew<vtkRenderer> renderer;
  std::vector<cv::Mat> pictures = frames(kWidth, kHeight);
  int step = 0;
};

// The last frame as each pane shows it.
Accuracy samePicture(CanvasPane* ours, GlPane* theirs) {
  ours->step = theirs->step = 0;
  ours->showFrame();
  theirs->showFrame();
  const auto mean = [](const QImage& image) {
    double sum = 0;
    for (int y = 0; y < image.height(); y += 4) {
      for (int x = 0; x < image.width(); x += 4) sum += qGray(image.pixel(x, y));
    }
    return sum / (((image.height() + 3) / 4) * ((image.width() + 3) / 4));
  };
  const double a = mean(ours->canvas.grab().toImage()), b = mean(theirs->widget.grab().toImage());
  return {std::abs(a - b) < 4, "mean grey " + std::to_string(a) + " and " + std::to_string(b) + " (both show the picture)"};
}

// Two panes and the sketch between them, as in the console, at full size.
class DragScene {
 public:
  DragScene() {
    auto camera = tests::lensCamera("left");
    camera.width = 1920;
    camera.height = 1080;
    camera.fx = camera.fy = 1700;
    camera.cx = 955;
    camera.cy = 545;
    const auto left = tests::viewOf(camera, {0, 0, 0});
    camera.name = "right";
    const auto right = tests::viewOf(camera, {0.254, 0.003, 0.002}, {0.005, -0.06, 0.003});
    const auto pictures = frames(1920, 1080);
    std::vector<vision::SnapshotPtr> snapshots;
    for (const auto& view : {left, right}) {
      auto snapshot = std::make_shared<vision::Snapshot>();
      snapshot->id = {snapshots.size() + 1};
      snapshot->view = view;
      snapshot->image = pictures[snapshots.size()];
      snapshots.push_back(snapshot);
    }
    m_history.push(session::addSnapshots(m_document, snapshots));
    for (std::size_t i = 0; i < 2; ++i) show(i, *snapshots[i]);
    m_window.resize(1910, 560);
    auto* layout = new QHBoxLayout(&m_window);
    for (auto* canvas : m_canvases) layout->addWidget(canvas);
    m_window.show();
    QApplication::processEvents();
    m_tools.setCallbacks({[this] { drawOverlays(); }, {}, {}});
    m_tools.setTool(session::ToolKind::kLine);
    drawLine({0.0, 0.1, 1.5}, {0.3, 0.12, 1.6});
  }

  struct Times {
    std::vector<double> wall, work;    // [s]
  };
  // Every drag step until both panes are repainted.
  Times drag(int steps) {
    Times times;
    const QPointF start = *m_canvases[0]->widgetOfPixel(m_grip);
    mouse(0, QEvent::MouseButtonPress, start, Qt::LeftButton, Qt::LeftButton);
    QApplication::processEvents();
    for (int i = 1; i <= steps; ++i) {
      const QPointF at = start + QPointF(120 * std::sin(0.11 * i), 60 * std::sin(0.07 * i));
      QElapsedTimer timer;
      timer.start();
      const double work_before = workSeconds();
      mouse(0, QEvent::MouseMove, at, Qt::NoButton, Qt::LeftButton);
      QApplication::processEvents();         // both panes paint what was asked for
      QGuiApplication::sync();
      times.wall.push_back(1e-9 * static_cast<double>(timer.nsecsElapsed()));
      times.work.push_back(workSeconds() - work_before);
    }
    mouse(0, QEvent::MouseButtonRelease, start, Qt::LeftButton, Qt::NoButton);
    QApplication::processEvents();
    return times;
  }

  // The click that completes a point, until its numbers are there as text and both panes are repainted.
  Times click(int times_over) {
    Times times;
    const Vector3d place(0.1, 0.05, 1.5);
    for (int i = 0; i < times_over; ++i) {
      m_tools.setTool(session::ToolKind::kPoint);
      const QPointF first = *m_canvases[0]->widgetOfPixel(m_document.snapshot({1})->view.project(place).value());
      const QPointF second = *m_canvases[1]->widgetOfPixel(m_document.snapshot({2})->view.project(place).value());
      mouse(0, QEvent::MouseButtonPress, first, Qt::LeftButton, Qt::LeftButton);
      mouse(0, QEvent::MouseButtonRelease, first, Qt::LeftButton, Qt::NoButton);
      QApplication::processEvents();
      QElapsedTimer timer;
      timer.start();
      const double work_before = workSeconds();
      mouse(1, QEvent::MouseButtonPress, second, Qt::LeftButton, Qt::LeftButton);
      mouse(1, QEvent::MouseButtonRelease, second, Qt::LeftButton, Qt::NoButton);
      const auto live = m_tools.liveMeasure();
      const bool told = live && live->xyz && live->text().find("mm") != std::string::npos;
      QApplication::processEvents();
      QGuiApplication::sync();
      times.wall.push_back(told ? 1e-9 * static_cast<double>(timer.nsecsElapsed()) : 1e9);
      times.work.push_back(workSeconds() - work_before);
      m_history.undo();
      m_history.undo();
      QApplication::processEvents();
    }
    return times;
  }

  // Overlays drawn so far: a drag that draws nothing measures nothing.
  int redraws() const { return m_redraws; }

 private:
  void show(std::size_t i, const vision::Snapshot& snapshot) {
    m_canvases[i]->setCamera(snapshot.view.camera);
    m_canvases[i]->setPicture(snapshot.image);
    QObject::connect(m_canvases[i], &ImageCanvas::pointer, m_canvases[i],
                     [this](const vision::PointerEvent& event) { m_tools.pointer(event); });
  }
  void drawOverlays() {
    ++m_redraws;
    m_canvases[0]->setOverlay(m_tools.overlay(PaneSide::kLeft));
    m_canvases[1]->setOverlay(m_tools.overlay(PaneSide::kRight));
  }
  void mouse(std::size_t pane, QEvent::Type type, QPointF at, Qt::MouseButton button, Qt::MouseButtons buttons) {
    QMouseEvent event(type, at, m_canvases[pane]->mapToGlobal(at.toPoint()), button, buttons, Qt::NoModifier);
    QApplication::sendEvent(m_canvases[pane], &event);
  }
  void drawLine(const Vector3d& a, const Vector3d& b) {
    session::SketchItem item;
    item.id = {1};
    item.kind = vision::FeatureKind::kLine;
    item.name = "Line 1";
    for (std::uint64_t id = 1; id <= 2; ++id) {
      const auto& view = m_document.snapshot({id})->view;
      item.setPick({id}, 0, {view.project(a).value(), id == 1 ? session::PickState::kFree : session::PickState::kConstrained});
      item.setPick({id}, 1, {view.project(b).value(), id == 1 ? session::PickState::kFree : session::PickState::kConstrained});
      if (id == 1) m_grip = view.project(a).value();
    }
    m_history.push(session::addItem(item));
    m_tools.setTool(session::ToolKind::kSelect);
    drawOverlays();
    QApplication::processEvents();
  }

  session::Document m_document;
  session::EditHistory m_history{m_document};
  session::ToolHost m_tools{m_document, m_history};
  QWidget m_window;
  ImageCanvas* m_canvases[2] = {new ImageCanvas(PaneSide::kLeft), new ImageCanvas(PaneSide::kRight)};
  Vector2d m_grip = Vector2d::Zero();
  int m_redraws = 0;
};

Latency measureDrag() {
  ensureApplication();
  DragScene scene;
  scene.drag(20);
  const int before = scene.redraws();
  DragScene::Times times = scene.drag(400);
  if (scene.redraws() - before < 400) return {1e9, 1e9, 1e9};      // nothing was dragged
  return latencyOf(times.wall, times.work);
}

Latency measureClick() {
  ensureApplication();
  DragScene scene;
  scene.click(10);
  const DragScene::Times times = scene.click(200);
  return latencyOf(times.wall, times.work);
}

}  // namespace

std::vector<Contest> paneContests(std::map<std::string, std::string>* skipped) {
  if (!hasDisplay()) {
    (*skipped)["video_pane"] = "needs a display for OpenGL; run it under xvfb-run";
    return {};
  }
  ensureApplication();
  const auto ours = std::make_shared<CanvasPane>();
  const auto theirs = std::make_shared<GlPane>();
  Contest contest{"video_pane", "QVTKOpenGLNativeWidget, quad of 640 x 480 and lines", {}, {}, 10, 30, true, {}};
  contest.ours = [ours] { ours->showFrame(); };
  contest.theirs = [theirs] { theirs->showFrame(); };
  contest.accuracy = [ours, theirs] { return samePicture(ours.get(), theirs.get()); };
  return {contest};
}

std::vector<Budget> paneBudgets(std::map<std::string, std::string>*) {
  return {{"drag_to_repaint", 0.008, measureDrag}, {"click_to_text", 0.010, measureClick}};
}

}  // namespace longarm::benchmarks
