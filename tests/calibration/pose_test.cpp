// The transform loop: convention, convergence, honesty, observability, wrong labels.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "calibration/pose/global_start.h"
#include "calibration/pose/observations_file.h"
#include "calibration/pose/single_pose.h"
#include "calibration/pose/solve_loop.h"
#include "tests/calibration/synthetic.h"

namespace longarm::tests {
namespace {

using calibration::LoopOptions;
using calibration::LoopProblem;
using calibration::LoopResult;
using calibration::LoopUnknown;
using calibration::LoopView;
using calibration::PoseObservation;
using calibration::solveLoop;

const vision::CameraModel kCamera = cameraOf(800, 800, 320, 240);
const Pose kExt = poseOf({0.02, -0.03, 0.01}, {0.03, -0.02, 0.08});

enum class Motion { kNone, kPan, kPanTilt, kArm, kShift };

Pose motionOf(Motion motion, Random* random) {
  const double pan = random->uniform(-0.3, 0.3), tilt = random->uniform(-0.3, 0.3);
  Pose T = Pose::Identity();
  switch (motion) {
    case Motion::kNone: break;
    case Motion::kPan: T.linear() = expSO3({0, pan, 0}); break;
    case Motion::kPanTilt: T.linear() = expSO3({tilt, 0, 0}) * expSO3({0, pan, 0}); break;
    case Motion::kArm: T = poseOf(random->vector(0.2), random->vector(0.1)); break;
    case Motion::kShift: T.translation() = random->vector(0.1); break;
  }
  return T;
}

// A loop with all transforms known: object 2 m in front of the camera at rest, `count` of its points in each view.
LoopProblem loop(Random* random, Motion motion, int views, int count, double noise, bool same_point = false) {
  LoopProblem problem;
  problem.camera = kCamera;
  const Pose T_dev = poseOf({1.3, 0.2, 0.1}, {0.1, 0.3, 0.2});
  const Pose T_obj = (T_dev.inverse() * kExt.inverse() * poseOf({0.2, 0.1, 0.3}, {0, 0, 2})).inverse();
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 8; ++i) points.emplace_back(random->uniform(-0.3, 0.3), random->uniform(-0.2, 0.2), random->uniform(-0.2, 0.2));
  for (int k = 0; k < views; ++k) {
    LoopView view{"view" + std::to_string(k), motionOf(motion, random), kExt, T_dev, T_obj, {}};
    std::vector<int> order = {0, 1, 2, 3, 4, 5, 6, 7};
    if (!same_point) std::shuffle(order.begin(), order.end(), random->engine());
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d x = points[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])];
      const Eigen::Vector3d p = view.T_ext * (view.T_kin * (view.T_dev * (view.T_obj.inverse() * x)));
      view.points.push_back({x, pixelOf(kCamera, p) + Eigen::Vector2d(random->normal(noise), random->normal(noise)), 0});
    }
    problem.views.push_back(view);
  }
  return problem;
}

Pose truthOf(const LoopProblem& problem, LoopUnknown unknown) {
  const LoopView& view = problem.views.front();
  return unknown == LoopUnknown::kExt ? view.T_ext : unknown == LoopUnknown::kDev ? view.T_dev : view.T_obj;
}

// The problem without the unknown, so that nothing can be read off.
LoopProblem hidden(LoopProblem problem, const std::vector<LoopUnknown>& unknowns) {
  for (auto& view : problem.views) {
    for (const LoopUnknown u : unknowns) {
      if (u == LoopUnknown::kIntrinsics) continue;
      (u == LoopUnknown::kExt ? view.T_ext : u == LoopUnknown::kDev ? view.T_dev : view.T_obj) = Pose::Identity();
    }
  }
  if (std::count(unknowns.begin(), unknowns.end(), LoopUnknown::kIntrinsics) > 0) problem.camera.fx = problem.camera.fy = 1;
  return problem;
}

