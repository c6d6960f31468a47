#pragma once

/// @file
/// The arithmetic from a pair of clicks to a 3-D point, on plain numbers: both cameras in two lanes.

namespace longarm::vision::internal {

/// Two cameras side by side, index 0 and 1, prepared once.
struct CameraPair {
  double cx[2], cy[2], skew[2], fx[2], fy[2], inverse_fx[2], inverse_fy[2];
  double k1[2], k2[2], p1[2], p2[2], k3[2];
  double s1[2], s2[2], s3[2];            ///< Series of the radial inverse: r (1 + s1 r^2 + s2 r^4 + s3 r^6).
  double max_radius2[2];
  double weight[2];                      ///< 1 / sigma_px^2
  double axis_x[2][3], axis_y[2][3], axis_z[2][3];   ///< Axes of the cameras, in the parent frame.
  double baseline[3];                    ///< From the first camera's centre to the second's, in the parent frame [m].
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

/// Raw pixels of many pairs, and where they are; each array holds n.
struct PairPixels {
  const double *u_a, *v_a, *u_b, *v_b;
};
struct PairPlaces {
  double *x, *y, *z;                     ///< Seen from the first camera's centre, in the parent frame [m].
  double* located;                       ///< 1, or 0 where solvePixels() would not answer kLocated.
};
/// Several at once, as wide as the processor is.  The arrays must not overlap.
void solvePixelsOfMany(const CameraPair& pair, int n, const PairPixels& in, const PairPlaces& out);

}  // namespace longarm::vision::internal
