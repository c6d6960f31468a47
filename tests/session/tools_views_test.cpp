// Third pictures and poor pairs.
#include <random>

#include <gtest/gtest.h>

#include "session/tools/baseline_watch.h"
#include "session/tools/third_view.h"
#include "tests/session/synthetic_views.h"

namespace longarm::session {
namespace {

using tests::Bench;

/// A third picture from above the pair.
struct ThirdBench : Bench {
  ThirdBench() {
    third = tests::viewAt("mast", {0.1, 0.0, 1.3}, 0.0);
    history.push(addSnapshots(document, {tests::snapshotOf(3, third)}, PaneSide::kRight));
    history.push(showSnapshot(document, PaneSide::kRight, {2}));
    history.push(addItem(tests::trueLine(*this, 1)));
  }
  SketchItem withThird(const Eigen::Vector2d& off) const {
    SketchItem item = document.items()[0];
    item.setPick({3}, 0, {third.project(scene.a).value() + off, PickState::kReleased});
    return item;
  }
  vision::View third;
};

TEST(ThirdView, ShowsTwoCurvesThatCrossWhereTheOthersPutTheVertex) {
  ThirdBench bench;
  const Eigen::Vector2d truth = bench.third.project(bench.scene.a).value();
  const ThirdView view = thirdView(bench.document, bench.document.items()[0], 0, {3});
  ASSERT_EQ(view.curves.size(), 2U);
  for (const auto& curve : view.curves) EXPECT_LT((curve.nearest(truth)->pixel - truth).norm(), 0.05);
  ASSERT_TRUE(view.predicted);
  EXPECT_LT((*view.predicted - truth).norm(), 0.05);
  EXPECT_FALSE(view.off_sigmas);
  vision::Overlay overlay;
  addThirdView(bench.document, &bench.document.items()[0], 0, {3}, &overlay);
  int curves = 0;
  for (const auto& shape : overlay.shapes) curves += shape.role == vision::OverlayRole::kEpipolar ? 1 : 0;
  EXPECT_EQ(curves, 2);
}

TEST(ThirdView, FlagsAPickMoreThanThreeSigmaOffAndNoOther) {
  ThirdBench bench;
  bench.history.push(replaceItem(bench.document, bench.withThird({0.3, -0.2}), "third"));
  EXPECT_TRUE(thirdViewWarning(bench.document, {3}).empty()) << thirdViewWarning(bench.document, {3});
  bench.history.push(replaceItem(bench.document, bench.withThird({0, 9}), "third"));
  EXPECT_TRUE(thirdView(bench.document, bench.document.items()[0], 0, {3}).flagged());
  EXPECT_NE(thirdViewWarning(bench.document, {3}).find("'Line 1'"), std::string::npos);
}

TEST(ThirdView, StatesDistancesInSigmasThatNoisyPicksConfirm) {
  ThirdBench bench;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.5);
  const int trials = 1000;
  int beyond = 0;
  double squares = 0;
  for (int i = 0; i < trials; ++i) {
    SketchItem item = bench.withThird({noise(random), noise(random)});
    for (const auto& [id, view] : {std::pair<SnapshotId, const vision::View*>{{1}, &bench.scene.left}, {{2}, &bench.scene.right}}) {
      item.setPick(id, 0, {view->project(bench.scene.a).value() + Eigen::Vector2d(noise(random), noise(random)), PickState::kFree});
    }
    const double off = *thirdView(bench.document, item, 0, {3}).off_sigmas;
    squares += off * off / trials;
    beyond += off > kThirdViewSigmas ? 1 : 0;
  }
  EXPECT_NEAR(squares, 2, 0.25) << "two degrees of freedom";
  EXPECT_LT(beyond, 30) << "1.1 % are expected";
}

TEST(ThirdView, TakesAClickToTheVertexThatBelongsThere) {
  ThirdBench bench;
  const SketchItem& line = bench.document.items()[0];
  for (int vertex = 0; vertex < 2; ++vertex) {
    const Eigen::Vector2d at = bench.third.project(vertex == 0 ? bench.scene.a : bench.scene.b).value();
    EXPECT_EQ(nearestPredicted(bench.document, line, {3}, at + Eigen::Vector2d(4, 3)), vertex);
  }
}

TEST(BaselineWatch, IsSilentOverAGoodPairAndNamesWhatIsWrongWithABadOne) {
  tests::StereoScene scene;
  EXPECT_TRUE(baselineWarning(scene.left, scene.right).empty()) << baselineWarning(scene.left, scene.right);
  vision::View near = scene.left;
  near.name = "again";
  near.X_WC.translation().y() -= 0.004;
  EXPECT_NE(baselineWarning(scene.left, near).find("nothing can be measured"), std::string::npos);
  near.X_WC.translation().y() -= 0.012;
  EXPECT_EQ(baselineWarning(scene.left, near).rfind("Poor baseline", 0), 0U) << baselineWarning(scene.left, near);
  const vision::View away = tests::viewAt("away", {0, -0.127, 1.0}, 2.5);
  EXPECT_NE(baselineWarning(scene.left, away).find("hardly show the same place"), std::string::npos);
  vision::View elsewhere = scene.right;
  elsewhere.parent = "mast";
  EXPECT_NE(baselineWarning(scene.left, elsewhere).find("frame"), std::string::npos);
}

// Bouguet's head: 100 mm apart, toed in so little that the axes meet 7 m away, where nobody works.
TEST(BaselineWatch, IsSilentOverAHeadWhoseAxesMeetFarAway) {
  vision::View left;
  left.camera.fx = left.camera.fy = 533;
  left.camera.cx = 320;
  left.camera.cy = 240;
  left.camera.width = 640;
  left.camera.height = 480;
  vision::View right = left;
  right.X_WC.translation().x() = 0.1;
  right.X_WC.linear() = Eigen::AngleAxisd(-0.1 / 7, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_TRUE(baselineWarning(left, right).empty()) << baselineWarning(left, right);
}

TEST(BaselineWatch, StatesTheDepthErrorOfTheWorkedFigure) {
  // f 800 px, baseline 0.25 m, 0.5 px, 1.5 m: 7.95 mm.
  vision::View left;
  left.camera.fx = left.camera.fy = 800;
  left.camera.cx = 320;
  left.camera.cy = 240;
  left.camera.width = 640;
  left.camera.height = 480;
  vision::View right = left;
  right.X_WC.translation().x() = 0.25;
  EXPECT_NEAR(baselineOf(left, right).depth_sigma_m, 0.00795, 0.0002);
}

}  // namespace
}  // namespace longarm::session
