// The robot's own links in snapshots: tinted, told when a pick lands on one, and the clearest view proposed.
#include <gtest/gtest.h>

#include "planning/world/workcell.h"
#include "session/controllers/snapshot_maker.h"
#include "tests/ui/canvas_rig.h"
#include "ui/notice_bar.h"
#include "ui/sketch_edits.h"
#include "ui/sketch_watch.h"

namespace longarm::ui {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using session::ToolKind;
using tests::CanvasRig;
using vision::OverlayRole;
using vision::PaneSide;

constexpr PaneSide kLeft = PaneSide::kLeft, kRight = PaneSide::kRight;

/// The built-in robot's head in two poses of the arm: before the cameras, and out of the way.
struct RobotRig : CanvasRig {
  explicit RobotRig(double scale = 1) : CanvasRig(scale) {
    auto loaded = planning::loadBuiltInWorkcell();
    EXPECT_TRUE(loaded.ok());
    workcell = std::make_shared<const planning::Workcell>(std::move(*loaded));
    bench.setWorkcell(workcell);
    open(taken(1, "head_left", "ready"), taken(2, "head_right", "ready"));
  }
  JointState joints(const std::string& pose) const {
    JointState state;
    state.names = workcell->model->actuatedNames();
    state.positions = workcell->model->neutral();
    auto values = workcell->poses.at(pose);
    values[workcell->pan_tilts.front().tilt_joint] = 0.6;
    for (const auto& [joint, value] : values) {
      const auto found = std::find(state.names.begin(), state.names.end(), joint);
      if (found != state.names.end()) state.positions(found - state.names.begin()) = value;
    }
    return state;
  }
  vision::SnapshotPtr taken(std::uint64_t id, const std::string& camera, const std::string& pose) const {
    auto snapshot = std::make_shared<vision::Snapshot>();
    snapshot->id = {id};
    snapshot->robot_state = joints(pose);
    snapshot->view = session::cameraView(*workcell, camera, snapshot->robot_state).value();
    snapshot->image = cv::Mat(snapshot->view.camera.height, snapshot->view.camera.width, CV_8UC1, cv::Scalar(90));
    snapshot->source = "live";
    return snapshot;
  }
  /// A pixel well inside of a link, or well off all of them; and off them in another picture of the same camera.
  Vector2d pixelOn(PaneSide side, bool on_robot, const vision::SnapshotPtr& free = nullptr) {
    const auto links = targeting().ownLinks().of(document().paneSnapshot(side), workcell);
    const auto other = free ? targeting().ownLinks().of(free, workcell) : nullptr;
    const auto& mask = links->mask;
    for (int row = 6; row < mask.rows - 6; ++row) {
      for (int column = 6; column < mask.columns - 6; ++column) {
        const Vector2d pixel(mask.cell_px * column + 1.5, mask.cell_px * row + 1.5);
        if (other && other->mask.coveredAbout(pixel, 48, 100) > 0) continue;
        if (mask.coveredAbout(pixel, 20, 100) == (on_robot ? 1 : 0)) return pixel;
      }
    }
    ADD_FAILURE() << "no such place";
    return {};
  }
  int countRole(OverlayRole role) {
    int count = 0;
    for (const auto& shape : targeting().overlay(kLeft).shapes) count += shape.role == role ? 1 : 0;
    return count;
  }

  std::shared_ptr<const planning::Workcell> workcell;
};

TEST(OwnLinks, AreTintedInSnapshotsWhileThatIsSwitchedOn) {
  RobotRig rig;
  QWidget window;
  SketchEdits edits(rig.bench, rig.actions, &window);
  EXPECT_GT(rig.countRole(OverlayRole::kOwnLink), 0);
  for (const auto& shape : rig.targeting().overlay(kLeft).shapes) {
    if (shape.role != OverlayRole::kOwnLink) continue;
    EXPECT_EQ(shape.kind, vision::OverlayShape::Kind::kArea);
    for (const auto& point : shape.points) EXPECT_TRUE(rig.document().paneSnapshot(kLeft)->view.camera.containsPixel(point, 4));
  }
  rig.actions.at(ActionId::kOwnLinks)->trigger();
  EXPECT_EQ(rig.countRole(OverlayRole::kOwnLink), 0);
}

TEST(OwnLinks, ArePaintedWhereTheyAreAndNowhereElse) {
  RobotRig rig;
  const auto grey = [&](bool on_robot) {
    const QImage shot = rig.canvas(kLeft)->grab().toImage();
    const QPoint at = rig.on(kLeft, rig.pixelOn(kLeft, on_robot)).toPoint();
    int most = 0;
    for (int dy = -6; dy <= 6; ++dy) {
      for (int dx = -6; dx <= 6; ++dx) most = std::max(most, qGreen(shot.pixel(at + QPoint(dx, dy))));
    }
    return most;
  };
  EXPECT_NEAR(grey(false), 90, 2);
  EXPECT_GT(grey(true), 105) << "a hatch";
  rig.targeting().setOwnLinksShown(false);
  EXPECT_NEAR(grey(true), 90, 2);
}

TEST(OwnLinks, AreUnknownInPicturesFromFiles) {
  RobotRig rig;
  EXPECT_EQ(rig.targeting().ownLinks().of(tests::snapshotOf(9, rig.scene.left), rig.workcell), nullptr);
}

class PickOnLink : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Zooms, PickOnLink, ::testing::ValuesIn(tests::kZooms));

