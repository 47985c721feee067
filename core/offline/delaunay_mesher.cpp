#include "core/offline/delaunay_mesher.h"

#include <CGAL/Mesh_3/Mesher_3.h>
#include <CGAL/Mesh_criteria_3.h>

#include <chrono>
#include <cmath>
#include <unordered_map>

#include "core/offline/label_oracle.h"
#include "core/offline/labelled_complex.h"
#include "core/offline/surface_seeds.h"

namespace sonoloft {
namespace {

using Clock = std::chrono::steady_clock;
using Bounds = CGAL::Mesh_criteria_3<Triangulation>;

/// CGAL's bounds on facets, but for those that are small already.
class FacetBounds {
 public:
  using Facet_quality = Bounds::Facet_criteria::Facet_quality;
  using Is_facet_bad = Bounds::Facet_criteria::Is_facet_bad;

  FacetBounds(const Bounds& bounds, const LabelledComplex& complex)
      : bounds_(bounds.facet_criteria_object()), complex_(&complex) {}

  Is_facet_bad operator()(const Triangulation& triangulation, const Triangulation::Facet& facet) const {
    return complex_->small(facet) ? Is_facet_bad() : bounds_(triangulation, facet);
  }

 private:
  Bounds::Facet_criteria bounds_;
  const LabelledComplex* complex_;
};

/// What CGAL's mesher asks for.
struct Criteria {
  using Facet_criteria = FacetBounds;
  using Cell_criteria = Bounds::Cell_criteria;

  FacetBounds facets;
  Cell_criteria cells;  ///< none

