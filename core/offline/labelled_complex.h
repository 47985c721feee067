#pragma once
// GPL: the house's own lines are Apache-2.0, what they include is not.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_triangulation_3.h>

#include <algorithm>
#include <vector>

#include "core/offline/label_oracle.h"

namespace sonoloft {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;

/// The facets between Delaunay cells of different labels: a cell has the label of its circumcentre, so the facets close
/// around every label. CGAL's own idea of a manifold knows no edge where three labels meet; this one asks whether the
/// boundary of each label is a manifold. The mesher refines where face_status() is SINGULAR.
class LabelledComplex : public CGAL::Mesh_complex_3_in_triangulation_3<Triangulation> {
  using Base = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;

 public:
  /// @param smallest  radius below which a facet is refined no further, whatever is wrong with it
  LabelledComplex(const LabelOracle& oracle, double smallest)
      : oracle_(&oracle), smallest_squared_(smallest * smallest) {}

  [[nodiscard]] Label label(Cell_handle cell) const;
  /// Whether the facet's ball, centred on the surface, is smaller than the smallest.
  [[nodiscard]] bool small(const Facet& facet) const;

  using Base::face_status;
  /// SINGULAR when the cells of a label around the edge are in more than one piece, and not all facets are small.
  [[nodiscard]] Face_status face_status(const Edge& edge) const;
  /// SINGULAR when the cells of a label around the vertex, or all others, are in more than one piece, and not all
  /// facets are small.
  [[nodiscard]] Face_status face_status(Vertex_handle vertex) const;

 private:
  const LabelOracle* oracle_;
  double smallest_squared_;
};

}  // namespace sonoloft
