#include "calibration/intrinsics/reject_outliers.h"

#include <algorithm>
#include <cmath>

#include "calibration/solve/robust.h"
#include "core/text.h"

namespace longarm::calibration {
namespace {

constexpr double kNoiseFloorPx = 0.02;   // no detector does better: residuals below are never outliers
constexpr double kViewRatio = 3.0;
constexpr double kCornerSigmas = 4.0;

using Residuals = std::vector<std::vector<Eigen::Vector2d>>;

bool isUsed(const std::vector<double>& weights) {
  return std::any_of(weights.begin(), weights.end(), [](double w) { return w > 0; });
}

std::vector<double> usedLengths(const Residuals& residuals, const IntrinsicsModel& model) {
  std::vector<double> lengths;
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    for (std::size_t i = 0; i < residuals[k].size(); ++i) {
      if (model.weights()[k][i] > 0) lengths.push_back(residuals[k][i].norm());
    }
  }
  return lengths;
}

// Huber's threshold depends on the noise and the noise on the fit: a few rounds settle both.
double solveRobustly(IntrinsicsModel* model) {
  double sigma = 0;
  for (int round = 0; round < 6; ++round) {
    minimise(*model);
    const double now = std::max(kNoiseFloorPx, sigmaFromLengths(usedLengths(model->residuals(), *model)));
    if (std::abs(now - sigma) < 0.02 * now) break;
    sigma = now;
    model->setHuber(1.5 * sigma);
  }
  return sigma;
}

double rmsOf(const std::vector<Eigen::Vector2d>& residuals) {
  double sum = 0;
  for (const auto& r : residuals) sum += r.squaredNorm();
  return std::sqrt(sum / (2.0 * static_cast<double>(std::max<std::size_t>(1, residuals.size()))));
}

// The view that stands out most, or -1.
int worstView(const IntrinsicsModel& model, const Residuals& residuals, double* rms, double* usual) {
  std::vector<double> all;
  int worst = -1;
  *rms = 0;
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    if (!isUsed(model.weights()[k])) continue;
    const double view_rms = rmsOf(residuals[k]);
    all.push_back(view_rms);
    if (view_rms > *rms) {
      *rms = view_rms;
      worst = static_cast<int>(k);
    }
  }
  *usual = std::max(kNoiseFloorPx, median(all));
  return all.size() >= 4 && *rms > kViewRatio * *usual ? worst : -1;
}

// Without its few worst corners a view may be as good as the others: then only those corners go.
bool isSpoiledByFewCorners(const std::vector<Eigen::Vector2d>& residuals, double usual) {
  std::vector<double> squares;
  for (const auto& r : residuals) squares.push_back(r.squaredNorm());
  std::sort(squares.begin(), squares.end());
  const std::size_t keep = squares.size() - squares.size() / 10;
  double sum = 0;
  for (std::size_t i = 0; i < keep; ++i) sum += squares[i];
  return keep < squares.size() && std::sqrt(sum / (2.0 * static_cast<double>(keep))) < 2 * usual;
}

void dropViews(IntrinsicsModel* model, std::vector<std::string>* why) {
  int used = 0;
  for (const auto& view : model->weights()) used += isUsed(view) ? 1 : 0;
  for (int dropped = 0; dropped < used / 3; ++dropped) {
    const Residuals residuals = model->residuals();
    double rms = 0, usual = 0;
    const int worst = worstView(*model, residuals, &rms, &usual);
    if (worst < 0 || isSpoiledByFewCorners(residuals[static_cast<std::size_t>(worst)], usual)) return;
    auto& weights = model->weights()[static_cast<std::size_t>(worst)];
    std::fill(weights.begin(), weights.end(), 0.0);
    (*why)[static_cast<std::size_t>(worst)] =
        "left out: its corners miss by " + formatFixed(rms, 2) + " px rms where the other views have " +
        formatFixed(usual, 2) + " px; the board was probably mis-detected, moved or blurred";
    solveRobustly(model);
  }
}

}  // namespace

void rejectOutliers(IntrinsicsModel* model, const std::vector<BoardView>& views, std::vector<std::string>* why) {
  solveRobustly(model);
  dropViews(model, why);
  for (int round = 0; round < 3; ++round) {
    const Residuals residuals = model->residuals();
    const double limit = kCornerSigmas * std::max(kNoiseFloorPx, sigmaFromLengths(usedLengths(residuals, *model)));
    bool changed = false;
    for (std::size_t k = 0; k < views.size(); ++k) {
      if (!isUsed(model->weights()[k])) continue;
      for (std::size_t i = 0; i < residuals[k].size(); ++i) {
        const double weight = residuals[k][i].cwiseAbs().maxCoeff() > limit ? 0 : 1;
        changed = changed || weight != model->weights()[k][i];
        model->weights()[k][i] = weight;
      }
    }
    model->setHuber(0);
    if (!changed) break;
    minimise(*model);
  }
  model->setHuber(0);
}

std::vector<std::string> swappedLabels(const IntrinsicsModel& model, const std::vector<BoardView>& views) {
  std::vector<std::string> out;
  const Residuals residuals = model.residuals();
  const double sigma = std::max(kNoiseFloorPx, sigmaFromLengths(usedLengths(residuals, model)));
  for (std::size_t k = 0; k < views.size(); ++k) {
    const auto& corners = views[k].corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (residuals[k][i].norm() < 8 * sigma) continue;
      const Eigen::Vector2d place_i = corners[i].pixel - residuals[k][i];
      for (std::size_t j = i + 1; j < corners.size(); ++j) {
        if (residuals[k][j].norm() < 8 * sigma) continue;
        const Eigen::Vector2d place_j = corners[j].pixel - residuals[k][j];
        const double own = residuals[k][i].norm() + residuals[k][j].norm();
        const double other = (corners[i].pixel - place_j).norm() + (corners[j].pixel - place_i).norm();
        if (other > 0.3 * own) continue;
        const auto name = [&](std::size_t at) {
          return corners[at].line > 0 ? "line " + std::to_string(corners[at].line) : "point " + std::to_string(at + 1);
        };
        out.push_back((views[k].name.empty() ? "" : "view " + views[k].name + ": ") + name(i) + " and " + name(j) +
                      " look swapped: each fits the other's pixel. Exchange their u,v");
      }
    }
  }
  return out;
}

}  // namespace longarm::calibration
