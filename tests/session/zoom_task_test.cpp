// The two pan-tilt zoom cameras of the virtual robot: what the console says of them is what is true, and they watch.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "planning/macros/macro.h"
#include "planning/world/scenario.h"
#include "session/controllers/framing.h"
#include "session/controllers/runtime_feed.h"
#include "session/controllers/snapshot_maker.h"
#include "session/controllers/watch_controller.h"
#include "tests/session/task_fixture.h"

namespace longarm::session {
namespace {

using Eigen::Vector3d;
using nlohmann::json;

class ZoomTask : public ::testing::Test {
 protected:
  void open(bool cameras) {
    LONGARM_SKIP_WITHOUT_VIRTUAL_ROBOT();
    m_cell = std::make_shared<const planning::Workcell>(testing::builtInWorkcell("ptz"));
    RuntimeOptions options;
    options.variant = "ptz";
    options.ideal = true;
    options.cameras = cameras;
    options.stream_cameras = false;
    m_runtime = testing::robotInLockstep(m_cell, options);
    ASSERT_NE(m_runtime, nullptr);
    step(0.5);
  }
  void step(double seconds) { ASSERT_TRUE(m_runtime->step(seconds).ok()); }
  std::optional<double> zoom(const std::string& camera) const {
    const auto told = m_runtime->zoomAt(camera, m_runtime->clock().now_s());
    EXPECT_TRUE(told.ok()) << told.error().message;
    return told ? *told : std::nullopt;
  }
  Result<vision::View> view(const std::string& camera) const {
    return cameraView(*m_cell, camera, *m_runtime->jointState(), zoom(camera));
  }
  json truth() const { return testing::truthOf(*m_runtime); }
  Vector3d tool() const {
    return m_cell->model->forward(*m_runtime->configuration(), *m_cell->model->linkIndex(m_cell->arm.tip_link)).translation();
  }
  static Vector3d placeOf(const json& links, const std::string& link) {
    const auto& xyz = links.at(link).at("xyz");
    return {xyz[0].get<double>(), xyz[1].get<double>(), xyz[2].get<double>()};
  }

