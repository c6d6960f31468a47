#include "widgets/scene/camera_presets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <vtkCamera.h>     // vtkRenderingCore
#include <vtkMatrix4x4.h>  // vtkCommonMath
#include <vtkNew.h>
#include <vtkRenderer.h>

namespace longarm::scene {
namespace {

using Eigen::Vector3d;

struct PresetView {
  CameraPreset preset;
  const char* word;
  Vector3d from;  ///< Direction from the scene's middle to the eye.
  Vector3d up;
};

const std::array<PresetView, 6>& presets() {
  static const std::array<PresetView, 6> kPresets = {{
      {CameraPreset::kTop, "top", {0, 0, 1}, {1, 0, 0}},
      {CameraPreset::kFront, "front", {1, 0, 0}, {0, 0, 1}},
      {CameraPreset::kLeftSide, "left", {0, 1, 0}, {0, 0, 1}},
      {CameraPreset::kRightSide, "right", {0, -1, 0}, {0, 0, 1}},
      {CameraPreset::kBack, "back", {-1, 0, 0}, {0, 0, 1}},
      {CameraPreset::kIso, "iso", {0.75, -0.95, 0.6}, {0, 0, 1}},
  }};
  return kPresets;
}

Eigen::AlignedBox3d boxToShow(vtkRenderer* renderer, const Eigen::AlignedBox3d& wanted) {
  if (!wanted.isEmpty()) return wanted;
  double b[6];
  renderer->ComputeVisiblePropBounds(b);
  if (b[0] <= b[1]) return {Vector3d(b[0], b[2], b[4]), Vector3d(b[1], b[3], b[5])};
  return {Vector3d(-1, -1, -1), Vector3d(1, 1, 1)};
}

void resetTo(vtkRenderer* renderer, const Eigen::AlignedBox3d& box) {
  const double b[6] = {box.min().x(), box.max().x(), box.min().y(), box.max().y(), box.min().z(), box.max().z()};
  renderer->ResetCamera(b);
  renderer->ResetCameraClippingRange();
}

}  // namespace

const char* toString(CameraPreset preset) {
  for (const PresetView& view : presets()) {
    if (view.preset == preset) return view.word;
  }
  return "iso";
}

std::optional<CameraPreset> cameraPresetFrom(const std::string& word) {
  for (const PresetView& view : presets()) {
    if (word == view.word) return view.preset;
  }
  return {};
}

void applyPreset(vtkRenderer* renderer, CameraPreset preset, const Eigen::AlignedBox3d& box) {
  endLookFrom(renderer);
  const Eigen::AlignedBox3d shown = boxToShow(renderer, box);
  const PresetView& view = *std::find_if(presets().begin(), presets().end(),
                                         [&](const PresetView& v) { return v.preset == preset; });
  const Vector3d middle = shown.center(), eye = middle + view.from;
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetFocalPoint(middle.data());
  camera->SetPosition(eye.data());
  camera->SetViewUp(view.up.data());
  camera->SetViewAngle(30);
  resetTo(renderer, shown);
}

void fitView(vtkRenderer* renderer, const Eigen::AlignedBox3d& box) {
  endLookFrom(renderer);
  resetTo(renderer, boxToShow(renderer, box));
}

void lookFrom(vtkRenderer* renderer, const vision::View& view, int width, int height) {
  vision::CameraModel camera = view.camera;
  if (camera.width <= 0 || camera.height <= 0 || width <= 0 || height <= 0) return;
  const double scale = std::min(static_cast<double>(width) / camera.width, static_cast<double>(height) / camera.height);
  const double left = (width - scale * camera.width) / 2, top = (height - scale * camera.height) / 2;
  camera.fx *= scale;
  camera.fy *= scale;
  camera.skew *= scale;
  camera.cx = (camera.cx + 0.5) * scale + left - 0.5;  // scaling is about the corner, pixels count from centres
  camera.cy = (camera.cy + 0.5) * scale + top - 0.5;
  vtkCamera* vtk_camera = renderer->GetActiveCamera();
  setCameraPose(vtk_camera, view.X_WC);
  setPinholeProjection(vtk_camera, camera, width, height, 0.02, 100);
  vtk_camera->SetClippingRange(0.02, 100);
}

void endLookFrom(vtkRenderer* renderer) {
  vtkCamera* camera = renderer->GetActiveCamera();
  if (!camera->GetUseExplicitProjectionTransformMatrix()) return;
  camera->UseExplicitProjectionTransformMatrixOff();
  camera->SetViewAngle(30);
  renderer->ResetCameraClippingRange();
}

bool isLookingFromView(vtkRenderer* renderer) {
  return renderer->GetActiveCamera()->GetUseExplicitProjectionTransformMatrix();
}

void setCameraPose(vtkCamera* camera, const Pose& X_WC) {
  const Vector3d eye = X_WC.translation(), focus = X_WC * Vector3d(0, 0, 1), up = X_WC.linear() * Vector3d(0, -1, 0);
  camera->SetPosition(eye.data());
  camera->SetFocalPoint(focus.data());
  camera->SetViewUp(up.data());
}

void setPinholeProjection(vtkCamera* vtk_camera, const vision::CameraModel& camera, int width, int height,
                          double near_m, double far_m) {
  // VTK's eye frame is x right, y up, z backward; the raster spans -1 ... 1 from edge to edge, and pixel centres lie
  // half a pixel inside it.
  vtkNew<vtkMatrix4x4> projection;
  projection->Zero();
  projection->SetElement(0, 0, 2 * camera.fx / width);
  projection->SetElement(0, 1, -2 * camera.skew / width);
  projection->SetElement(0, 2, 1 - 2 * (camera.cx + 0.5) / width);
  projection->SetElement(1, 1, 2 * camera.fy / height);
  projection->SetElement(1, 2, 2 * (camera.cy + 0.5) / height - 1);
  projection->SetElement(2, 2, -(far_m + near_m) / (far_m - near_m));
  projection->SetElement(2, 3, -2 * far_m * near_m / (far_m - near_m));
  projection->SetElement(3, 2, -1);
  vtk_camera->SetExplicitProjectionTransformMatrix(projection);
  vtk_camera->UseExplicitProjectionTransformMatrixOn();
  vtk_camera->SetViewAngle(2 * std::atan(0.5 * height / camera.fy) * 180 / M_PI);  // for sizes that VTK derives
}

}  // namespace longarm::scene
