// Pictures of any camera at any state of arm and heads are views like others: they measure, as exactly as they say.
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "planning/world/workcell.h"
#include "session/controllers/snapshot_maker.h"
#include "session/document/document.h"
#include "session/tools/baseline_watch.h"

namespace longarm::session {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHolds95 = 7.814727903251179;   // chi-square of 3 degrees of freedom

const planning::Workcell& workcell(const std::string& variant = {}) {
  static const planning::Workcell plain = planning::loadBuiltInWorkcell().value(), ptz = planning::loadBuiltInWorkcell("ptz").value();
  return variant.empty() ? plain : ptz;
}

/// The robot in a named pose, some joints moved.
JointState stateOf(const planning::Workcell& cell, const std::string& pose, const std::map<std::string, double>& moved) {
  JointState state;
  state.names = cell.model->actuatedNames();
  state.positions = cell.model->neutral();
  const auto set = [&](const std::string& joint, double value, bool add) {
    const auto found = std::find(state.names.begin(), state.names.end(), joint);
    ASSERT_NE(found, state.names.end()) << joint;
    double& at = state.positions(found - state.names.begin());
    at = add ? at + value : value;
  };
  for (const auto& [joint, value] : cell.poses.at(pose)) set(joint, value, false);
  for (const auto& [joint, value] : moved) set(joint, value, true);
  return state;
}

/// What is off in the calibration, 1 sigma.
constexpr double kFocal_px = 2, kCentre_px = 1;

vision::View calibrated(vision::View view) {
  view.pose_covariance.setZero();
  view.intrinsics_covariance.setZero();
  view.intrinsics_covariance(0, 0) = view.intrinsics_covariance(1, 1) = kFocal_px * kFocal_px;
  view.intrinsics_covariance(3, 3) = view.intrinsics_covariance(4, 4) = kCentre_px * kCentre_px;
  return view;
}

struct Pair {
  vision::View a, b;
  Vector3d place;                          ///< Seen by both.
};

/// Two views and the place where their axes come nearest.
Pair pairOf(const planning::Workcell& cell, const std::string& first, const JointState& at_first, const std::string& second,
            const JointState& at_second) {
  const auto wide = [&cell](const std::string& camera) { return cell.camera(camera)->zooms ? std::optional<double>(0) : std::nullopt; };
  Pair pair{calibrated(cameraView(cell, first, at_first, wide(first)).value()),
            calibrated(cameraView(cell, second, at_second, wide(second)).value()), {}};
  pair.place = pair.a.X_WC * Vector3d(0.02, -0.015, baselineOf(pair.a, pair.b).depth_m);
  return pair;
}

bool seenByBoth(const Pair& pair) {
  const auto a = pair.a.project(pair.place), b = pair.b.project(pair.place);
  return a && b && pair.a.camera.containsPixel(*a, -40) && pair.b.camera.containsPixel(*b, -40);
}

/// One joint of the arm turned so that the wrist camera makes a pair with where it was.
Pair wristPair(const planning::Workcell& cell) {
  const JointState before = stateOf(cell, "ready", {});
  for (const auto& joint : cell.armJointNames()) {
    for (const double turn : {0.1, -0.1, 0.2, -0.2, 0.3, -0.3}) {
      const Pair pair = pairOf(cell, "wrist", before, "wrist", stateOf(cell, "ready", {{joint, turn}}));
      if (seenByBoth(pair) && baselineWarning(pair.a, pair.b).empty()) return pair;
    }
  }
  ADD_FAILURE() << "no joint moves the wrist camera to the side";
  return {};
}

struct Found {
  double rms = 0, stated = 0, nees = 0, held = 0;
};

/// Sketches the place in both pictures of a document again and again, with pick noise and a calibration that is off: the same
/// for both pictures when they are of one camera.
Found repeat(const Pair& pair, int trials) {
  Document document;
  for (const std::uint64_t id : {1, 2}) {
    auto snapshot = std::make_shared<vision::Snapshot>();
    snapshot->id = {id};
    snapshot->view = id == 1 ? pair.a : pair.b;
    snapshot->image = cv::Mat(snapshot->view.camera.height, snapshot->view.camera.width, CV_8UC1, cv::Scalar(0));
    document.insertSnapshot(id - 1, snapshot);
  }
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  const auto off = [&](vision::View view, const std::array<double, 4>& by) {
    view.camera.fx += kFocal_px * by[0];
    view.camera.fy += kFocal_px * by[1];
    view.camera.cx += kCentre_px * by[2];
    view.camera.cy += kCentre_px * by[3];
    return view;
  };
  Found found;
  for (int trial = 0; trial < trials; ++trial) {
    const auto draw = [&] { return std::array<double, 4>{normal(random), normal(random), normal(random), normal(random)}; };
    const auto first = draw(), second = pair.a.name == pair.b.name ? first : draw();
    const vision::View a = off(pair.a, first), b = off(pair.b, second);
    SketchItem item;
    item.id = {1};
    item.name = "Point 1";
    const auto noisy = [&](const vision::View& view) {
      return Vector2d(view.project(pair.place).value() + view.sigma_px * Vector2d(normal(random), normal(random)));
    };
    item.setPick({1}, 0, {noisy(a), PickState::kFree});
    item.setPick({2}, 0, {noisy(b), PickState::kReleased});
    const Measurement measured = document.measure(item);
    EXPECT_TRUE(measured.feature) << measured.reason;
    if (!measured.feature) return found;
    const auto& vertex = measured.feature->vertices[0];
    const Vector3d error = vertex.xyz - pair.place;
    const double distance = error.dot(vertex.covariance.ldlt().solve(error));
    found.rms += error.squaredNorm() / trials;
    found.stated += vertex.covariance.trace() / trials;
    found.nees += distance / trials;
    found.held += distance < kHolds95 ? 1.0 / trials : 0;
  }
  found.rms = std::sqrt(found.rms);
  found.stated = std::sqrt(found.stated);
  return found;
}

void expectHonest(const Found& found) {
  EXPECT_NEAR(found.rms, found.stated, 0.08 * found.stated);
  EXPECT_NEAR(found.nees, 3, 0.3);
  EXPECT_GE(found.held, 0.93);
  EXPECT_LE(found.held, 0.97);
}

TEST(AnyViews, OneCameraMovedByTheArmMakesItsOwnStereo) {
  const Pair pair = wristPair(workcell());
  EXPECT_GT(baselineOf(pair.a, pair.b).distance_m, 0.03);
  expectHonest(repeat(pair, 2000));
}

TEST(AnyViews, OneCameraTurnedByItsHeadMeasuresLittleAndSaysSo) {
  const auto& cell = workcell();
  const std::string pan = cell.pan_tilts.front().pan_joint, tilt = cell.pan_tilts.front().tilt_joint;
  const JointState before = stateOf(cell, "stow", {{tilt, 0.4}}), after = stateOf(cell, "stow", {{tilt, 0.4}, {pan, 0.2}});
  const Pair turned = pairOf(cell, "head_left", before, "head_left", after), both = pairOf(cell, "head_left", before, "head_right", before);
  ASSERT_TRUE(seenByBoth(turned) && seenByBoth(both));
  const Found found = repeat(turned, 2000);
  expectHonest(found);
  EXPECT_GT(found.stated, 3 * repeat(both, 500).stated) << "the camera moves by 25 mm, the pair is 254 mm wide";
}

TEST(AnyViews, OneCameraLiftedByTheTorsoMakesAPair) {
  const auto& cell = workcell();
  const std::string tilt = cell.pan_tilts.front().tilt_joint;
  const JointState before = stateOf(cell, "stow", {{tilt, 0.5}}), after = stateOf(cell, "stow", {{tilt, 0.5}, {"torso_joint", 0.25}});
  const Pair pair = pairOf(cell, "head_left", before, "head_left", after);
  ASSERT_TRUE(seenByBoth(pair));
  EXPECT_TRUE(baselineWarning(pair.a, pair.b).empty()) << baselineWarning(pair.a, pair.b);
  expectHonest(repeat(pair, 2000));
}

TEST(AnyViews, TwoHeadsOnTheirOwnMakeAWidePair) {
  const auto& cell = workcell("ptz");
  const auto &left = cell.pan_tilts[0], &right = cell.pan_tilts[1];
  // Each at its own angles; both at the same place by looking at it.
  const JointState first = stateOf(cell, "stow", {{left.pan_joint, -0.2}, {left.tilt_joint, 0.35}});
  const JointState second = stateOf(cell, "stow", {{right.pan_joint, 0.18}, {right.tilt_joint, 0.33}});
  const Pair pair = pairOf(cell, cell.cameras[0].name, first, cell.cameras[1].name, second);
  ASSERT_TRUE(seenByBoth(pair));
  EXPECT_GT(baselineOf(pair.a, pair.b).distance_m, 0.3);
  EXPECT_TRUE(baselineWarning(pair.a, pair.b).empty()) << baselineWarning(pair.a, pair.b);
  const Found found = repeat(pair, 2000);
  expectHonest(found);
  const auto& head = workcell();
  const JointState ahead = stateOf(head, "stow", {{head.pan_tilts.front().tilt_joint, 0.35}});
  Pair narrow = pairOf(head, "head_left", ahead, "head_right", ahead);
  narrow.place = narrow.a.X_WC * Vector3d(0, 0, (pair.a.X_WC.inverse() * pair.place).z());
  EXPECT_LT(found.stated, repeat(narrow, 500).stated) << "wider than the fixed head";
}

TEST(AnyViews, AreFrozenWithTheStateOfTheirExposure) {
  const auto& cell = workcell();
  const JointState before = stateOf(cell, "ready", {}), after = stateOf(cell, "ready", {{"arm_1_joint", 0.3}});
  const auto a = cameraView(cell, "wrist", before).value(), b = cameraView(cell, "wrist", after).value();
  EXPECT_GT((a.X_WC.translation() - b.X_WC.translation()).norm(), 0.05);
  EXPECT_TRUE(a.X_WC.matrix() == cameraView(cell, "wrist", before)->X_WC.matrix());
}

}  // namespace
}  // namespace longarm::session
