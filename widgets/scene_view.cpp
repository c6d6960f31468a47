#include "widgets/scene_view.h"

#include <algorithm>
#include <cmath>

#include <QLabel>
#include <QMouseEvent>
#include <QVBoxLayout>
#include <QVTKOpenGLNativeWidget.h>                  // vtkGUISupportQt
#include <vtkCamera.h>                               // vtkRenderingCore
#include <vtkGenericOpenGLRenderWindow.h>            // vtkRenderingOpenGL2
#include <vtkInteractorStyleTrackballCamera.h>       // vtkInteractionStyle
#include <vtkMatrix4x4.h>                            // vtkCommonMath
#include <vtkNew.h>                                  // vtkCommonCore
#include <vtkRenderWindowInteractor.h>               // vtkRenderingCore
#include <vtkRenderer.h>                             // vtkRenderingCore

namespace longarm::widgets {

namespace {

constexpr int kFrame_ms = 33;
constexpr int kShareOfTime = 3, kSlowest_ms = 250, kSmoothUpTo_ms = 40;
constexpr double kRadiansPerDegree = 0.017453292519943295;
constexpr double kClickSlack = 4;              // a press that moves less is a click [screen px]

double distanceToSegment(const QPointF& p, const QPointF& a, const QPointF& b) {
  const QPointF ab = b - a;
  const double length2 = QPointF::dotProduct(ab, ab);
  const double s = length2 > 0 ? std::clamp(QPointF::dotProduct(p - a, ab) / length2, 0.0, 1.0) : 0;
  const QPointF rest = p - (a + ab * s);
  return std::hypot(rest.x(), rest.y());
}

}  // namespace

struct SceneView::Vtk {
  vtkNew<vtkGenericOpenGLRenderWindow> window;
  vtkNew<vtkRenderer> renderer;
};

SceneView::SceneView(QWidget* parent) : QWidget(parent), m_vtk(std::make_unique<Vtk>()) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  m_surface = new QVTKOpenGLNativeWidget(m_vtk->window, this);
  m_surface->setEnableHiDPI(true);
  layout->addWidget(m_surface);
  m_banner = new QLabel(this);
  m_banner->setWordWrap(true);
  m_banner->setAlignment(Qt::AlignCenter);
  m_banner->setText(tr("No 3-D scene: this display gives no OpenGL 3.2.\nEverything else works. Try LIBGL_ALWAYS_SOFTWARE=1."));
  m_banner->hide();
  layout->addWidget(m_banner);
  m_vtk->window->AddRenderer(m_vtk->renderer);
  m_vtk->renderer->GradientBackgroundOn();
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  style->SetMotionFactor(8);
  m_vtk->window->GetInteractor()->SetInteractorStyle(style);
  m_vtk->window->GetInteractor()->SetDesiredUpdateRate(30);
  // The interactor must be allowed to render: QVTKOpenGLNativeWidget paints through it, and stays black otherwise.
  m_surface->installEventFilter(this);
  m_render_timer.setSingleShot(true);
  connect(&m_render_timer, &QTimer::timeout, this, &SceneView::render);
  setTheme(m_theme);
}

SceneView::~SceneView() {
  m_surface->removeEventFilter(this);
}

vtkRenderer* SceneView::renderer() const { return m_vtk->renderer; }

void SceneView::setTheme(const Theme& theme) {
  m_theme = theme;
  m_vtk->renderer->SetBackground(theme.scene_bottom.redF(), theme.scene_bottom.greenF(), theme.scene_bottom.blueF());
  m_vtk->renderer->SetBackground2(theme.scene_top.redF(), theme.scene_top.greenF(), theme.scene_top.blueF());
  requestRender();
}

bool SceneView::usable() const { return m_surface->isValid(); }

void SceneView::requestRender() {
  if (m_render_timer.isActive() || !isVisible()) return;
  const qint64 rest = std::max<qint64>(kFrame_ms, m_rest_ms);
  const qint64 since = m_since_render.isValid() ? m_since_render.elapsed() : rest;
  m_render_timer.start(static_cast<int>(std::clamp<qint64>(rest - since, 0, rest)));
}

void SceneView::render() {
  if (!isVisible() || !usable()) return;
  m_since_render.start();
  ++m_render_count;
  m_vtk->renderer->ResetCameraClippingRange();
  m_vtk->window->Render();
  m_surface->update();
  // Without a graphics card a rendering takes tens of milliseconds on every core: leave as much for the rest.
  const qint64 took_ms = m_since_render.elapsed();
  m_rest_ms = std::min<qint64>(kShareOfTime * took_ms, kSlowest_ms);
  // Smooth edges cost a software renderer several times the picture; a window that answers matters more.
  if (took_ms > kSmoothUpTo_ms && m_vtk->window->GetMultiSamples() > 0) m_vtk->window->SetMultiSamples(0);
}

void SceneView::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  // The context exists only after the widget was composed once.
  QTimer::singleShot(0, this, [this] {
    const bool ok = usable();
    m_surface->setVisible(ok);
    m_banner->setVisible(!ok);
    if (ok) requestRender();
  });
}

void SceneView::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  if (m_fixed_view) lookFromView(*m_fixed_view);
  requestRender();
}

