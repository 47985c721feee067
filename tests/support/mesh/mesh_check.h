#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "core/mesh/mesh.h"

namespace sonoloft::test {

/// What is true of the boundary of one label: the triangles with it in front or behind, turned to look out of it.
struct LabelReport {
  std::size_t triangles = 0;
  std::size_t boundary_edges = 0;         ///< edges of one triangle
  std::size_t non_manifold_edges = 0;     ///< edges of three or more triangles
  std::size_t misoriented_edges = 0;      ///< edges of two triangles that run through it in the same direction
  std::size_t non_manifold_vertices = 0;  ///< vertices whose triangles are not one fan
  std::size_t components = 0;
  long euler = 0;  ///< V - E + F over all components
  /// Sum of the genera of all components; only a number of handles when the label is closed and manifold.
  [[nodiscard]] long genus() const { return static_cast<long>(components) - euler / 2; }
  double volume_mm3 = 0;  ///< enclosed by the boundary (negative when inside out)
  [[nodiscard]] bool closed_manifold() const {
    return boundary_edges == 0 && non_manifold_edges == 0 && misoriented_edges == 0 && non_manifold_vertices == 0;
  }
};

struct MeshReport {
  std::map<Label, LabelReport> labels;   ///< every label of the mesh; volume of outside (0) is minus that of the rest
  std::size_t degenerate_triangles = 0;  ///< a vertex twice, two corners in one place, or three on one line (exact)
  std::size_t bad_indices = 0;           ///< triangles with an index over the end; nothing else is looked at then
  std::size_t unused_vertices = 0;
  std::size_t same_label_triangles = 0;  ///< label_front == label_back
  /// No fault of any kind. Intersections are a separate question.
  [[nodiscard]] bool closed_manifold() const;
  [[nodiscard]] std::string text() const;  ///< one line a label, for messages
};

/// Looks at indices, labels and positions only; shares no code with what made the mesh.
[[nodiscard]] MeshReport check_mesh(const IndexedMesh& mesh);

/// Pairs of triangles that meet anywhere else than in the vertices or the edge they share (by index). Exact.
/// @pre no degenerate triangle
[[nodiscard]] std::size_t count_self_intersections(const IndexedMesh& mesh);

/// Smallest angle of each triangle in degrees, ascending.
[[nodiscard]] std::vector<double> smallest_angles_deg(const IndexedMesh& mesh);

}  // namespace sonoloft::test
