// How long a new point takes to be seen in the 3-D scene, and the robot's own links to be found in a picture.
#include <cmath>
#include <memory>

#include <QElapsedTimer>
#include <QThread>

#include "planning/robot/link_mask.h"
#include "planning/world/workcell.h"
#include "tests/benchmarks/application.h"
#include "tests/benchmarks/gate.h"
#include "vision/camera/camera_file.h"
#include "widgets/scene/ground_grid_rep.h"
#include "widgets/scene/robot_rep.h"
#include "widgets/scene/sketch_rep.h"
#include "widgets/scene_view.h"

namespace longarm::benchmarks {
namespace {

constexpr int kClicks = 40, kMasks = 60, kRest_ms = 150;

scene::SketchItem pointAt(const Eigen::Vector3d& xyz) {
  scene::SketchItem item;
  item.feature.kind = vision::FeatureKind::kPoint;
  item.feature.name = "Point 1";
  item.feature.vertices.resize(1);
  item.feature.vertices[0].xyz = xyz;
  item.feature.vertices[0].covariance = Eigen::Vector3d(4e-5, 4e-6, 4e-6).asDiagonal();
  item.selected = true;
  return item;
}

void rest(int milliseconds) {
  QElapsedTimer timer;
  timer.start();
  while (timer.elapsed() < milliseconds) {
    QApplication::processEvents();
    QThread::msleep(1);
  }
}

// The scene as the window shows it: robot, ground, and a point with its ellipsoid that is marked anew each time.
Latency measureScene() {
  ensureApplication();
  const auto workcell = planning::loadBuiltInWorkcell();
  if (!workcell) return {1e9, 1e9, 1e9};
  widgets::SceneView view;
  scene::GroundGridRep grid;
  scene::RobotRep robot(workcell->model);
  scene::SketchRep sketch;
  grid.update(3, 0.25);
  for (auto* part : {static_cast<scene::Representation*>(&grid), static_cast<scene::Representation*>(&robot),
                     static_cast<scene::Representation*>(&sketch)}) {
    part->addTo(view.renderer());
  }
  view.resize(420, 420);
  view.show();
  view.showPreset(scene::CameraPreset::kIso);
  rest(1000);
  std::vector<double> wall, work;
  for (int i = 0; i < kClicks; ++i) {
    const int before = view.renderCount();
    QElapsedTimer timer;
    timer.start();
    const double work_before = workSeconds();
    sketch.update({pointAt({0.8 + 0.005 * i, 0.1, 0.5})});
    view.requestRender();
    while (view.renderCount() == before && timer.elapsed() < 2000) QApplication::processEvents();
    QGuiApplication::sync();
    wall.push_back(1e-9 * static_cast<double>(timer.nsecsElapsed()));
    work.push_back(workSeconds() - work_before);
    rest(kRest_ms);
  }
  return latencyOf(wall, work);
}

// The head's left camera over the built-in robot in poses all about.
Latency measureOwnLinks() {
  const auto workcell = planning::loadBuiltInWorkcell();
  if (!workcell) return {1e9, 1e9, 1e9};
  const auto& model = *workcell->model;
  const auto* camera = workcell->camera("head_left");
  const auto file = vision::readCameraFile(camera->calibration);
  const auto link = model.linkIndex(camera->link);
  if (!file || !link) return {1e9, 1e9, 1e9};
  const planning::LinkSilhouettes silhouettes(workcell->model);
  std::vector<double> wall, work;
  for (int i = 0; i < kMasks; ++i) {
    Eigen::VectorXd q = model.neutral();
    for (Eigen::Index k = 0; k < q.size(); ++k) q(k) += 0.3 * std::sin(0.7 * i + 1.3 * static_cast<double>(k));
    vision::View view;
    view.name = camera->name;
    view.camera = file->camera;
    view.X_WC = model.forward(q, *link);
    QElapsedTimer timer;
    timer.start();
    const double work_before = workSeconds();
    const auto mask = silhouettes.maskOf(q, view);
    if (!mask) return {1e9, 1e9, 1e9};
    wall.push_back(1e-9 * static_cast<double>(timer.nsecsElapsed()));
    work.push_back(workSeconds() - work_before);
  }
  return latencyOf(wall, work);
}

}  // namespace

std::vector<Budget> sceneBudgets(std::map<std::string, std::string>* skipped) {
  std::vector<Budget> budgets = {{"own_links", 0.020, measureOwnLinks}};
  if (hasDisplay()) {
    budgets.push_back({"click_to_scene", 0.050, measureScene});
  } else {
    (*skipped)["click_to_scene"] = "needs a display for OpenGL; run it under xvfb-run";
  }
  return budgets;
}

}  // namespace longarm::benchmarks