  std::shared_ptr<const planning::Workcell> m_cell;
  std::unique_ptr<RobotRuntime> m_runtime;
};

TEST_F(ZoomTask, TheConsoleKnowsTheLensAtEverySetting) {
  open(false);
  if (!m_runtime) return;
  double last = 0;
  for (const double wanted : {0.0, 0.33, 0.8, 0.9, 1.0}) {
    ASSERT_TRUE(m_runtime->setZoom("ptz_left", wanted).ok());
    step(2.5);
    ASSERT_TRUE(zoom("ptz_left").has_value());
    EXPECT_NEAR(*zoom("ptz_left"), wanted, 1e-6);
    const auto now = view("ptz_left");
    ASSERT_TRUE(now.ok()) << now.error().message;
    EXPECT_GT(now->camera.fx, last);
    last = now->camera.fx;
    EXPECT_NEAR((now->X_WC.translation() - placeOf(truth().at("links"), "ptz_left_optical")).norm(), 0, 1e-6) << wanted;
  }
  EXPECT_NEAR(last, 2 * 5944.8, 1) << "eightfold by the lens, twofold by enlargement";
  EXPECT_EQ(view("ptz_right")->camera.fx, 738.3) << "the other camera's is its own";
  EXPECT_FALSE(zoom("wrist").has_value());
}

TEST_F(ZoomTask, StopHoldsTheZoom) {
  open(false);
  if (!m_runtime) return;
  ASSERT_TRUE(m_runtime->setZoom("ptz_left", 1).ok());
  step(0.6);
  m_runtime->stop("test", "stop");
  step(0.3);
  const double there = *zoom("ptz_left");
  EXPECT_GT(there, 0.1);
  EXPECT_LT(there, 0.6);
  step(1);
  EXPECT_NEAR(*zoom("ptz_left"), there, 1e-6);
}

// A picture belongs to the lens at its own exposure, also while the lens turns.
TEST_F(ZoomTask, SnapshotsKeepTheLensTheyWereTakenWith) {
  open(true);
  if (!m_runtime) return;
  ASSERT_TRUE(m_runtime->streamCamera("ptz_left", true).ok());
  const auto take = [&]() -> Result<vision::Snapshot> {
    const auto before = m_runtime->cameraFrame("ptz_left");
    for (int i = 0; i < 100; ++i) {
      if (auto stepped = m_runtime->step(0.1); !stepped) return stepped.error();
      const auto frame = m_runtime->cameraFrame("ptz_left");
      if (!frame || frame == before) continue;
      const auto state = m_runtime->jointStateAt(frame->stamp_s);
      const auto zoom = m_runtime->zoomAt("ptz_left", frame->stamp_s);
      if (state && zoom) return makeSnapshot(*m_cell, {frame, *state, *zoom});
    }
    return Error{ErrorCode::kTimeout, "no picture"};
  };
  const auto wide = take();
  if (!wide && wide.error().code == ErrorCode::kTimeout) GTEST_SKIP() << "this machine cannot render";
  ASSERT_TRUE(wide.ok()) << wide.error().message;
  EXPECT_EQ(wide->view.camera.width, 640);
  ASSERT_TRUE(m_runtime->setZoom("ptz_left", 0.5).ok());
  step(2);
  const auto narrow = take();
  ASSERT_TRUE(narrow.ok()) << narrow.error().message;
  EXPECT_EQ(*wide->view.zoom, 0);
  EXPECT_NEAR(*narrow->view.zoom, 0.5, 1e-6);
  EXPECT_EQ(wide->view.camera.fx, 743.1);
  EXPECT_NEAR(narrow->view.camera.fx, 3058.717, 0.01);
}

// Grab Pipe with the heads zoomed in on where the hand begins: it would leave their pictures, and does not.
TEST_F(ZoomTask, TheToolStaysInThePictureWhileItMoves) {
  open(false);
  if (!m_runtime) return;
  auto scenario = planning::loadScenario("grab_pipe");
  ASSERT_TRUE(scenario.ok());
  const auto world = planning::randomised(*scenario, 1);
  const auto* pipe = world.object("pipe");
  const double half = std::get<planning::Cylinder>(pipe->body.shape).length / 2;
  vision::Feature line;
  line.kind = vision::FeatureKind::kLine;
  for (const double end : {-half, half}) {
    vision::FeatureVertex vertex;
    vertex.xyz = pipe->body.X_WO * Vector3d(0, 0, end);
    vertex.covariance = 1e-6 * Eigen::Matrix3d::Identity();
    line.vertices.push_back(vertex);
  }
  ASSERT_TRUE(m_runtime->setGripper(m_cell->gripper->open).ok());
  step(1.5);
  RuntimeFeed feed(*m_runtime);
  for (const char* camera : {"ptz_left", "ptz_right"}) {
    const auto framed = frame(*m_cell, *m_cell->camera(camera), {tool(), tool() + Vector3d(0, 0, 0.1)},
                              *m_runtime->jointState(), zoom(camera), {0.5, true});
    ASSERT_TRUE(framed.ok()) << framed.error().message;
    ASSERT_TRUE(m_runtime->movePanTilt(camera, framed->angles.pan, framed->angles.tilt).ok());
    ASSERT_TRUE(m_runtime->setZoom(camera, *framed->zoom).ok());
  }
  step(3);
  const auto still = std::map<std::string, vision::View>{{"ptz_left", *view("ptz_left")}, {"ptz_right", *view("ptz_right")}};
  planning::PlanContext context;
  context.workcell = m_cell.get();
  context.start = *m_runtime->configuration();
  const auto macros = planning::makeMacros(*m_cell);
  const auto plan = planning::findMacro(macros, "grab_pipe")->plan(context, &line);
  ASSERT_TRUE(plan.ok()) << plan.reason;
  ASSERT_TRUE(m_runtime->load(plan.trajectory).ok());
  ASSERT_TRUE(m_runtime->play().ok());
  WatchController watch;
  watch.setFeed(&feed);
  watch.setWorkcell(m_cell);
  watch.setTarget({line.vertices[0].xyz, line.vertices[1].xyz});
  int seen = 0, looked = 0, lost_without = 0;
  for (int i = 0; i < 600 && m_runtime->status().player != planning::PlayerState::kDone; ++i) {
    step(0.1);
    const auto status = m_runtime->status();
    watch.refresh(status.moving, status.gate.stopped);
    for (const auto& [camera, view_then] : still) {
      ++looked;
      const auto now = view(camera);
      ASSERT_TRUE(now.ok()) << now.error().message;
      if (spread(*now, {tool()}) <= 1) ++seen;
      if (spread(view_then, {tool()}) > 1) ++lost_without;
    }
  }
  ASSERT_EQ(m_runtime->status().player, planning::PlayerState::kDone);
  EXPECT_GT(lost_without, looked / 10) << "heads that stand still would lose it";
  EXPECT_EQ(seen, looked);
  for (const auto& [camera, view_then] : still) {
    EXPECT_LT(spread(*view(camera), {tool(), line.vertices[0].xyz, line.vertices[1].xyz}), 1) << camera << ": the target is seen, too";
  }
}

}  // namespace
}  // namespace longarm::session
