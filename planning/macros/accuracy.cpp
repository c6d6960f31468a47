#include "planning/macros/accuracy.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "core/text.h"

namespace longarm::planning {
namespace {

constexpr double kConfidence = 1.96;     // 95 % of a normal distribution, two-sided
constexpr double kHopeless = 3;          // times the need

std::string millimetres(double metres) { return formatFixed(metres * 1000, 1) + " mm"; }

}  // namespace

double uncertaintyOf(const std::vector<Eigen::Matrix3d>& covariances) {
  double worst = 0;
  for (const auto& C : covariances) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(C, Eigen::EigenvaluesOnly);
    worst = std::max(worst, solver.eigenvalues().maxCoeff());
  }
  return kConfidence * std::sqrt(worst);
}

double uncertaintyOf(const vision::Feature& feature) {
  std::vector<Eigen::Matrix3d> covariances;
  for (const auto& vertex : feature.vertices) covariances.push_back(vertex.covariance);
  return uncertaintyOf(covariances);
}

AccuracyVerdict judgeAccuracy(double uncertainty, double need) {
  AccuracyVerdict verdict;
  verdict.go = uncertainty <= need ? "go" : uncertainty <= kHopeless * need ? "ask" : "no_go";
  if (uncertainty == 0) verdict.note = "The feature states no uncertainty.";
  if (uncertainty <= need) return verdict;
  verdict.note = "The feature is known to " + millimetres(uncertainty) + " (95 %), this needs " + millimetres(need) +
                 (verdict.go == "ask" ? ": measure again from nearer or with a wider baseline, or go on with care."
                                      : ": measure again from nearer or with a wider baseline.");
  return verdict;
}

}  // namespace longarm::planning
