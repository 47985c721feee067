#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace sonoloft {

/// Four numbers handled at once: every processor has a register for them, and compilers make no vectors of loops that
/// choose.
inline constexpr std::size_t kFour = 4;
using Four = float __attribute__((vector_size(kFour * sizeof(float))));
using FourInts = std::int32_t __attribute__((vector_size(kFour * sizeof(std::int32_t))));  // of a comparison: -1: true

inline Four load_four(const float* from) {
  Four four;
  std::memcpy(&four, from, sizeof four);
  return four;
}
inline void store_four(Four four, float* to) {
  std::memcpy(to, &four, sizeof four);
}

}  // namespace sonoloft
