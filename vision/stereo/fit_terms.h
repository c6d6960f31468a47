#pragma once

/// @file
/// Picks as rows of a fit: a pick shows a point, or lies somewhere on the line through two points.

#include <vector>

#include <Eigen/Core>

#include "core/result.h"
#include "vision/stereo/fit.h"
#include "vision/stereo/triangulate.h"

namespace longarm::vision::internal {

/// One pick of a shape that is made of points.
struct FitTerm {
  Sighting pick;
  int point = 0;                ///< The point that the pick shows, or the first of the line it lies on.
  int other = -1;               ///< The line's second point; -1: the pick shows `point`.

  int rowCount() const { return other < 0 ? 2 : 1; }
};

/// Checks what every fit needs: views given and sharing one parent, finite picks with a ray, positive noise.
/// @returns kInvalidInput naming view and value.
Status checkTerms(const std::vector<FitTerm>& terms);

/// Rows of the picks for the given points.
/// @param points    (3 x k) in the parent frame [m].
/// @param d_points  (3k x n) derivative of the points by the state, points one below the other.
/// @returns kDegenerate when a point is behind a camera; the message names the view.  @pre checkTerms().
Result<FitRows> rowsOfTerms(const std::vector<FitTerm>& terms, const Eigen::Matrix3Xd& points,
                            const Eigen::MatrixXd& d_points);

/// The pick's own noise, or its view's [px].
double sigmaOf(const Sighting& pick);
std::string labelOf(const View& view);

}  // namespace longarm::vision::internal