  [[nodiscard]] const Facet_criteria& facet_criteria_object() const { return facets; }
  [[nodiscard]] const Cell_criteria& cell_criteria_object() const { return cells; }
};

/// Of a vertex from the surface, in lattice steps.
constexpr double kTolerance = 1.0 / 1024;
/// The largest radius, in lattice steps, that gives as many triangles as the live mesh has: measured on a recorded
/// spine.
constexpr double kLiveRadius = 0.68;

/// Share of the radius: facets below are refined no further. So every new point keeps that far from all others, and
/// refinement ends: where surfaces meet under a sharp angle the bounds can be met nowhere near the line they meet in.
constexpr double kSmallest = 1.0 / 128;

/// Of points to begin with, in radii: denser ones stay in the mesh and make it finer and its angles smaller.
constexpr double kSeedDistance = 4;
/// Refinement is begun again with points where it found nothing, at most so often.
constexpr int kRounds = 4;

Result<void> check(const DelaunayCriteria& c) {
  if (!(c.angle_deg >= 0 && c.angle_deg <= 30))
    return fail(ErrorCode::invalid_argument,
                "the smallest angle must be 0 to 30 degrees: refinement need not end above");
  if (!(c.facet_radius_mm > 0 && std::isfinite(c.facet_radius_mm)) ||
      !(c.facet_distance_mm > 0 && std::isfinite(c.facet_distance_mm)))
    return fail(ErrorCode::invalid_argument, "radius and distance of a triangle must be positive numbers of mm");
  return {};
}

IndexedMesh in_steps(IndexedMesh mesh, const SampleLattice& samples) {
  for (Eigen::Vector3f& p : mesh.positions)
    p = ((p.cast<double>() - samples.origin_mm()) / samples.spacing_mm()).cast<float>();
  return mesh;
}

Domain domain_of(const LabelOracle& oracle, std::size_t& queries) {
  // Two steps of outside all around: rays of the Voronoi diagram are cut off there.
  const Eigen::Vector3d low = oracle.lowest().cast<double>().array() - 2,
                        high = oracle.highest().cast<double>().array() + 2;
  const CGAL::Bbox_3 box(low.x(), low.y(), low.z(), high.x(), high.y(), high.z());
  const auto label = [&oracle, &queries](const Kernel::Point_3& p) {
    ++queries;
    return static_cast<int>(oracle.label({p.x(), p.y(), p.z()}));
  };
  return Domain(label, box,
                2 * kTolerance / (high - low).norm());  // CGAL's bisection stops at half of bound * diagonal
}

void insert(LabelledComplex& complex, const Domain& domain, const std::vector<SurfaceSeed>& seeds) {
  for (const SurfaceSeed& seed : seeds) {
    const Kernel::Point_3 point(seed.point.x(), seed.point.y(), seed.point.z());
    const auto vertex = complex.triangulation().insert(Triangulation::Weighted_point(point));
    if (vertex == Triangulation::Vertex_handle()) continue;
    complex.set_dimension(vertex, 2);
    complex.set_index(vertex, domain.index_from_surface_patch_index({seed.lower, seed.upper}));
  }
}

void refine(LabelledComplex& complex, const Domain& domain, const DelaunayCriteria& criteria, double spacing_mm) {
  namespace with = CGAL::parameters;
  const Bounds bounds(with::facet_angle = criteria.angle_deg, with::facet_size = criteria.facet_radius_mm / spacing_mm,
                      with::facet_distance = criteria.facet_distance_mm / spacing_mm);
  const Criteria accepted{FacetBounds(bounds, complex), bounds.cell_criteria_object()};
  CGAL::Mesh_3::Mesher_3<LabelledComplex, Criteria, Domain>(complex, domain, accepted, CGAL::MANIFOLD_WITH_BOUNDARY)
      .refine_mesh();
}

/// The facets between cells of different labels; the larger label behind.
IndexedMesh surfaces_of(const LabelledComplex& complex, const SampleLattice& samples) {
  const Triangulation& triangulation = complex.triangulation();
  IndexedMesh mesh;
  std::unordered_map<Triangulation::Vertex_handle, std::uint32_t> index;
  const auto index_of = [&](Triangulation::Vertex_handle v) {
    const auto [at, added] = index.try_emplace(v, static_cast<std::uint32_t>(mesh.positions.size()));
    if (added) {
      const auto& p = v->point();
      mesh.positions.push_back(
          (samples.origin_mm() + samples.spacing_mm() * Eigen::Vector3d(p.x(), p.y(), p.z())).cast<float>());
    }
    return at->second;
  };
  for (auto facet = triangulation.finite_facets_begin(); facet != triangulation.finite_facets_end(); ++facet) {
    auto [cell, i] = *facet;
    if (cell->subdomain_index() == cell->neighbor(i)->subdomain_index()) continue;
    if (cell->subdomain_index() < cell->neighbor(i)->subdomain_index())
      std::tie(cell, i) = triangulation.mirror_facet(*facet);
    // CGAL's order is clockwise seen from outside of the cell.
    const auto corner = [&, c = cell, k = i](int j) {
      return index_of(c->vertex(triangulation.vertex_triple_index(k, j)));
    };
    mesh.triangles.push_back({corner(0), corner(2), corner(1)});
    mesh.label_front.push_back(static_cast<Label>(cell->neighbor(i)->subdomain_index()));
    mesh.label_back.push_back(static_cast<Label>(cell->subdomain_index()));
  }
  return mesh;
}

}  // namespace

DelaunayCriteria DelaunayCriteria::like_live(double spacing_mm) {
  return {30, kLiveRadius * spacing_mm, 0.25 * spacing_mm};
}

Result<DelaunayMesh> delaunay_mesh(const SampleLattice& samples, const MeshSnapshot& live,
                                   const DelaunayCriteria& criteria) {
  if (auto valid = check(criteria); !valid) return tl::unexpected<Error>(valid.error());
  if (live.chunks.empty())
    return fail(ErrorCode::empty_input, "the live mesh has no triangle: there is nothing to mesh");
  const auto start = Clock::now();
  DelaunayMesh result;
  const LabelOracle oracle(samples, live);
  const Domain domain = domain_of(oracle, result.label_queries);
  const IndexedMesh live_mesh = in_steps(live.indexed(), samples);
  const double radius = criteria.facet_radius_mm / samples.spacing_mm();
  LabelledComplex complex(oracle, kSmallest * radius);
  auto seeds = surface_seeds(live_mesh, oracle, kSeedDistance * radius, kTolerance);
  for (int round = 0; round < kRounds && !seeds.empty(); ++round) {
    insert(complex, domain, seeds);
    refine(complex, domain, criteria, samples.spacing_mm());
    result.mesh = surfaces_of(complex, samples);
    seeds = missed_seeds(live_mesh, in_steps(result.mesh, samples), oracle, kTolerance);
  }
  result.ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return result;
}

}  // namespace sonoloft
