#pragma once

/// @file
/// SceneView: a window onto a VTK renderer, with mouse, presets and picking.

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <QElapsedTimer>
#include <QTimer>
#include <QWidget>

#include "core/pose.h"
#include "vision/snapshot/view.h"
#include "widgets/scene/camera_presets.h"
#include "widgets/theme.h"

class QLabel;
class QVTKOpenGLNativeWidget;
class vtkRenderer;

namespace longarm::widgets {

/// A thing that can be picked in the scene: an id of the caller and points in the world frame [m]; two points are
/// the ends of a line.
struct Pickable {
  quint64 id = 0;
  std::vector<Eigen::Vector3d> points;
};

/// From the eye through a position in the window.
struct SceneSight {
  Eigen::Vector3d from, along;                     ///< World frame; `along` is a unit vector.
  double radians_per_pixel = 0;                    ///< Of the screen, in the middle of the view.
};

/// Renders when asked, at most 30 times a second and never more than a third of the time, and never by itself.  Left drag orbits, middle or Shift drag
/// pans, wheel or right drag zooms; a click without a drag picks.  GUI thread only.
class SceneView final : public QWidget {
  Q_OBJECT

 public:
  explicit SceneView(QWidget* parent = nullptr);
  ~SceneView() override;

  vtkRenderer* renderer() const;
  void setTheme(const Theme& theme);
  /// Something changed: one rendering follows soon.
  void requestRender();
  void setPickables(std::vector<Pickable> pickables) { m_pickables = std::move(pickables); }
  /// False when the machine gives no OpenGL: a banner stands in place of the scene.
  bool usable() const;
  int renderCount() const { return m_render_count; }

  /// Position in VTK's window (device pixels, origin at the bottom) of a position in this widget: the one place
  /// that knows about HiDPI.
  QPointF toVtk(const QPointF& position) const;
  /// Where a point of the world appears in this widget; nothing behind the camera.
  std::optional<QPointF> widgetOfPoint(const Eigen::Vector3d& p_W) const;
  /// The pickable within `radius` screen pixels of a position that is nearest to it.
  std::optional<quint64> pick(const QPointF& position, double radius = 12) const;
  /// The point of a pickable that is nearest, and its index in it.
  std::optional<std::pair<quint64, int>> pickPoint(const QPointF& position, double radius = 12) const;
  SceneSight sightAt(const QPointF& position) const;
  QSize sizeHint() const override { return {420, 420}; }

 public Q_SLOTS:
  void showPreset(longarm::scene::CameraPreset preset);
  void fit();
  /// Sees what a snapshot's camera saw, until the scene is turned.
  void lookFromView(const longarm::vision::View& view);

 Q_SIGNALS:
  void picked(quint64 id);                         ///< 0: nothing there.
  void clicked(const QPointF& position);           ///< At the same time: a click without a drag.

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;
  void showEvent(QShowEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void render();
  void leaveFixedView();

  Theme m_theme = Theme::dark();
  QVTKOpenGLNativeWidget* m_surface;
  QLabel* m_banner;
  struct Vtk;
  std::unique_ptr<Vtk> m_vtk;
  std::vector<Pickable> m_pickables;
  QTimer m_render_timer;
  QElapsedTimer m_since_render;
  int m_render_count = 0;
  qint64 m_rest_ms = 0;                            // From the start of a rendering to the next at the earliest.
  QPointF m_press;
  std::optional<vision::View> m_fixed_view;
};

}  // namespace longarm::widgets