void SceneView::leaveFixedView() {
  if (!m_fixed_view) return;
  m_fixed_view.reset();
  scene::endLookFrom(m_vtk->renderer);
}

void SceneView::showPreset(scene::CameraPreset preset) {
  leaveFixedView();
  scene::applyPreset(m_vtk->renderer, preset);
  requestRender();
}

void SceneView::fit() {
  leaveFixedView();
  scene::fitView(m_vtk->renderer);
  requestRender();
}

void SceneView::lookFromView(const vision::View& view) {
  m_fixed_view = view;
  const double ratio = devicePixelRatioF();
  scene::lookFrom(m_vtk->renderer, view, static_cast<int>(width() * ratio), static_cast<int>(height() * ratio));
  requestRender();
}

QPointF SceneView::toVtk(const QPointF& position) const {
  const double ratio = devicePixelRatioF();
  return {position.x() * ratio, height() * ratio - 1 - position.y() * ratio};
}

std::optional<QPointF> SceneView::widgetOfPoint(const Eigen::Vector3d& p_W) const {
  vtkCamera* camera = m_vtk->renderer->GetActiveCamera();
  const double aspect = height() > 0 ? static_cast<double>(width()) / height() : 1;
  vtkMatrix4x4* projection = camera->GetCompositeProjectionTransformMatrix(aspect, -1, 1);
  const double point[4] = {p_W.x(), p_W.y(), p_W.z(), 1};
  double clip[4];
  projection->MultiplyPoint(point, clip);
  if (clip[3] <= 0) return {};
  return QPointF((clip[0] / clip[3] + 1) / 2 * width(), (1 - clip[1] / clip[3]) / 2 * height());
}

std::optional<quint64> SceneView::pick(const QPointF& position, double radius) const {
  std::optional<quint64> best;
  double best_distance = radius;
  for (const auto& pickable : m_pickables) {
    std::optional<QPointF> before;
    for (const auto& point : pickable.points) {
      const auto at = widgetOfPoint(point);
      if (!at) continue;
      const double distance = distanceToSegment(position, *at, before.value_or(*at));
      if (distance <= best_distance) {
        best_distance = distance;
        best = pickable.id;
      }
      before = at;
    }
  }
  return best;
}

std::optional<std::pair<quint64, int>> SceneView::pickPoint(const QPointF& position, double radius) const {
  std::optional<std::pair<quint64, int>> best;
  double best_distance = radius;
  for (const auto& pickable : m_pickables) {
    for (std::size_t i = 0; i < pickable.points.size(); ++i) {
      const auto at = widgetOfPoint(pickable.points[i]);
      const double distance = at ? std::hypot(at->x() - position.x(), at->y() - position.y()) : radius + 1;
      if (distance > best_distance) continue;
      best_distance = distance;
      best = {pickable.id, static_cast<int>(i)};
    }
  }
  return best;
}

SceneSight SceneView::sightAt(const QPointF& position) const {
  vtkCamera* camera = m_vtk->renderer->GetActiveCamera();
  const double aspect = height() > 0 ? static_cast<double>(width()) / height() : 1;
  const double x = 2 * position.x() / std::max(1, width()) - 1, y = 1 - 2 * position.y() / std::max(1, height());
  vtkNew<vtkMatrix4x4> back;
  vtkMatrix4x4::Invert(camera->GetCompositeProjectionTransformMatrix(aspect, -1, 1), back);
  const auto at = [&](double depth) {
    const double clip[4] = {x, y, depth, 1};
    double world[4];
    back->MultiplyPoint(clip, world);
    return Eigen::Vector3d(world[0] / world[3], world[1] / world[3], world[2] / world[3]);
  };
  const Eigen::Vector3d near = at(-1);
  return {near, (at(1) - near).normalized(), camera->GetViewAngle() * kRadiansPerDegree / std::max(1, height())};
}

bool SceneView::eventFilter(QObject* watched, QEvent* event) {
  switch (event->type()) {
    case QEvent::MouseButtonPress: m_press = static_cast<QMouseEvent*>(event)->localPos(); break;
    case QEvent::MouseMove: {
      auto* mouse = static_cast<QMouseEvent*>(event);
      if (mouse->buttons() == Qt::NoButton) break;
      const QPointF moved = mouse->localPos() - m_press;
      if (std::hypot(moved.x(), moved.y()) > kClickSlack) leaveFixedView();
      requestRender();
      break;
    }
    case QEvent::MouseButtonRelease: {
      auto* mouse = static_cast<QMouseEvent*>(event);
      const QPointF moved = mouse->localPos() - m_press;
      if (mouse->button() == Qt::LeftButton && std::hypot(moved.x(), moved.y()) <= kClickSlack) {
        Q_EMIT picked(pick(mouse->localPos()).value_or(0));
        Q_EMIT clicked(mouse->localPos());
      }
      requestRender();
      break;
    }
    case QEvent::Wheel:
      leaveFixedView();
      requestRender();
      break;
    // VTK's own keys (w, s, e, p, ...) would change the scene behind the operator's back.
    case QEvent::KeyPress:
    case QEvent::KeyRelease: event->ignore(); return true;
    default: break;
  }
  return QWidget::eventFilter(watched, event);
}

}  // namespace longarm::widgets
