#pragma once

/// @file
/// LONGARM_PROCESSOR_CLONES before a function compiles it once for each generation of processors; the loader
/// takes the widest that fits.  Not under sanitizers, whose run time is not ready when the loader asks.

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define LONGARM_PROCESSOR_CLONES \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), optimize("O3")))
#else
#define LONGARM_PROCESSOR_CLONES
#endif
