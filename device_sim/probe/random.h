#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace sonoloft::device_sim {

/// A stream of random numbers that is the same with every compiler and standard library (std::normal_distribution is
/// not). Bits: SplitMix64; Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators", figure 17.
class Random {
 public:
  /// Streams of one seed do not overlap in practice.
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : state_(seed) {
    state_ = bits() + stream * 0xD1B54A32D192ED03u;
    state_ = bits();
  }

  std::uint64_t bits() {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }

  /// In [0, 1), 53 bits.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

  /// Mean 0, standard deviation 1. Box and Muller 1958; the second of the pair is not kept, so that the number of bits
  /// used does not depend on the past.
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }

  /// Three independent normal numbers, x first.
  Eigen::Vector3d normal3() {
    const double x = normal();
    const double y = normal();
    return {x, y, normal()};
  }

 private:
  std::uint64_t state_;
};

}  // namespace sonoloft::device_sim
