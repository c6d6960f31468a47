#pragma once

/// @file
/// Which lens parameters the data can tell from zero.

#include <optional>
#include <vector>

#include "calibration/solve/arrow_solver.h"
#include "calibration/solve/lens_parameters.h"

namespace longarm::calibration {

/// What the caller fixed; the rest is chosen by significance.
struct LensChoice {
  std::optional<bool> skew;          ///< Estimate it or not.
  std::optional<int> distortion;     ///< 0, 2, 4 or 5 of k1 k2 p1 p2 k3.
  bool open_skew = false;            ///< Leaves the skew open even where `distortion` is fixed.
};

struct ChosenLens {
  LensMask mask;
  ArrowOutcome outcome;
};

namespace internal {

/// Parameters that are switched on together while their Wald statistic exceeds `threshold` (3 sigma).
struct LensGroup {
  std::vector<int> parameters;
  double threshold;
};
std::vector<LensGroup> openGroups(const LensChoice& choice);

/// Whether a group of this significance stays on.  Skew below 0.1 degree between the pixel axes must be beyond
/// 20 sigma: sensors have none, and boards that are not quite flat imitate it.
bool isKept(const LensGroup& group, double significance, const vision::CameraModel& camera);

/// v^T C^-1 v of a group at a model's optimum; 0 where the equations are singular.
/// @param offset Index of the first lens parameter among the shared ones.
double significance(ArrowModel* model, const vision::CameraModel& camera, const LensMask& mask, int offset,
                    const std::vector<int>& group, int degrees_of_freedom);

}  // namespace internal

/// Solves the model with the parameters asked for.  Those left open are switched on one group after the other (k1,
/// k2, p1 p2, skew; k3 never by itself) while they differ from zero by more than 3 sigma; a group that does not is
/// set back to zero.  Residuals below 0.001 px are never taken for significance.
/// @param model At its start, distortion and skew zero; has setMask(), camera(), lensOffset() and
///   degreesOfFreedom(), and is a value.  Ends at the optimum of the returned mask.
template <typename Model>
ChosenLens chooseLens(Model* model, const LensChoice& choice) {
  ChosenLens out;
  out.mask = LensMask::of(choice.skew.value_or(false), choice.distortion.value_or(0));
  model->setMask(out.mask);
  out.outcome = minimise(*model);
  // A second round: what drowned in a misfit that a later group explains.
  for (int round = 0; round < 2; ++round) {
    for (const auto& group : internal::openGroups(choice)) {
      if (out.mask.free[static_cast<std::size_t>(group.parameters.front())]) continue;
      const Model before = *model;
      LensMask wider = out.mask;
      for (const int p : group.parameters) wider.free[static_cast<std::size_t>(p)] = true;
      model->setMask(wider);
      const ArrowOutcome outcome = minimise(*model);
      const double found = internal::significance(model, model->camera(), wider, model->lensOffset(), group.parameters,
                                                  model->degreesOfFreedom());
      if (internal::isKept(group, found, model->camera())) {
        out.mask = wider;
        out.outcome = {outcome.cost, out.outcome.iterations + outcome.iterations, outcome.converged};
      } else {
        *model = before;
      }
    }
  }
  return out;
}

}  // namespace longarm::calibration
