#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/cells/exact/exact_plane.h"

namespace sonoloft {

/// The corner of a cell: the common point of three planes, which decide everything, and its rounded position.
struct PolyVertex {
  Eigen::Vector3d position;
  std::array<std::uint32_t, 3> planes;
};

struct PolyFace {
  std::uint32_t plane;
  std::uint32_t first, count;  ///< loop of vertices in Polyhedron::loops, counter-clockwise seen from outside
  std::uint32_t polygon;       ///< index of the labelled face; the owner's business
  bool above;                  ///< the polyhedron lies on the side that the plane's normal points to
};

/// A closed convex polyhedron, all by itself: nothing is shared with its neighbours.
struct Polyhedron {
  std::vector<PolyVertex> vertices;
  std::vector<PolyFace> faces;
  std::vector<std::uint32_t> loops;
};

/// The box between the planes x-, x+, y-, y+, z-, z+ (ids 0..5, whose normals point into the box).
[[nodiscard]] Polyhedron make_box(std::span<const Plane> planes, double scale);

/// The part of one side. `faces` keep their order; each keeps its `polygon`; the face on the cut comes last.
/// @param side  [#vertices] -1, 0, +1: on which side of planes[cut] each vertex lies, exactly
/// @pre both -1 and +1 occur
[[nodiscard]] Polyhedron part(const Polyhedron& whole, std::span<const std::int8_t> side, int keep,
                              std::span<const Plane> planes, std::uint32_t cut, double scale);

[[nodiscard]] double volume(const Polyhedron& p);
[[nodiscard]] Eigen::Vector3d centre(const Polyhedron& p);

/// Empty when sound, else what is wrong. O(#faces #vertices). @param tolerance_mm of vertices off their planes
[[nodiscard]] std::string validate(const Polyhedron& p, std::span<const Plane> planes, double tolerance_mm);

}  // namespace sonoloft
