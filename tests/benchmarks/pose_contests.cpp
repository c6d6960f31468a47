// One unknown pose, refined and from nothing, against OpenCV and, where they are installed, Ceres and OpenGV.
#include <cmath>
#include <memory>

#include <benchmark/benchmark.h>
#include <opencv2/calib3d.hpp>

#ifdef LONGARM_HAS_CERES
#include <ceres/ceres.h>
#include <ceres/rotation.h>
#endif
#ifdef LONGARM_HAS_OPENGV
#include <opengv/absolute_pose/NoncentralAbsoluteAdapter.hpp>
#include <opengv/absolute_pose/methods.hpp>
#endif

#include "calibration/pose/single_pose.h"
#include "core/text.h"
#include "tests/benchmarks/gate.h"
#include "tests/calibration/synthetic.h"

namespace longarm::benchmarks {
namespace {

using calibration::PoseFit;
using calibration::PoseObservation;
using tests::Random;

constexpr int kProblems = 64, kAccuracyProblems = 10000;
constexpr double kNoise = 0.5;

// An object of 0.6 m at about 2 m, seen in `views` pictures of a camera swung on a pan-tilt.
struct Problem {
  std::vector<PoseObservation> observations;
  Pose truth, start;
};

vision::CameraModel camera() { return tests::cameraOf(800, 800, 320, 240); }

Problem makeProblem(Random* random, int n, int views) {
  while (true) {
    Problem out;
    out.truth = tests::poseOf({0, 0, 0}, {random->uniform(-0.1, 0.1), random->uniform(-0.1, 0.1), random->uniform(1.8, 2.2)});
    out.truth.linear() = random->rotation();
    std::vector<Pose> swing;
    for (int k = 0; k < views; ++k) {
      const double lever = views > 1 ? 0.3 : 0;
      swing.push_back(tests::poseOf({random->uniform(-0.08, 0.08), random->uniform(-0.1, 0.1), 0}, {random->uniform(-lever, lever), random->uniform(-lever, lever), 0}));
    }
    bool seen = true;
    for (int i = 0; i < n; ++i) {
      PoseObservation o;
      o.A = swing[static_cast<std::size_t>(i % views)];
      o.y = Eigen::Vector3d(random->uniform(-0.3, 0.3), random->uniform(-0.3, 0.3), random->uniform(-0.3, 0.3));
      o.view = i % views;
      o.point = i;
      const Eigen::Vector3d p = o.A * out.truth * o.y;
      seen = seen && p.z() > 0.5;
      if (!seen) break;
      o.pixel = tests::pixelOf(camera(), p) + Eigen::Vector2d(random->normal(kNoise), random->normal(kNoise));
      out.observations.push_back(o);
    }
    if (!seen) continue;
    out.start = out.truth;
    out.start.linear() = expSO3(10 * tests::kDegree * random->direction()) * out.truth.linear();
    out.start.translation() += 0.1 * random->direction();
    return out;
  }
}

using Problems = std::shared_ptr<std::vector<Problem>>;

Problems problems(int n, int views, unsigned seed, int count = kProblems) {
  Random random(seed);
  auto out = std::make_shared<std::vector<Problem>>();
  for (int i = 0; i < count; ++i) out->push_back(makeProblem(&random, n, views));
  return out;
}

double rmsOf(const Problem& problem, const Pose& T) {
  double sum = 0;
  for (const auto& o : problem.observations) sum += std::pow(calibration::missOf(camera(), o, T), 2);
  return std::sqrt(sum / static_cast<double>(problem.observations.size()));
}

template <typename Solve>
std::function<void()> overAll(const Problems& all, Solve solve) {
  auto next = std::make_shared<std::size_t>(0);
  return [all, solve, next] {
    benchmark::DoNotOptimize(solve((*all)[*next]));
    *next = (*next + 1) % all->size();
  };
}

Pose refineOurs(const Problem& p) { return calibration::refinePose(camera(), p.observations, p.start).T; }

template <typename Theirs>
Accuracy sameMisfit(const Problems& all, Theirs theirs, const char* peer) {
  double ours2 = 0, theirs2 = 0;
  for (const auto& problem : *all) {
    ours2 += std::pow(rmsOf(problem, refineOurs(problem)), 2);
    theirs2 += std::pow(rmsOf(problem, theirs(problem)), 2);
  }
  const double ratio = std::sqrt(ours2 / theirs2);
  return {ratio <= 1.01, "rms " + formatFixed(ratio, 4) + " of " + peer + "'s (limit 1.01)"};
}

template <typename Theirs>
Contest refineContest(const std::string& name, const std::string& peer, const Problems& all, Theirs theirs, double gate, double moonshot) {
  Contest contest{name, peer, overAll(all, refineOurs), overAll(all, theirs), gate, moonshot, false, {}};
  contest.accuracy = [all, theirs, peer] { return sameMisfit(all, theirs, peer.c_str()); };
  return contest;
}

Pose refineByOpenCv(const Problem& p) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const auto& o : p.observations) {
    points.emplace_back(o.y.x(), o.y.y(), o.y.z());
    pixels.emplace_back(o.pixel.x(), o.pixel.y());
  }
  const cv::Matx33d K(800, 0, 320, 0, 800, 240, 0, 0, 1);
  const Pose in_camera = p.observations.front().A * p.start;
  const Eigen::Vector3d turn = logSO3(in_camera.linear());
  cv::Mat rvec = (cv::Mat_<double>(3, 1) << turn.x(), turn.y(), turn.z());
  cv::Mat tvec = (cv::Mat_<double>(3, 1) << in_camera.translation().x(), in_camera.translation().y(), in_camera.translation().z());
  cv::solvePnPRefineLM(points, pixels, K, cv::noArray(), rvec, tvec);
  const Pose out = tests::poseOf({rvec.at<double>(0), rvec.at<double>(1), rvec.at<double>(2)}, {tvec.at<double>(0), tvec.at<double>(1), tvec.at<double>(2)});
  return p.observations.front().A.inverse() * out;
}

