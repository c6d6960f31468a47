#pragma once

/// @file
/// The arithmetic from a pair of clicks to a 3-D point, on plain numbers: both cameras in two lanes.

namespace longarm::vision::internal {

constexpr int kInverseTerms = 6;

/// Two cameras side by side, index 0 and 1, prepared once.
struct CameraPair {
  double cx[2], cy[2], skew[2], fx[2], fy[2], inverse_fx[2], inverse_fy[2];
  double k1[2], k2[2], p1[2], p2[2], k3[2];
  double inverse_radial[2][kInverseTerms];   ///< Of the radial part: r (1 + s[0] r^2 + s[1] r^4 + ...).
  double max_radius2[2];
  double weight[2];                      ///< 1 / sigma_px^2
  double noise_x[2], noise_y[2], noise_skew[2];    ///< sigma_px / fx, sigma_px / fy, sigma_px skew / (fx fy)
  double axis_x[2][3], axis_y[2][3], axis_z[2][3];   ///< Axes of the cameras, in the parent frame.
  double centre[3];                      ///< Of the first camera, in the parent frame [m].
  double baseline[3];                    ///< From the first camera's centre to the second's, in the parent frame [m].
  double rotation[3][3], shift[3];       ///< From the second camera's frame to the first's, in the first's [m].
  double min_sine2;                      ///< Of the least angle between the rays.
};

/// What comes out, in the parent frame; the point is seen from the first camera's centre.
struct PairSolution {
  double p[3];
  double xx, xy, xz, yy, yz, zz;         ///< Covariance [m^2].
  double gap;                            ///< Between the rays [m].
  double sine, cosine;                   ///< Of the angle between the rays, times one common factor.
};

enum class PairAnswer {
  kLocated,
  kRefused,          ///< Rays too parallel, or they meet behind a camera.
  kLensUnsettled     ///< The quick lens inversion did not settle: invert each and use solveRays().
};

/// From raw pixels u, v of both cameras.
PairAnswer solvePixels(const CameraPair& pair, const double u[2], const double v[2], PairSolution* out);
/// The second half: from ideal coordinates and the lens' derivative there (symmetric xx, xy, yy).
PairAnswer solveRays(const CameraPair& pair, const double x[2], const double y[2], const double d_xx[2],
                     const double d_xy[2], const double d_yy[2], PairSolution* out);

/// Pairs that are worked at together.
constexpr int kPairLanes = 8;
/// Many pairs, as many at once as the processor holds.
/// @param n of pairs, a multiple of kPairLanes
/// @param pixels_a, pixels_b 2 n numbers each: u v u v ... [px]
/// @param[out] points 3 n numbers: x y z x y z ... in the parent frame [m]; NaN where solvePixels() would not answer kLocated
/// @returns how many were located
int solvePixelsOfMany(const CameraPair& pair, int n, const double* pixels_a, const double* pixels_b, double* points);

}  // namespace longarm::vision::internal