Result<LoopResult> solved(const LoopProblem& problem, std::vector<LoopUnknown> unknowns, std::optional<double> sigma = {}) {
  LoopOptions options;
  options.unknowns = unknowns;
  options.sigma_px = sigma;
  return solveLoop(hidden(problem, unknowns), options);
}

std::size_t indexOf(LoopUnknown u) { return u == LoopUnknown::kExt ? 0 : u == LoopUnknown::kDev ? 1 : 2; }

Vector6d errorOf(const Pose& found, const Pose& truth) {
  Vector6d e;
  e << logSO3(found.linear() * truth.linear().transpose()), found.translation() - truth.translation();
  return e;
}

TEST(TransformLoop, EachUnknownComesBackFromNothing) {
  Random random(51);
  const LoopProblem problem = loop(&random, Motion::kArm, 4, 4, 0);
  for (const LoopUnknown unknown : {LoopUnknown::kExt, LoopUnknown::kDev, LoopUnknown::kObj}) {
    const auto found = solved(problem, {unknown});
    ASSERT_TRUE(found.ok()) << toString(unknown) << found.error().message;
    EXPECT_LT(errorOf(found->T[indexOf(unknown)], truthOf(problem, unknown)).norm(), 1e-8) << toString(unknown);
    EXPECT_EQ(found->observability.size(), 6);
    EXPECT_LT(found->rms_px, 1e-8);
  }
}

TEST(TransformLoop, AnyTransformSwappedForItsInverseIsNoticed) {
  Random random(52);
  const LoopProblem problem = loop(&random, Motion::kArm, 4, 4, 0);
  for (int which = 0; which < 3; ++which) {
    LoopProblem wrong = problem;
    for (auto& view : wrong.views) {
      Pose& T = which == 0 ? view.T_kin : which == 1 ? view.T_dev : view.T_ext;
      T = T.inverse();
    }
    // Solving for a transform beside the wrong one may not absorb it, unless both stand together for all views.
    const LoopUnknown other = which == 1 ? LoopUnknown::kExt : LoopUnknown::kObj;
    const auto found = solved(wrong, {other});
    EXPECT_TRUE(!found.ok() || found->rms_px > 1e-3) << which;
  }
}

TEST(TransformLoop, IntrinsicsFromKnownTransforms) {
  Random random(53);
  LoopProblem problem = loop(&random, Motion::kPanTilt, 8, 8, 0);
  const auto found = solved(problem, {LoopUnknown::kIntrinsics});
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_LT((calibration::lensVector(found->camera) - calibration::lensVector(kCamera)).cwiseAbs().maxCoeff(), 1e-6);
}

// 12 points in 4 views of a pan-tilt, the true rotation of the unknown of a given angle.
std::vector<PoseObservation> panTiltObservations(Random* random, const Pose& truth, double lever, int views, int each, double noise) {
  std::vector<PoseObservation> out;
  const Pose mount = poseOf({0.02, -0.03, 0.01}, {lever * 0.3, -lever * 0.2, lever});
  for (int k = 0; k < views; ++k) {
    Pose A = Pose::Identity();
    A.linear() = mount.linear() * expSO3({random->uniform(-0.5, 0.5), 0, 0}) * expSO3({0, random->uniform(-0.5, 0.5), 0});
    A.translation() = mount.translation();
    for (int i = 0; i < each; ++i) {
      const double z = random->uniform(1, 3);
      const Eigen::Vector3d p(z * random->uniform(-0.35, 0.35), z * random->uniform(-0.25, 0.25), z);
      const Eigen::Vector2d pixel = pixelOf(kCamera, p) + Eigen::Vector2d(random->normal(noise), random->normal(noise));
      out.push_back({A, truth.inverse() * (A.inverse() * p), pixel, 1, k, i});
    }
  }
  return out;
}