#ifdef LONGARM_HAS_CERES
struct PixelMiss {
  Pose A;
  Eigen::Vector3d y;
  Eigen::Vector2d pixel;
  template <typename T>
  bool operator()(const T* turn, const T* shift, T* residual) const {
    const T point[3] = {T(y.x()), T(y.y()), T(y.z())};
    T moved[3];
    ceres::AngleAxisRotatePoint(turn, point, moved);
    T c[3];
    for (int i = 0; i < 3; ++i) {
      c[i] = T(A.translation()[i]);
      for (int j = 0; j < 3; ++j) c[i] += T(A.linear()(i, j)) * (moved[j] + shift[j]);
    }
    residual[0] = T(pixel.x()) - (T(800) * c[0] / c[2] + T(320));
    residual[1] = T(pixel.y()) - (T(800) * c[1] / c[2] + T(240));
    return true;
  }
};

Pose refineByCeres(const Problem& p) {
  const Eigen::Vector3d start = logSO3(p.start.linear());
  double turn[3] = {start.x(), start.y(), start.z()};
  double shift[3] = {p.start.translation().x(), p.start.translation().y(), p.start.translation().z()};
  ceres::Problem problem;
  for (const auto& o : p.observations) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PixelMiss, 2, 3, 3>(new PixelMiss{o.A, o.y, o.pixel}), nullptr, turn, shift);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return tests::poseOf({turn[0], turn[1], turn[2]}, {shift[0], shift[1], shift[2]});
}
#endif

#ifdef LONGARM_HAS_OPENGV
// OpenGV works with rays of several cameras in one frame, and gives that frame in the points' one.
struct GvProblem {
  explicit GvProblem(const Problem& p) {
    for (const auto& o : p.observations) {
      const Pose X_VC = o.A.inverse();
      if (o.view == static_cast<int>(offsets.size())) {
        offsets.push_back(X_VC.translation());
        turns.push_back(X_VC.linear());
      }
      rays.push_back(Eigen::Vector3d((o.pixel.x() - 320) / 800, (o.pixel.y() - 240) / 800, 1).normalized());
      views.push_back(o.view);
      points.push_back(o.y);
    }
  }
  opengv::bearingVectors_t rays;
  std::vector<int> views;
  opengv::points_t points;
  opengv::translations_t offsets;
  opengv::rotations_t turns;
};

Pose fromGv(const opengv::transformation_t& X_WV) {
  Pose out = Pose::Identity();
  out.linear() = X_WV.leftCols<3>();
  out.translation() = X_WV.col(3);
  return out.inverse();
}

