#pragma once
// samples of the octree, the live mesh -> [DELAUNAY REFINEMENT] -> a mesh for export
#include <cstddef>

#include "core/mesh/mesh.h"
#include "core/octree/brick.h"
#include "core/slice/result.h"

namespace sonoloft {

/// When a triangle is good enough. Sizes are those of its ball: centred on the surface, through the triangle's corners.
struct DelaunayCriteria {
  double angle_deg = 30;         ///< no angle of a triangle is smaller; 0..30
  double facet_radius_mm = 0;    ///< no ball is larger; > 0
  double facet_distance_mm = 0;  ///< no centre of a ball is farther from that of the triangle's circle; > 0

  /// About as many triangles as the live mesh of that spacing has: radius 0.68, distance 0.25 spacings.
  [[nodiscard]] static DelaunayCriteria like_live(double spacing_mm);
};

struct DelaunayMesh {
  IndexedMesh mesh;
  std::size_t label_queries = 0;  ///< how often the mesher asked for the label of a point
  double ms = 0;
};

/// The surfaces of the field that the live mesh shows, in well-shaped triangles, for export: all of it anew, in
/// seconds. The label of a point is the one with the largest share, shares interpolated trilinearly between the
/// smoothed samples. Refinement begins with points on every piece of the live mesh, and again where it missed some of
/// it. Frame: reference, mm. Threads: any; nothing is shared.
/// @param live  the mesh that SurfaceExtractor drew from `samples`
/// @post  no two triangles cross, and those with a label in front or behind close around it; criteria are met and the
///        boundary of each label is a 2-manifold but for triangles with a ball below 1/128 of the radius, which are
///        refined no further; the same input gives the same mesh, byte for byte
/// @error invalid_argument (criteria), empty_input (no triangle in `live`)
/// @cost  about 0.1 ms and 2 KB a triangle, one thread
/// Source: Boissonnat, Oudot 2005; Boltcheva, Yvinec, Boissonnat 2009. CGAL's Mesh_3, which is GPL: see
/// docs/decisions/licences.md.
[[nodiscard]] Result<DelaunayMesh> delaunay_mesh(const SampleLattice& samples, const MeshSnapshot& live,
                                                 const DelaunayCriteria& criteria);

}  // namespace sonoloft
