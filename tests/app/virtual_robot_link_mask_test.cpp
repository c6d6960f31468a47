// The predicted picture of the robot's own links against what is rendered, and against rays.
#include <limits>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "app/virtual_robot/camera_rig.h"
#include "planning/robot/link_mask.h"
#include "planning/world/shape_rays.h"
#include "tests/app/virtual_robot_rig.h"
#include "widgets/scene/lens_warp.h"
#include "widgets/scene/offscreen_renderer.h"
#include "widgets/scene/robot_rep.h"

namespace longarm::virtual_robot {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kCell = 4;

/// The built-in robot in some of its poses, and its cameras there.
struct Posed {
  const planning::Workcell& workcell;
  Eigen::VectorXd q;
  std::vector<Pose> X_RL;

  Posed(const planning::Workcell& cell, const std::string& pose, double pan, double tilt) : workcell(cell), q(cell.model->neutral()) {
    for (const auto& [joint, value] : cell.poses.at(pose)) set(joint, value);
    for (const auto& head : cell.pan_tilts) {
      set(head.pan_joint, pan);
      set(head.tilt_joint, tilt);
    }
    cell.model->forward(q, X_RL);
  }
  void set(const std::string& joint, double value) {
    const auto& names = workcell.model->actuatedNames();
    const auto found = std::find(names.begin(), names.end(), joint);
    if (found != names.end()) q(found - names.begin()) = value;
  }
  vision::View view(const planning::CameraSpec& camera) const {
    vision::View view;
    view.name = camera.name;
    view.camera = CameraRig::load(workcell)->lens(camera.name);
    view.X_WC = X_RL[static_cast<std::size_t>(*workcell.model->linkIndex(camera.link))];
    return view;
  }
};

std::vector<Posed> poses() {
  std::vector<Posed> all;
  for (const char* variant : {"", "ptz"}) {
    for (const char* pose : {"home", "ready", "stow"}) {
      all.emplace_back(builtIn(variant), pose, 0.1, 0.5);
      all.emplace_back(builtIn(variant), pose, -0.3, 0.9);
    }
  }
  return all;
}

/// 255 where the robot alone, before a black background, is seen.
class Silhouette {
 public:
  Silhouette() {
    scene::OffscreenOptions options;
    options.width = 768;
    options.height = 576;
    options.samples = 0;
    options.background = options.background_top = Vector3d::Zero();
    auto made = scene::OffscreenRenderer::create(options);
    EXPECT_TRUE(made.ok()) << made.error().message;
    m_renderer = std::move(*made);
  }
  cv::Mat of(const Posed& posed, const vision::View& view) {
    scene::RobotLook look;
    look.tint = Vector3d(1, 1, 1);
    scene::RobotRep robot(posed.workcell.model, look);
    robot.addTo(m_renderer->renderer());
    robot.update(posed.X_RL);
    const auto warp = scene::LensWarp::make(view.camera, 768, 576);
    EXPECT_TRUE(warp.ok());
    m_renderer->lookFrom(view.X_WC, warp->pinhole());
    cv::Mat grey, seen = warp->apply(m_renderer->render());
    cv::cvtColor(seen, grey, cv::COLOR_BGR2GRAY);
    return grey > 8;
  }