Pose refineByOpenGv(const Problem& p) {
  const GvProblem gv(p);
  opengv::absolute_pose::NoncentralAbsoluteAdapter adapter(gv.rays, gv.views, gv.points, gv.offsets, gv.turns);
  const Pose start = p.start.inverse();
  adapter.setR(start.linear());
  adapter.sett(start.translation());
  return fromGv(opengv::absolute_pose::optimize_nonlinear(adapter));
}

Pose findByOpenGv(const Problem& p) {
  const GvProblem gv(p);
  opengv::absolute_pose::NoncentralAbsoluteAdapter adapter(gv.rays, gv.views, gv.points, gv.offsets, gv.turns);
  const auto all = opengv::absolute_pose::upnp(adapter);
  Pose best = Pose::Identity();
  double least = 1e300;
  for (const auto& each : all) {
    const Pose T = fromGv(each);
    const double rms = rmsOf(p, T);
    if (!(rms < least)) continue;
    least = rms;
    best = T;
  }
  return best;
}
#endif

Pose findOurs(const Problem& p) {
  const auto found = calibration::findPoses(camera(), p.observations);
  return found && !found->empty() ? found->front().T : Pose::Identity();
}

// A miss: another minimum than the one beside the truth although that one fits better.
Accuracy guessFreeAccuracy(int n, int allowed) {
  Random random(static_cast<unsigned>(100 + n));
  int misses = 0;
  for (int i = 0; i < kAccuracyProblems; ++i) {
    const Problem p = makeProblem(&random, n, 4);
    const PoseFit best = calibration::refinePose(camera(), p.observations, p.truth);
    const double found = rmsOf(p, findOurs(p)), possible = std::sqrt(best.cost / n);
    if (!(found <= possible * 1.0001 + 1e-9)) ++misses;
  }
  return {misses <= allowed, std::to_string(misses) + " misses in " + std::to_string(kAccuracyProblems) + " (at most " + std::to_string(allowed) + ")"};
}

#ifdef LONGARM_HAS_OPENGV
Contest guessFreeContest(int n, int allowed) {
  const auto all = problems(n, 4, static_cast<unsigned>(50 + n));
  Contest contest{"npnp_free_" + std::to_string(n), "OpenGV upnp", overAll(all, findOurs), overAll(all, findByOpenGv), 2, 10, false, {}};
  contest.accuracy = [n, allowed] { return guessFreeAccuracy(n, allowed); };
  return contest;
}
#else
// Without the peer only the accuracy is left to judge.
Contest guessFreeContest(int n, int allowed) {
  Contest contest{"npnp_free_" + std::to_string(n), "none installed (OpenGV)", {}, {}, 1, 1, false, {}};
  contest.figures = [] { return std::pair(1.0, 1.0); };
  contest.unit = "";
  contest.accuracy = [n, allowed] { return guessFreeAccuracy(n, allowed); };
  return contest;
}
#endif

}  // namespace

std::vector<Contest> poseContests([[maybe_unused]] std::map<std::string, std::string>* skipped) {
  std::vector<Contest> out;
  for (const int n : {10, 50, 200}) {
    const std::string number = std::to_string(n);
    const auto central = problems(n, 1, static_cast<unsigned>(n)), swung = problems(n, 4, static_cast<unsigned>(n + 1));
    out.push_back(refineContest("pnp_refine_" + number, "OpenCV solvePnPRefineLM", central, refineByOpenCv, 5, 15));
#ifdef LONGARM_HAS_CERES
    out.push_back(refineContest("npnp_ceres_" + number, "Ceres, automatic derivatives, DENSE_QR", swung, refineByCeres, 6, 15));
#else
    (*skipped)["npnp_ceres_" + number] = "Ceres is not installed (libceres-dev)";
#endif
#ifdef LONGARM_HAS_OPENGV
    out.push_back(refineContest("npnp_opengv_" + number, "OpenGV optimize_nonlinear", swung, refineByOpenGv, 50, 150));
#else
    (*skipped)["npnp_opengv_" + number] = "OpenGV is not installed (libopengv-dev)";
#endif
  }
  for (const auto& [n, allowed] : {std::pair{4, 10}, {5, 0}, {10, 0}, {50, 0}}) out.push_back(guessFreeContest(n, allowed));
  return out;
}

}  // namespace longarm::benchmarks
