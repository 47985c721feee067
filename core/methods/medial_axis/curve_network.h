#pragma once
// slices -> [CURVE NETWORK] -> cells -> medial axes -> sheets and walls -> mesh
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "core/methods/medial_axis/planes/plane_set.h"
#include "core/slice/section.h"

namespace sonoloft::medial {

/// A point of a slice's contours: one of its vertices, or where another plane crosses an edge.
struct NetworkPoint {
  std::uint32_t plane;
  Point at;                       ///< image of the plane
  Eigen::Vector2d rounded;        ///< the same
  Eigen::Vector3d position;       ///< mm; of points on other planes the double next to the exact one
  std::vector<std::uint32_t> on;  ///< the other planes that it lies on, exactly; ascending
};

/// A piece of a contour that no plane crosses.
struct NetworkEdge {
  std::uint32_t plane;
  std::uint32_t a, b;  ///< indices into CurveNetwork::points
  Label left, right;   ///< see SectionEdge
};

/// The contours of all slices, cut wherever a plane crosses them: every piece lies between planes or within one.
struct CurveNetwork {
  /// @param sections  [#planes] null for the walls of the box
  /// @cost O(#edges * #planes)
  CurveNetwork(const PlaneSet& planes, std::span<const Section* const> sections);

  const PlaneSet& planes;
  std::vector<const Section*> sections;
  std::vector<NetworkPoint> points;
  std::vector<NetworkEdge> edges;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>>
      on_lines;  ///< points of f that are on g

  /// On which side of a plane a point lies, exactly.
  [[nodiscard]] int side(std::uint32_t point, std::uint32_t of) const;
  /// The same of a piece; 0: it lies in the plane.
  [[nodiscard]] int edge_side(const NetworkEdge& edge, std::uint32_t of) const;
  /// The label of a point of a plane that lies on no contour, exactly.
  [[nodiscard]] Label label_at(std::uint32_t plane, const Point& p, const Eigen::Vector2d& rounded) const;

 private:
  void add_edge(std::uint32_t plane, const SectionEdge& edge, std::uint32_t first_point);
};

}  // namespace sonoloft::medial
