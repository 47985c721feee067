#include "core/completion/unknown_walls.h"

#include <algorithm>
#include <cassert>
#include <unordered_map>

#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

constexpr PlaneId kFirstSlicePlane{6};
constexpr double kBeside = 1e-6;  ///< spacings beside a plane its cells are looked for

bool is_material(Label label) {
  return label != kOutside && label != kUnknown;
}

}  // namespace

UnknownWalls::UnknownWalls(const CellComplex& complex, double spacing, int threads)
    : cells(complex),
      spacing_mm(spacing),
      labels{kOutside},
      cell_walls(complex.cell_bound()),
      walls_of_cell(complex.cell_bound()) {
  for (const SliceId slice : cells.slices())
    for (const SectionEdge& e : cells.section(slice).edges)
      for (const Label label : {e.left, e.right})
        if (is_material(label)) labels.push_back(label);
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  look_at_walls();
  lay_lattices();
  cut_pieces(threads);
}

std::pair<CellId, CellId> UnknownWalls::beside(const Eigen::Isometry3d& frame, const Eigen::Vector2d& point) const {
  const Eigen::Vector3d at = on_plane(frame, point), step = kBeside * spacing_mm * frame.linear().col(2);
  return {cells.locate(at - step), cells.locate(at + step)};
}

/// The cell on the other side of a wall's middle.
CellId UnknownWalls::behind(const CellFace& face) const {
  if (face.plane < kFirstSlicePlane) return kNoCellBehind;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const FaceEdge& e : *face.polygon) middle += e.a / static_cast<double>(face.polygon->size());
  const auto [below, above] = beside(*face.image_to_reference, middle);
  return face.above ? below : above;
}

void UnknownWalls::look_at_walls() {
  cell_walls.resize(cells.cell_bound());
  walls_of_cell.resize(cells.cell_bound());
  std::unordered_map<const FacePolygon*, std::uint32_t> wall_of_polygon;
  std::vector<CellFace> faces;
  for (std::uint32_t cell = 0; cell < cells.cell_bound(); ++cell) {
    cells.faces(CellId{cell}, faces);
    for (const CellFace& face : faces) {
      if (face.polygon->empty()) continue;
      cell_walls[cell].push_back({face, behind(face)});
      if (!has_unknown(*face.polygon)) continue;
      UnknownPlane& plane = planes[face.plane];
      plane.frame = *face.image_to_reference;
      for (const FaceEdge& e : *face.polygon) plane.bounds.extend(e.a);
      const auto [wall, is_new] = wall_of_polygon.try_emplace(face.polygon, walls.size());
      if (is_new) walls.push_back({face.plane, face.polygon, {}});
      walls_of_cell[cell].push_back(wall->second);
    }
  }
}

void UnknownWalls::lay_lattices() {
  std::vector<Eigen::Vector3d> material;
  for (const SliceId slice : cells.slices()) {
    const Section& section = cells.section(slice);
    for (const SectionEdge& e : section.edges)
      if (is_material(e.left) || is_material(e.right))
        for (const std::uint32_t end : {e.a, e.b})
          if (const auto p = on_plane(section.image_to_reference, section.points[end]); cells.box().contains(p))
            material.push_back(p);
  }
  for (auto& [id, plane] : planes) {
    plane.section = &cells.section(cells.slice_of(id).value());
    Eigen::AlignedBox2d fine;
    const Eigen::Isometry3d to_image = plane.frame.inverse(Eigen::Isometry);
    for (const Eigen::Vector3d& p : material) fine.extend(Eigen::Vector2d((to_image * p).head<2>()));
    if (material.empty()) fine.extend(Eigen::Vector2d(plane.bounds.center()));
    const auto lines = [&](const Eigen::AlignedBox2d& bounds, int axis) {
      return graded_lines(fine.min()[axis], fine.max()[axis], bounds.min()[axis], bounds.max()[axis], spacing_mm);
    };
    plane.lattice = {lines(plane.bounds, 0), lines(plane.bounds, 1)};
  }
}

void UnknownWalls::cut_pieces(int threads) {
  parallel_for(walls.size(), 8, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t w = first; w < last; ++w)
      walls[w].pieces = unknown_pieces(planes.at(walls[w].plane).lattice, *walls[w].polygon);
  });
  for (const UnknownWall& wall : walls)
    for (const UnknownPiece& piece : wall.pieces) {
      std::vector<std::uint32_t>& corners = planes.at(wall.plane).corners;
      corners.insert(corners.end(), piece.nodes.begin(), piece.nodes.end());
    }
  for (auto& [id, plane] : planes) {
    std::sort(plane.corners.begin(), plane.corners.end());
    plane.corners.erase(std::unique(plane.corners.begin(), plane.corners.end()), plane.corners.end());
  }
}

}  // namespace sonoloft
