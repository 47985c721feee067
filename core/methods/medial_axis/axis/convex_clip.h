#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/methods/network/exact.h"

namespace sonoloft::medial {

using namespace network;

/// { p : a x + b y + c >= 0 }
struct HalfPlane {
  Number a, b, c;
  std::uint32_t face;  ///< of a cell, on whose account it is there
};

inline constexpr std::uint32_t kNoFace = 0xFFFFFFFF;

/// A convex polygon whose corners are where the borders of half-planes meet, exactly. Counter-clockwise.
struct ConvexPolygon {
  struct Corner {
    Point at;
    Eigen::Vector2d rounded;
    std::uint32_t before, after;  ///< borders along the sides that arrive at this corner and leave it
  };
  std::vector<Corner> corners;
  std::vector<HalfPlane> borders;

  /// @param reach_mm  half of its side
  [[nodiscard]] static ConvexPolygon square(double reach_mm);

  /// Keeps what lies in the half-plane; nothing where that has no area.
  /// @param rough     a, b, c @param doubt_mm  what a rough value must exceed to be sure
  /// @param through   faces: through corners between borders of these two the border runs, as is known without
  /// arithmetic
  /// @param exactly   () -> HalfPlane: called only where rough values do not decide
  template <class Exactly>
  void clip(const Eigen::Vector3d& rough, double doubt_mm, const std::array<std::uint32_t, 2>& through,
            const Exactly& exactly);

 private:
  enum class Sides : std::uint8_t { keep_all, keep_none, cut, unsure };
  [[nodiscard]] Sides rough_sides(const Eigen::Vector3d& h, double doubt_mm);
  [[nodiscard]] bool is_between(const Corner& corner, const std::array<std::uint32_t, 2>& faces) const;
  void cut(const HalfPlane& h, const std::array<std::uint32_t, 2>& through);
  std::vector<int> sides_;
};

template <class Exactly>
void ConvexPolygon::clip(const Eigen::Vector3d& rough, double doubt_mm, const std::array<std::uint32_t, 2>& through,
                         const Exactly& exactly) {
  const Sides sides = rough_sides(rough, doubt_mm);
  if (sides == Sides::keep_none) corners.clear();
  if (sides == Sides::cut || sides == Sides::unsure) cut(exactly(), through);
}

}  // namespace sonoloft::medial