TEST(SinglePose, ConvergesInSixIterationsAtAnyAttitude) {
  Random random(54);
  for (const double degrees : {1.0, 90.0, 133.0, 134.0, 179.0}) {
    for (int trial = 0; trial < 40; ++trial) {
      const Pose truth = poseOf(random.direction() * degrees * kDegree, {0.1, -0.05, 0.2});
      const auto observations = panTiltObservations(&random, truth, 0.08, 4, 3, 0);
      Vector6d off;
      off << random.direction() * 5 * kDegree, random.vector(0.02 / std::sqrt(3.0));
      const auto fit = calibration::refinePose(kCamera, observations, calibration::moved(truth, off));
      EXPECT_LE(fit.iterations, 6) << degrees;
      EXPECT_LT(errorOf(fit.T, truth).norm(), 1e-9) << degrees;
    }
  }
}

TEST(SinglePose, TwoHundredRandomPosesAreFoundFromNothing) {
  Random random(55);
  for (int trial = 0; trial < 200; ++trial) {
    Pose truth = Pose::Identity();
    truth.linear() = random.rotation();
    truth.translation() = random.vector();
    const auto observations = panTiltObservations(&random, truth, 0.08, 4, 3, 0.5);
    const auto found = calibration::findPoses(kCamera, observations);
    ASSERT_TRUE(found.ok()) << trial;
    EXPECT_LT(errorOf(found->front().T, truth).head<3>().norm(), 1.0 * kDegree) << trial;
  }
}

// Guess-free: n points of which the global minimum is missed if another pose's cost is lower than at the truth.
int misses(int trials, int n, unsigned seed) {
  Random random(seed);
  int missed = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Pose truth = Pose::Identity();
    truth.linear() = random.rotation();
    truth.translation() = random.vector();
    const auto observations = panTiltObservations(&random, truth, trial % 2 == 0 ? 0 : 0.08, n, 1, 0.5);
    const auto found = calibration::findPoses(kCamera, observations);
    const double at_truth = calibration::refinePose(kCamera, observations, truth).cost;
    if (!found || found->front().cost > at_truth + 1e-6 * (1 + at_truth)) ++missed;
  }
  return missed;
}

TEST(SinglePose, GuessFreeSearchMissesNothing) {
  EXPECT_EQ(misses(500, 5, 56), 0);
  EXPECT_EQ(misses(300, 20, 57), 0);
}
TEST(SinglePoseCampaign, GuessFreeSearchMissesNothingInTenThousand) {
  EXPECT_EQ(misses(10000, 5, 58), 0);
  EXPECT_EQ(misses(10000, 10, 59), 0);
  EXPECT_LE(misses(10000, 4, 60), 10);
}

TEST(SinglePose, AccuracyDoesNotDependOnTheLever) {
  Random random(61);
  for (const double lever : {0.0, 0.08, 0.30}) {
    std::vector<double> angles;
    for (int trial = 0; trial < 300; ++trial) {
      Pose truth = Pose::Identity();
      truth.linear() = random.rotation();
      const auto observations = panTiltObservations(&random, truth, lever, 6, 1, 0.5);
      const auto found = calibration::findPoses(kCamera, observations);
      ASSERT_TRUE(found.ok());
      angles.push_back(errorOf(found->front().T, truth).head<3>().norm() / kDegree);
    }
    std::sort(angles.begin(), angles.end());
    EXPECT_LT(angles[150], 0.12) << lever;
  }
}

// Mean of error^2 / variance per component over runs; sigma known to the solver or not.
void checkHonesty(int runs, std::optional<double> sigma, LoopUnknown unknown, double margin) {
  Random random(62);
  Vector6d nees = Vector6d::Zero();
  int counted = 0;
  for (int run = 0; run < runs; ++run) {
    const LoopProblem problem = loop(&random, Motion::kPanTilt, 4, 3, 0.5);
    const auto found = solved(problem, {unknown}, sigma);
    ASSERT_TRUE(found.ok()) << found.error().message;
    const Vector6d e = errorOf(found->T[indexOf(unknown)], truthOf(problem, unknown));
    nees += e.cwiseAbs2().cwiseQuotient(found->covariance.diagonal());
    ++counted;
  }
  nees /= counted;
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(nees[i], 1, margin) << toString(unknown) << i;
}

