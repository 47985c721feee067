#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace sonoloft {

/// Numbers that are computed four at a time, each in a lane of a vector.
inline constexpr std::size_t kLanes = 4;
using Real = float __attribute__((vector_size(kLanes * sizeof(float))));
using Integer = std::int32_t __attribute__((vector_size(kLanes * sizeof(float))));  // of a comparison: -1 is true

inline Real load(const float* numbers) {
  Real lanes;
  std::memcpy(&lanes, numbers, sizeof(lanes));
  return lanes;
}
inline void store(Real lanes, float* numbers) {
  std::memcpy(numbers, &lanes, sizeof(lanes));
}

inline float square_root(float a) {
  return std::sqrt(a);
}
inline Real square_root(Real a) {
  return Real{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}

}  // namespace sonoloft
