#pragma once

/// @file
/// What the processor can do, for code that is compiled for more than one generation.

namespace longarm {

/// Whether code for wide registers is compiled: files named ..._avx2.cpp and ..._avx512.cpp.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define LONGARM_WIDE_LANES
#endif

/// Doubles that are worked at together: 2 anywhere, 4 with AVX2 and FMA, 8 with AVX-512.
enum class ProcessorLanes { kTwo, kFour, kEight };

/// Before a function that is compiled for whoever calls it, never by itself.
#define LONGARM_INLINE inline __attribute__((always_inline))

/// The widest that this processor and this build have.  Thread safe.
ProcessorLanes processorLanes();

/// Of one function compiled for two, four and eight lanes, the widest that runs here.
template <typename Function>
Function widestOf(Function two, Function four, Function eight) {
  switch (processorLanes()) {
    case ProcessorLanes::kEight: return eight;
    case ProcessorLanes::kFour: return four;
    case ProcessorLanes::kTwo: break;
  }
  return two;
}

}  // namespace longarm