TEST_P(PickOnLink, IsToldAndTheClearestViewIsProposedAndShown) {
  RobotRig rig(GetParam());
  QWidget window;
  NoticeBar notices;
  SketchWatch watch(rig.bench, notices);
  SketchEdits edits(rig.bench, rig.actions, &window);
  const auto away = rig.taken(3, "head_left", "stow");
  const Vector2d on = rig.pixelOn(kLeft, true, away);
  const std::string link = rig.targeting().ownLinks().of(rig.document().paneSnapshot(kLeft), rig.workcell)->linkAt(on);
  rig.targeting().setTool(ToolKind::kPoint);
  rig.click(kLeft, rig.pixelOn(kLeft, false));
  EXPECT_FALSE(rig.targeting().hint().contains(QStringLiteral("robot's own")));
  EXPECT_FALSE(notices.has(QStringLiteral("own-link")));
  rig.targeting().undo();
  // The same scene with the arm away is in the library, too.
  rig.bench.history().push(session::addSnapshots(rig.bench.document(), {away}, kLeft));
  rig.targeting().showSnapshot(kLeft, SnapshotId{1});
  rig.targeting().setTool(ToolKind::kPoint);
  rig.click(kLeft, on);
  ASSERT_EQ(rig.document().items().size(), 1U);
  const std::string hint = rig.targeting().hint().toStdString();
  EXPECT_NE(hint.find("This is the robot's own " + link), std::string::npos) << hint;
  EXPECT_TRUE(notices.has(QStringLiteral("own-link")));
  EXPECT_GT(rig.countRole(OverlayRole::kWarning), 0) << "told in the picture, too";
  const auto advice = rig.bench.adviser().advise();
  ASSERT_TRUE(advice.ok()) << advice.error().message;
  EXPECT_EQ(advice->side, kLeft);
  EXPECT_EQ(advice->snapshot, SnapshotId{3}) << advice->text;
  EXPECT_NE(advice->text.find("hidden by the robot"), std::string::npos) << advice->text;
  rig.actions.at(ActionId::kClearestView)->trigger();
  EXPECT_EQ(rig.document().paneSnapshotId(kLeft), SnapshotId{3});
  EXPECT_FALSE(notices.has(QStringLiteral("own-link"))) << "gone with its cause";
}

TEST(ClearestView, PrefersTheUncoveredThenTheExact) {
  RobotRig rig;
  const vision::View kept = rig.scene.left;
  std::vector<session::ViewCandidate> candidates;
  for (const double y : {0.08, -0.127, -0.4}) candidates.push_back({{}, tests::viewAt("at " + std::to_string(y), {0, y, 1.0}, 0), nullptr});
  const Vector3d place(1.5, 0, 1.0);
  auto ranks = session::rankViews(place, kept, candidates);
  ASSERT_EQ(ranks.size(), 3U);
  EXPECT_EQ(ranks[0].candidate, 2U) << "the widest baseline";
  EXPECT_GT(ranks[0].parallax, ranks[1].parallax);
  auto covered = std::make_shared<planning::LinkMask>();
  covered->columns = tests::kWidth / 4;
  covered->rows = tests::kHeight / 4;
  covered->links.assign(static_cast<std::size_t>(covered->columns * covered->rows), 0);
  covered->depths.assign(covered->links.size(), 0.8F);
  candidates[2].mask = covered;
  ranks = session::rankViews(place, kept, candidates);
  EXPECT_EQ(ranks[0].candidate, 1U);
  EXPECT_EQ(ranks[2].candidate, 2U);
  EXPECT_DOUBLE_EQ(ranks[2].covered, 1);
  covered->depths.assign(covered->links.size(), 3.0F);
  EXPECT_EQ(session::rankViews(place, kept, candidates)[0].candidate, 2U) << "what stands behind the place hides nothing";
  candidates[2].view.X_WC.linear() = Eigen::AngleAxisd(3, Vector3d::UnitZ()) * candidates[2].view.X_WC.linear();
  EXPECT_EQ(session::rankViews(place, kept, candidates).size(), 2U) << "looks away";
}

}  // namespace
}  // namespace longarm::ui