TEST(TransformLoop, CovarianceIsHonestInASample) {
  checkHonesty(300, 0.5, LoopUnknown::kExt, 0.3);
  checkHonesty(300, {}, LoopUnknown::kObj, 0.35);
}
TEST(TransformLoopCampaign, CovarianceIsHonestToTenPercent) {
  for (const LoopUnknown unknown : {LoopUnknown::kExt, LoopUnknown::kDev, LoopUnknown::kObj}) {
    checkHonesty(4000, 0.5, unknown, 0.1);
    checkHonesty(4000, {}, unknown, 0.1);
  }
}

// A drive camera 1.3 m behind the arm's base sees the gripper at n places about 2 m away; T_ext maps the base's
// frame into the camera's.
void rePose(int points, int runs, double max_degrees, double max_mm, unsigned seed) {
  Random random(seed);
  std::vector<double> degrees, mm;
  int converged = 0;
  for (int run = 0; run < runs; ++run) {
    LoopProblem problem;
    problem.camera = kCamera;
    const Pose T_ext = poseOf(random.direction() * random.uniform(0, 3), Eigen::Vector3d(0, 0.2, 1.3) + random.vector(0.1));
    for (int i = 0; i < points; ++i) {
      const Eigen::Vector3d p(random.uniform(-0.65, 0.65), random.uniform(-0.5, 0.5), random.uniform(1.5, 2.5));
      LoopView view;
      view.name = std::to_string(i);
      view.points.push_back({T_ext.inverse() * p, pixelOf(kCamera, p) + Eigen::Vector2d(random.normal(0.5), random.normal(0.5)), 0});
      problem.views.push_back(view);
    }
    Vector6d off;
    off << random.direction() * 20 * kDegree, random.direction() * 0.06;
    const auto refined = calibration::refinePose(kCamera, calibration::observationsOf(problem, LoopUnknown::kExt), calibration::moved(T_ext, off));
    const auto found = solved(problem, {LoopUnknown::kExt});
    ASSERT_TRUE(found.ok()) << found.error().message;
    converged += errorOf(refined.T, found->T[0]).norm() < 1e-4 ? 1 : 0;
    const Vector6d e = errorOf(found->T[0], T_ext);
    degrees.push_back(e.head<3>().norm() / kDegree);
    mm.push_back(1e3 * e.tail<3>().norm());
  }
  std::sort(degrees.begin(), degrees.end());
  std::sort(mm.begin(), mm.end());
  EXPECT_LE(degrees[degrees.size() / 2], max_degrees);
  EXPECT_LE(mm[mm.size() / 2], max_mm);
  EXPECT_GE(converged, runs * 99 / 100);
  std::printf("re-pose from %d points: median %.3f deg, %.2f mm; %d of %d converge from 20 deg, 60 mm\n", points,
              degrees[degrees.size() / 2], mm[mm.size() / 2], converged, runs);
}

TEST(TransformLoop, RePosesADriveCameraFromTheGripper) {
  rePose(12, 200, 0.2, 2.5, 63);
  rePose(40, 200, 0.1, 1.2, 64);
}

// Rank by the message of the refusal, or full.
int rankOf(const Result<LoopResult>& result, int full) {
  if (result.ok()) return full;
  const std::string& text = result.error().message;
  const auto at = text.find("only ");
  return at == std::string::npos ? -1 : std::atoi(text.c_str() + at + 5);
}

// Solves from the truth, so that the rank and not the search is tested.
Result<LoopResult> fromTruth(const LoopProblem& problem, std::vector<LoopUnknown> unknowns) {
  LoopOptions options;
  options.unknowns = unknowns;
  for (const LoopUnknown u : unknowns) options.starts[indexOf(u)] = truthOf(problem, u);
  return solveLoop(problem, options);
}

