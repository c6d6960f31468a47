#pragma once

/// @file
/// solvePixelsOfMany() for each generation of processors.  Internal to pair_kernel.

#include "core/processor.h"
#include "vision/stereo/pair_kernel.h"

namespace longarm::vision::internal {

#ifdef LONGARM_WIDE_LANES
int solveManyAvx2(const CameraPair& pair, int n, const double* pixels_a, const double* pixels_b, double* points);
int solveManyAvx512(const CameraPair& pair, int n, const double* pixels_a, const double* pixels_b, double* points);
#endif

}  // namespace longarm::vision::internal
