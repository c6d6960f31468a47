#pragma once

/// @file
/// solvePixelsOfMany() for each generation of processors.  Internal to pair_kernel.

#include "vision/stereo/pair_kernel.h"

namespace longarm::vision::internal {

/// Whether pair_many_avx2.cpp and pair_many_avx512.cpp are compiled.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define LONGARM_WIDE_LANES
int solveManyAvx2(const CameraPair& pair, int n, const double* pixels_a, const double* pixels_b, double* points);
int solveManyAvx512(const CameraPair& pair, int n, const double* pixels_a, const double* pixels_b, double* points);
#endif

}  // namespace longarm::vision::internal
