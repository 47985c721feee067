#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sonoloft::test {

enum class PlaneSet {
  stack,           ///< parallel, evenly spaced across the longest side
  two_directions,  ///< such a stack and one across the shortest side, alternating
  random,          ///< any direction, through any vertex of the surface
  fan,             ///< through one line beside the body, evenly turned from one end of it to the other
  freehand,        ///< a stack whose planes sway by up to 20 degrees, slowly
};
struct NamedPlaneSet {
  PlaneSet set;
  const char* name;
};
inline constexpr std::array kPlaneSets = {
    NamedPlaneSet{PlaneSet::stack, "stack"}, NamedPlaneSet{PlaneSet::two_directions, "two directions"},
    NamedPlaneSet{PlaneSet::random, "random"}, NamedPlaneSet{PlaneSet::fan, "fan"},
    NamedPlaneSet{PlaneSet::freehand, "freehand"}};

/// Planes (z = 0 of each frame) that cut a body; its sides are those of its box. The same seed gives the same planes,
/// of random ones the first do not depend on the count. Frame: reference, mm.
/// @param surface  the vertices of its surface
[[nodiscard]] std::vector<Eigen::Isometry3d> make_planes(PlaneSet set, std::size_t count,
                                                         std::span<const Eigen::Vector3f> surface, std::uint64_t seed);

}  // namespace sonoloft::test