TEST(Observability, RanksAreThoseOfTheTable) {
  Random random(65);
  EXPECT_TRUE(solved(loop(&random, Motion::kPanTilt, 6, 1, 0), {LoopUnknown::kDev}).ok()) << "different points, one per view";
  for (const LoopUnknown u : {LoopUnknown::kDev, LoopUnknown::kObj}) {
    EXPECT_EQ(rankOf(fromTruth(loop(&random, Motion::kArm, 10, 1, 0, true), {u}), 6), 3) << toString(u) << ": the same point in all views";
  }
  EXPECT_TRUE(solved(loop(&random, Motion::kPanTilt, 10, 1, 0, true), {LoopUnknown::kExt}).ok()) << "one fixed point, pan and tilt";
  EXPECT_TRUE(fromTruth(loop(&random, Motion::kPan, 10, 1, 0, true), {LoopUnknown::kExt}).ok()) << "one fixed point, pan only";
  using V = std::vector<LoopUnknown>;
  const V ext_obj = {LoopUnknown::kExt, LoopUnknown::kObj}, ext_dev = {LoopUnknown::kExt, LoopUnknown::kDev};
  EXPECT_TRUE(fromTruth(loop(&random, Motion::kPanTilt, 10, 8, 0), ext_obj).ok());
  EXPECT_EQ(rankOf(fromTruth(loop(&random, Motion::kPan, 10, 8, 0), ext_obj), 12), 10) << "pan only";
  EXPECT_EQ(rankOf(fromTruth(loop(&random, Motion::kShift, 10, 8, 0), ext_obj), 12), 9) << "pure translations";
  EXPECT_TRUE(fromTruth(loop(&random, Motion::kPanTilt, 10, 8, 0), ext_dev).ok());
  EXPECT_EQ(rankOf(fromTruth(loop(&random, Motion::kArm, 10, 8, 0), {LoopUnknown::kDev, LoopUnknown::kObj}), 12), 6);
  EXPECT_EQ(rankOf(fromTruth(loop(&random, Motion::kArm, 10, 8, 0), {LoopUnknown::kExt, LoopUnknown::kDev, LoopUnknown::kObj}), 18), 12);
}

TEST(Observability, CollinearPointsNameTheAxisOfTheFreeTurn) {
  Random random(66);
  LoopProblem problem;
  problem.camera = kCamera;
  LoopView view;
  const Pose T_ext = poseOf({0.1, 0.2, -0.1}, {0, 0, 0.5});
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d p(-0.2 + 0.08 * i, 0.1 - 0.05 * i, 2 + 0.1 * i);
    view.points.push_back({T_ext.inverse() * p, pixelOf(kCamera, p), 0});
  }
  problem.views.push_back(view);
  const auto found = solved(problem, {LoopUnknown::kExt});
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().code, ErrorCode::kDegenerate);
  EXPECT_EQ(rankOf(found, 6), 5) << found.error().message;
  EXPECT_NE(found.error().message.find("a turn about the axis"), std::string::npos) << found.error().message;
  // The line's direction (0.08, -0.05, 0.1), the largest component positive.
  EXPECT_NE(found.error().message.find("(0.58, -0.36, 0.73)"), std::string::npos) << found.error().message;
}

TEST(Observability, TheSamePointEverywhereLeavesTheTurnsFree) {
  Random random(67);
  const auto found = solved(loop(&random, Motion::kArm, 8, 1, 0.3, true), {LoopUnknown::kDev});
  ASSERT_FALSE(found.ok());
  EXPECT_NE(found.error().message.find("only 3 of 6"), std::string::npos) << found.error().message;
}

