#pragma once
#include <cstdint>

namespace sonoloft {

/// A material. 0 is outside of every object, 1..kMaxLabel are materials.
using Label = std::uint16_t;

inline constexpr Label kOutside = 0;
inline constexpr Label kMaxLabel = 0xFFF0;
/// "Not measured" (shadow, out of the field of view): a label of a region of a slice, never of space.
inline constexpr Label kUnknown = 0xFFFF;

}  // namespace sonoloft