 private:
  std::unique_ptr<scene::OffscreenRenderer> m_renderer;
};

TEST(LinkMask, CoversWhatIsRenderedAndNothingElse) {
  Silhouette silhouette;
  int checked = 0, seen_cells = 0, wrong = 0;
  for (const Posed& posed : poses()) {
    const planning::LinkSilhouettes model(posed.workcell.model);
    for (const auto& camera : posed.workcell.cameras) {
      const vision::View view = posed.view(camera);
      const auto mask = model.maskOf(posed.q, view, kCell);
      ASSERT_TRUE(mask.ok()) << mask.error().message;
      const cv::Mat truth = silhouette.of(posed, view);
      for (int row = 1; row + 1 < mask->rows; ++row) {
        for (int column = 1; column + 1 < mask->columns; ++column) {
          // A cell that an edge runs through, or passes next to, may be either.
          const cv::Mat around = truth(cv::Rect(kCell * column - kCell / 2, kCell * row - kCell / 2, 2 * kCell, 2 * kCell));
          const int drawn = cv::countNonZero(around);
          if (drawn != 0 && drawn != around.rows * around.cols) continue;
          const bool covered = mask->links[static_cast<std::size_t>(row * mask->columns + column)] >= 0;
          ++checked;
          seen_cells += drawn != 0 ? 1 : 0;
          wrong += covered != (drawn != 0) ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(checked, 300000);
  EXPECT_GT(seen_cells, 10000) << "the robot is seen at all";
  EXPECT_LT(wrong, 1e-4 * checked) << wrong << " of " << checked;
}

TEST(LinkMask, NamesTheLinkAndDepthThatARayMeetsFirst) {
  int checked = 0, other = 0;
  for (const Posed& posed : poses()) {
    const planning::LinkSilhouettes model(posed.workcell.model);
    for (const auto& camera : posed.workcell.cameras) {
      const vision::View view = posed.view(camera);
      const auto mask = model.maskOf(posed.q, view, kCell);
      ASSERT_TRUE(mask.ok());
      for (int cell = 7; cell < mask->columns * mask->rows; cell += 61) {
        const int link = mask->links[static_cast<std::size_t>(cell)];
        if (link < 0) continue;
        const Vector2d pixel(kCell * (cell % mask->columns) + 1.5, kCell * (cell / mask->columns) + 1.5);
        EXPECT_EQ(mask->linkAt(pixel), link);
        const Vector3d ray = *view.camera.rayOfPixel(pixel);
        double nearest = std::numeric_limits<double>::infinity(), own = nearest;
        for (std::size_t i = 0; i < posed.X_RL.size(); ++i) {
          for (const auto& shape : posed.workcell.model->links()[i].visuals) {
            const auto way = planning::rayDistance(shape.shape, posed.X_RL[i] * shape.X_LS, view.X_WC.translation(), view.X_WC.linear() * ray);
            if (!way || *way * ray.z() < 0.02) continue;
            nearest = std::min(nearest, *way * ray.z());
            if (static_cast<int>(i) == link) own = std::min(own, *way * ray.z());
          }
        }
        if (!std::isfinite(own)) continue;         // The cell's middle just misses what its sample met.
        ++checked;
        // Where links meet or lie behind one another the cell's sample and its middle may see two of them.
        const bool same = own - nearest < 0.01 && std::abs(mask->depthAt(pixel) - own) < 0.02 + 0.02 * own;
        other += same ? 0 : 1;
      }
    }
  }
  EXPECT_GT(checked, 1500);
  EXPECT_LT(other, 0.02 * checked);
}

TEST(LinkMask, SaysHowMuchOfAPlaceNearerLinksHide) {
  const Posed posed(builtIn(), "ready", 0, 0.6);
  const planning::LinkSilhouettes model(posed.workcell.model);
  const vision::View view = posed.view(posed.workcell.cameras.front());
  const auto mask = model.maskOf(posed.q, view);
  ASSERT_TRUE(mask.ok());
  int covered = -1, free = -1;
  for (int cell = 0; cell < mask->columns * mask->rows; ++cell) {
    const Vector2d pixel(4 * (cell % mask->columns) + 1.5, 4 * (cell / mask->columns) + 1.5);
    const double share = mask->coveredAbout(pixel, 16, 10);
    EXPECT_GE(share, 0);
    EXPECT_LE(share, 1);
    if (share == 1) covered = cell;
    if (share == 0) free = cell;
  }
  ASSERT_GE(covered, 0);
  ASSERT_GE(free, 0);
  const Vector2d hidden(4 * (covered % mask->columns) + 1.5, 4 * (covered / mask->columns) + 1.5);
  EXPECT_EQ(mask->coveredAbout(hidden, 16, 0.05), 0) << "what is nearer than the links is seen";
  EXPECT_EQ(mask->linkAt({-30, 5}), -1);
  EXPECT_EQ(mask->coveredAbout({-500, -500}, 16, 10), 0);
}

TEST(LinkMask, RefusesWhatItCannotPredict) {
  const Posed posed(builtIn(), "home", 0, 0);
  const planning::LinkSilhouettes model(posed.workcell.model);
  vision::View view = posed.view(posed.workcell.cameras.front());
  EXPECT_FALSE(model.maskOf(Eigen::VectorXd::Zero(1), view));
  view.parent = "map";
  EXPECT_NE(model.maskOf(posed.q, view).error().message.find("\"map\""), std::string::npos);
  view.parent = "base_link";
  view.camera.width = 0;
  EXPECT_FALSE(model.maskOf(posed.q, view));
}

}  // namespace
}  // namespace longarm::virtual_robot
