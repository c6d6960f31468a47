#pragma once

/// @file
/// ScenePanel: the 3-D scene with its presets and the opacity of the embedded pictures.

#include <array>
#include <memory>
#include <optional>

#include <QFrame>
#include <QTimer>

#include "ui/actions.h"
#include "ui/scene_contents.h"
#include "ui/workbench.h"

class QLabel;
class QSlider;

namespace longarm::ui {

/// Binds document and robot to the scene.  What the panes show comes by setPane().  GUI thread only.
class ScenePanel final : public QFrame {
  Q_OBJECT

 public:
  ScenePanel(Workbench& bench, Actions& actions, Appearance& appearance, QWidget* parent = nullptr);
  ~ScenePanel() override;

  widgets::SceneView* view() const { return m_view; }
  /// The view and picture of a pane; a live one may be given with every frame.
  void setPane(vision::PaneSide side, const std::optional<vision::View>& view, const cv::Mat& picture);

 private:
  QWidget* buildBar(Actions& actions);
  void bind(Actions& actions);
  void onWorkcell();
  void onJoints();
  void onWorld();
  void onSketch();
  void onPlan();
  void showClearance();
  void measureAt(const QPointF& position);
  void showPanes();
  void showAll(scene::CameraPreset preset);
  void frameSelection();
  void lookFrom(vision::PaneSide side);

  struct Pane {
    std::optional<vision::View> view;
    cv::Mat picture;
    bool changed = false;
  };
  Workbench& m_bench;
  Actions& m_actions;
  widgets::SceneView* m_view;
  std::unique_ptr<SceneContents> m_contents;
  QSlider* m_opacity;
  QLabel* m_clearance;                     // What the colours of the path mean.
  std::array<Pane, 2> m_panes;
  QTimer m_pane_timer;                     // Live pictures reach the scene at most a few times a second.
  int m_observer = 0;
  bool m_framed = false;                   // The robot has been brought into view once.
};

}  // namespace longarm::ui