TEST(TransformLoop, ThreePointsHaveSeveralAnswersAndSaySo) {
  Random random(68);
  int ambiguous = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const LoopProblem problem = loop(&random, Motion::kNone, 1, 3, 0);
    const auto found = solved(problem, {LoopUnknown::kExt});
    if (!found.ok()) continue;
    bool hit = errorOf(found->T[0], kExt).norm() < 1e-5;
    for (const auto& a : found->alternatives) hit = hit || errorOf(a.T, kExt).norm() < 1e-5;
    EXPECT_TRUE(hit) << trial;
    ambiguous += found->alternatives.empty() ? 0 : 1;
  }
  EXPECT_GT(ambiguous, 5);
}

TEST(TransformLoop, ThirtyPercentOutliersAreLeftOut) {
  Random random(69);
  double clean = 0, robust = 0;
  for (int trial = 0; trial < 30; ++trial) {
    LoopProblem problem = loop(&random, Motion::kPanTilt, 5, 8, 0.5);
    const auto reference = solved(problem, {LoopUnknown::kExt});
    ASSERT_TRUE(reference.ok());
    int spoiled = 0;
    for (auto& view : problem.views) {
      for (auto& p : view.points) {
        if (spoiled < 12 && random.uniform(0, 1) < 0.4) {
          p.pixel += 50 * Eigen::Vector2d(random.normal(), random.normal()).normalized();
          ++spoiled;
        }
      }
    }
    const auto found = solved(problem, {LoopUnknown::kExt});
    ASSERT_TRUE(found.ok()) << found.error().message;
    const auto unused = std::count_if(found->observations.begin(), found->observations.end(), [](const auto& o) { return !o.used; });
    EXPECT_EQ(unused, spoiled);
    clean += errorOf(reference->T[0], kExt).head<3>().squaredNorm();
    robust += errorOf(found->T[0], kExt).head<3>().squaredNorm();
  }
  EXPECT_LT(std::sqrt(robust / clean), 1.2 * std::sqrt(40.0 / 28.0)) << "the points left over are 28 of 40";
}

TEST(TransformLoop, ShufflingViewsAndPointsChangesNothing) {
  Random random(70);
  LoopProblem problem = loop(&random, Motion::kArm, 6, 5, 0.5);
  const auto first = solved(problem, {LoopUnknown::kExt, LoopUnknown::kObj});
  ASSERT_TRUE(first.ok()) << first.error().message;
  for (int shuffle = 0; shuffle < 5; ++shuffle) {
    std::shuffle(problem.views.begin(), problem.views.end(), random.engine());
    for (auto& view : problem.views) std::shuffle(view.points.begin(), view.points.end(), random.engine());
    const auto again = solved(problem, {LoopUnknown::kExt, LoopUnknown::kObj});
    ASSERT_TRUE(again.ok());
    EXPECT_LT(errorOf(again->T[0], first->T[0]).norm(), 1e-6);
    EXPECT_LT(errorOf(again->T[2], first->T[2]).norm(), 1e-6);
  }
}

TEST(TransformLoop, SwappedLabelsAndMirrorsAreNamed) {
  Random random(71);
  for (const int each : {2, 8}) {
    LoopProblem problem = loop(&random, Motion::kPanTilt, 4, each, 0.3);
    std::swap(problem.views[1].points[0].pixel, problem.views[1].points[1].pixel);
    const auto found = solved(problem, {LoopUnknown::kExt});
    ASSERT_FALSE(found.ok()) << each;
    EXPECT_NE(found.error().message.find("view view1: points 1 and 2 look swapped"), std::string::npos) << found.error().message;
  }
  LoopProblem mirrored = loop(&random, Motion::kPanTilt, 4, 4, 0.3);
  for (auto& view : mirrored.views) {
    for (auto& p : view.points) p.pixel.y() = 479 - p.pixel.y();
  }
  const auto found = solved(mirrored, {LoopUnknown::kObj});
  ASSERT_FALSE(found.ok());
  EXPECT_NE(found.error().message.find("mirrored"), std::string::npos) << found.error().message;
}

// The hand-eye table: 35-corner board, 0.3 px, robot noise 0.5 mm / 0.05 degrees.
struct HandEye {
  LoopProblem problem;
  Pose T_ext;
};

