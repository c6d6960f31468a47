#include "core/processor.h"

namespace longarm {

ProcessorLanes processorLanes() {
#ifdef LONGARM_WIDE_LANES
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512cd")) {
    return ProcessorLanes::kEight;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2")) return ProcessorLanes::kFour;
#endif
  return ProcessorLanes::kTwo;
}

}  // namespace longarm
