// Where the scene's own camera stands.
#include <gtest/gtest.h>
#include <vtkCamera.h>  // vtkRenderingCore
#include <vtkRenderer.h>

#include "tests/widgets/scene/scene_rig.h"
#include "widgets/scene/camera_presets.h"
#include "widgets/scene/world_rep.h"

namespace longarm::scene {
namespace {

using tests::SceneRig;

WorldRep& box(WorldRep& world) {
  planning::WorldObject object;
  object.name = "box";
  object.shape = planning::Box{{0.6, 0.4, 0.2}};
  object.X_WO.translation() = Eigen::Vector3d(1, -0.5, 0.3);
  object.rgba = {0.9, 0.9, 0.9, 1};
  world.update({object});
  return world;
}

TEST(CameraPresets, AreNamedAndReadBack) {
  for (const auto preset : {CameraPreset::kTop, CameraPreset::kFront, CameraPreset::kLeftSide, CameraPreset::kRightSide,
                            CameraPreset::kBack, CameraPreset::kIso}) {
    EXPECT_EQ(cameraPresetFrom(toString(preset)), preset);
  }
  EXPECT_FALSE(cameraPresetFrom("sideways").has_value());
}

TEST_F(SceneRig, EveryPresetShowsEverythingWhole) {
  WorldRep world;
  box(world).addTo(renderer());
  for (const auto preset : {CameraPreset::kTop, CameraPreset::kFront, CameraPreset::kLeftSide, CameraPreset::kRightSide,
                            CameraPreset::kBack, CameraPreset::kIso}) {
    applyPreset(renderer(), preset);
    const cv::Rect seen = extent(drawn(m_renderer->render()));
    EXPECT_GT(seen.area(), 2000) << toString(preset);
    EXPECT_TRUE(seen.x > 0 && seen.y > 0 && seen.br().x < 320 && seen.br().y < 240) << toString(preset);
  }
}

TEST_F(SceneRig, FitKeepsTheDirection) {
  WorldRep world;
  box(world).addTo(renderer());
  applyPreset(renderer(), CameraPreset::kLeftSide);
  double before[3], after[3];
  renderer()->GetActiveCamera()->GetDirectionOfProjection(before);
  renderer()->GetActiveCamera()->Dolly(0.2);
  fitView(renderer());
  renderer()->GetActiveCamera()->GetDirectionOfProjection(after);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(before[i], after[i], 1e-9);
  EXPECT_GT(extent(drawn(m_renderer->render())).area(), 4000);
}

TEST_F(SceneRig, LookingFromASnapshotSeesWhatItSaw) {
  WorldRep world;
  box(world).addTo(renderer());
  m_view.X_WC.translation() = Eigen::Vector3d(-1, -0.4, 0.35);
  const cv::Mat exact = drawn(shot());
  lookFrom(renderer(), m_view, 320, 240);
  EXPECT_TRUE(isLookingFromView(renderer()));
  const cv::Mat seen = drawn(m_renderer->render());
  EXPECT_LT(cv::countNonZero(exact != seen), cv::countNonZero(exact) / 40 + 10);
  endLookFrom(renderer());
  EXPECT_FALSE(isLookingFromView(renderer()));
}

}  // namespace
}  // namespace longarm::scene