HandEye handEye(Random* random, int poses) {
  HandEye out;
  out.problem.camera = kCamera;
  out.T_ext = poseOf(random->direction() * 0.3, {0.03, -0.05, 0.06});
  const Pose T_dev = poseOf({0, 0, 0.4 * random->uniform(-1, 1)}, {0.8, 0.1, 0});
  for (int k = 0; k < poses; ++k) {
    const double azimuth = 3.14 * random->uniform(-1, 1), elevation = random->uniform(0.35, 0.7), r = random->uniform(0.3, 0.5);
    const Eigen::Vector3d centre(r * std::sin(elevation) * std::cos(azimuth), r * std::sin(elevation) * std::sin(azimuth), r * std::cos(elevation));
    Pose X_board_camera = Pose::Identity();
    X_board_camera.translation() = centre;
    const Eigen::Vector3d z = (-centre + 0.03 * Eigen::Vector3d(random->uniform(-1, 1), random->uniform(-1, 1), 0)).normalized();
    X_board_camera.linear() = rotationWithZ(z) * expSO3({0, 0, random->uniform(-3, 3)});
    LoopView view;
    view.name = std::to_string(k);
    view.T_ext = out.T_ext;
    view.T_dev = T_dev;
    // T_ext T_kin T_dev = camera <- board
    view.T_kin = out.T_ext.inverse() * X_board_camera.inverse() * T_dev.inverse();
    for (const auto& p : board(7, 5, 0.025)) {
      const Eigen::Vector3d x = p - Eigen::Vector3d(0.075, 0.05, 0);
      view.points.push_back({x, pixelOf(kCamera, X_board_camera.inverse() * x) + Eigen::Vector2d(random->normal(0.3), random->normal(0.3)), 0});
    }
    Vector6d error;
    error << random->vector(0.05 * kDegree / std::sqrt(3.0)), random->vector(0.0005 / std::sqrt(3.0));
    view.T_kin = calibration::moved(view.T_kin, error);
    out.problem.views.push_back(view);
  }
  return out;
}

void checkHandEye(int poses, int runs, double max_mm) {
  Random random(72);
  double squares = 0, predicted = 0, chi2 = 0;
  for (int run = 0; run < runs; ++run) {
    const HandEye he = handEye(&random, poses);
    LoopOptions options;
    options.unknowns = {LoopUnknown::kExt, LoopUnknown::kDev};
    options.sigma_px = 0.3;
    options.kin_prior = calibration::KinPrior{0.05 * kDegree / std::sqrt(3.0), 0.0005 / std::sqrt(3.0)};
    const auto found = solveLoop(hidden(he.problem, options.unknowns), options);
    ASSERT_TRUE(found.ok()) << found.error().message;
    squares += (found->T[0].inverse().translation() - he.T_ext.inverse().translation()).squaredNorm() / runs;
    predicted += found->covariance.block<3, 3>(3, 3).trace() / runs;
    chi2 += found->reduced_chi2 / runs;
  }
  std::printf("hand-eye %d poses: %.2f mm rms, predicted %.2f mm, reduced chi2 %.3f\n", poses, 1e3 * std::sqrt(squares), 1e3 * std::sqrt(predicted), chi2);
  EXPECT_LE(1e3 * std::sqrt(squares), max_mm);
  EXPECT_NEAR(chi2, 1, 0.1);
}

TEST(TransformLoop, HandEyeWithRobotPrior) {
  checkHandEye(6, 60, 0.6);
  checkHandEye(12, 60, 0.35);
  checkHandEye(25, 20, 0.25);
}

TEST(GlobalStart, CubeRotationsAreTwentyFour) {
  ASSERT_EQ(calibration::cubeRotations().size(), 24u);
  for (const auto& R : calibration::cubeRotations()) EXPECT_NEAR(R.determinant(), 1, 1e-12);
}

}  // namespace
}  // namespace longarm::tests
