#pragma once
// a convex cell -> [MEDIAL AXIS] -> sheets
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/methods/medial_axis/axis/convex_clip.h"
#include "core/methods/medial_axis/planes/plane_set.h"

namespace sonoloft::medial {

/// A face of a cell.
struct Facing {
  std::uint32_t plane;
  int side;  ///< of the plane, +1 or -1: where the cell lies
};

/// A corner of the cell, or a point inside of it that is nearest to four faces or more. It is named by all faces that
/// are nearest to it, decided exactly: where more of them meet than need to, it is still one vertex.
struct AxisVertex {
  std::vector<std::uint32_t> faces;  ///< of the cell, ascending
  std::vector<Point> feet;           ///< [#faces] its foot on each of them
  Triple at;                         ///< mm
  Eigen::Vector3d position;          ///< mm, rounded
  bool corner;                       ///< of the cell

  [[nodiscard]] const Point& foot(std::uint32_t face) const;
};

/// The points that are nearest to two faces alike and to no other face nearer: a convex polygon.
struct Sheet {
  std::uint32_t f, g;  ///< faces of the cell, f < g
  double parting;  ///< its height above a point of f, or of g, is the distance of the other one there divided by this
  std::vector<std::uint32_t> outline;  ///< vertices, counter-clockwise in the image of f
  std::vector<std::uint32_t> sides;    ///< [#outline] ridges, from each vertex to the next
  bool flipped;                        ///< in the image of g they run clockwise
};

/// A side of sheets: three of them and more meet there inside the cell; at an edge of the cell there is one.
struct Ridge {
  std::uint32_t p, q;                 ///< vertices, p < q
  std::vector<std::uint32_t> sheets;  ///< that it is a side of
  bool edge;                          ///< of the cell
};

/// The medial axis of a convex cell. Seen along its normal every face is covered by its sheets exactly: they are the
/// roof of what lies nearest to it.
/// Source: Liu, Bajaj, Deasy, Low, Ju 2008, section 4.
struct CellAxis {
  /// @param faces  of the cell: that lie on it with an area
  /// @cost O(#faces^3), most of it in doubles
  CellAxis(const PlaneSet& planes, std::span<const Facing> faces, double scale_mm);

  std::vector<Facing> faces;
  std::vector<AxisVertex> vertices;
  std::vector<Sheet> sheets;
  std::vector<Ridge> ridges;
  std::vector<std::vector<std::uint32_t>> roofs;  ///< [#faces] sheets
};

/// The place on a sheet above an image point of its face f, rounded.
[[nodiscard]] Eigen::Vector3d above(const PlaneSet& planes, const CellAxis& axis, const Sheet& sheet,
                                    const Eigen::Vector2d& p);

}  // namespace sonoloft::medial
