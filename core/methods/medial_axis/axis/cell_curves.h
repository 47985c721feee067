#pragma once
// the contours on the faces of a cell -> [CURVES] on its medial axis
#include <cstdint>
#include <span>
#include <vector>

#include "core/methods/medial_axis/axis/cell_axis.h"
#include "core/methods/medial_axis/curve_network.h"

namespace sonoloft::medial {

inline constexpr std::uint32_t kNoPoint = 0xFFFFFFFF;

/// A vertex of the surfaces of one cell, and what it is: its place on a ridge, the foot of a contour's point, or
/// neither. Vertices of one name are one vertex, in all sheets and walls.
struct CurveVertex {
  Eigen::Vector3d position;        ///< mm
  bool on_cell = false;            ///< on the surface of the cell: neighbours have it, too
  std::uint32_t point = kNoPoint;  ///< of the network: where it is, or is the foot of it
  std::uint32_t face = kNoPoint;   ///< of the cell, on which `point` lies
  std::uint32_t ridge = kNoPoint;
  Number along{};                 ///< of the ridge, from p to q
  std::uint32_t same = kNoPoint;  ///< another vertex at the very place that stands for this one
};

/// A vertex on the way of a contour's piece.
struct Waypoint {
  Number along;  ///< 0 at the piece's start, 1 at its end
  std::uint32_t vertex;
};

/// A piece of a contour on a face, and its projection on that face's roof.
struct Curve {
  std::uint32_t face, edge;         ///< of the cell; of the network
  std::uint32_t a, b;               ///< vertices of the contour
  std::vector<Waypoint> roof;       ///< from above a to above b, cut at ridges
  std::vector<std::uint32_t> over;  ///< [#roof - 1] sheets; kNoPoint: along a ridge
  std::vector<Waypoint> cuts{};     ///< where curves of the faces across meet it, in no order
};

/// A piece of a contour that lies on a face of the cell.
struct FaceCurve {
  std::uint32_t face, edge;
};

/// Contours projected on a cell's medial axis. What crosses a ridge is put on it once, for all sheets there.
struct CellCurves {
  std::vector<CurveVertex> vertices;             ///< those of the axis come first
  std::vector<std::vector<Waypoint>> on_ridges;  ///< [#ridges] between the ends, ascending from p to q
  std::vector<Curve> curves;
};

/// @param edges  ascending by face
[[nodiscard]] CellCurves project_curves(const CurveNetwork& network, const CellAxis& axis,
                                        std::span<const FaceCurve> edges);

/// The foot of a vertex on a face that it belongs to. @pre it lies on a ridge there, or is the projection of its point
[[nodiscard]] Point foot(const CurveNetwork& network, const CellAxis& axis, std::uint32_t id, const CurveVertex& vertex,
                         std::uint32_t face);

}  // namespace sonoloft::medial
