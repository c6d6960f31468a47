#pragma once

/// @file
/// Numbers from a seed that are the same with every standard library.

#include <cmath>
#include <cstdint>
#include <random>

namespace longarm::virtual_robot {

/// Thread-compatible.
class SeededRandom {
 public:
  explicit SeededRandom(std::uint32_t seed) : m_engine(seed) {}

  std::uint32_t word() { return static_cast<std::uint32_t>(m_engine()); }
  /// Uniform in [a, b).
  double between(double a, double b) { return a + (b - a) * (static_cast<double>(m_engine()) / 4294967296.0); }
  /// Normal with mean 0 (Box and Muller, "A Note on the Generation of Random Normal Deviates", 1958).
  double normal(double sigma) {
    const double radius = std::sqrt(-2 * std::log(1 - between(0, 1)));
    return sigma * radius * std::cos(between(0, 2 * M_PI));
  }

 private:
  std::mt19937 m_engine;
};

}  // namespace longarm::virtual_robot
