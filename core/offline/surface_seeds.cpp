#include "core/offline/surface_seeds.h"

#include <algorithm>
#include <array>
#include <compare>
#include <iterator>
#include <map>
#include <numeric>
#include <set>

namespace sonoloft {
namespace {

/// Pieces of fewer triangles are not thinned out.
constexpr std::size_t kSmallPiece = 200;
constexpr std::size_t kAllEdges = 12;

using LabelPair = std::pair<Label, Label>;

LabelPair interface_of(const IndexedMesh& mesh, std::size_t triangle) {
  return std::minmax(mesh.label_front[triangle], mesh.label_back[triangle]);
}

/// Disjoint sets of small numbers.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::uint32_t{0}); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[find(b)] = find(a); }

 private:
  std::vector<std::uint32_t> parent_;
};

/// The triangles of every connected piece of every interface.
std::vector<std::vector<std::size_t>> pieces_of(const IndexedMesh& mesh) {
  std::map<LabelPair, std::vector<std::size_t>> interfaces;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) interfaces[interface_of(mesh, t)].push_back(t);
  std::vector<std::vector<std::size_t>> pieces;
  for (const auto& [labels, triangles] : interfaces) {
    Sets sets(mesh.positions.size());
    for (const std::size_t t : triangles)
      for (const std::size_t i : {1u, 2u}) sets.join(mesh.triangles[t][0], mesh.triangles[t][i]);
    std::map<std::uint32_t, std::vector<std::size_t>> piece;
    for (const std::size_t t : triangles) piece[sets.find(mesh.triangles[t][0])].push_back(t);
    for (auto& [root, members] : piece) pieces.push_back(std::move(members));
  }
  return pieces;
}

/// A lattice edge by its lower end.
struct LatticeEdge {
  std::array<int, 3> from;
  int axis;
  friend auto operator<=>(const LatticeEdge&, const LatticeEdge&) = default;

  [[nodiscard]] Eigen::Vector3d lower() const { return Eigen::Vector3d(from[0], from[1], from[2]); }
  [[nodiscard]] Eigen::Vector3d upper() const { return lower() + Eigen::Vector3d::Unit(axis); }
};

/// The edges of the cell around a point whose ends have these two labels.
std::vector<LatticeEdge> edges_between(const LabelPair& labels, const Eigen::Vector3f& point,
                                       const LabelOracle& oracle) {
  std::vector<LatticeEdge> edges;
  const Eigen::Vector3i cell = point.array().floor().cast<int>();
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 4; ++side) {
      Eigen::Vector3i from = cell;
      from[(axis + 1) % 3] += side & 1;
      from[(axis + 2) % 3] += side >> 1;
      const LatticeEdge edge{{from.x(), from.y(), from.z()}, axis};
      const Label a = oracle.label(edge.lower()), b = oracle.label(edge.upper());
      if (LabelPair(std::minmax(a, b)) == labels) edges.push_back(edge);
    }
  return edges;
}

using Cube = std::array<int, 3>;
Cube cube_of(const Eigen::Vector3f& point, double edge) {
  const Eigen::Vector3i cube = (point.cast<double>() / edge).array().floor().cast<int>();
  return {cube.x(), cube.y(), cube.z()};
}

/// One triangle of the piece in every cube.
std::vector<std::size_t> thinned(const IndexedMesh& mesh, const std::vector<std::size_t>& piece, double cube_edge) {
  std::set<Cube> taken;
  std::vector<std::size_t> kept;
  std::ranges::copy_if(piece, std::back_inserter(kept), [&](std::size_t t) {
    return taken.insert(cube_of(mesh.positions[mesh.triangles[t][0]], cube_edge)).second;
  });
  return kept;
}

/// Where the edge leaves the label of its lower end.
Eigen::Vector3d crossing(const LatticeEdge& edge, const LabelOracle& oracle, double tolerance) {
  Eigen::Vector3d a = edge.lower(), b = edge.upper();
  const Label start = oracle.label(a);
  while ((b - a).norm() > tolerance) {
    const Eigen::Vector3d middle = (a + b) / 2;
    (oracle.label(middle) == start ? a : b) = middle;
  }
  return (a + b) / 2;
}

/// Crossings of the edges of the cells that the triangles' first corners lie in; at most so many for a triangle.
void add_seeds(const IndexedMesh& mesh, const std::vector<std::size_t>& triangles, std::size_t most,
               const LabelOracle& oracle, double tolerance, std::vector<SurfaceSeed>& seeds) {
  std::set<std::pair<LatticeEdge, LabelPair>> edges;
  for (const std::size_t t : triangles) {
    const LabelPair labels = interface_of(mesh, t);
    const auto found = edges_between(labels, mesh.positions[mesh.triangles[t][0]], oracle);
    for (std::size_t i = 0; i < std::min(most, found.size()); ++i) edges.insert({found[i], labels});
  }
  for (const auto& [edge, labels] : edges)
    seeds.push_back({crossing(edge, oracle, tolerance), labels.first, labels.second});
}

}  // namespace

std::vector<SurfaceSeed> surface_seeds(const IndexedMesh& live, const LabelOracle& oracle, double distance,
                                       double tolerance) {
  std::vector<SurfaceSeed> seeds;
  for (const auto& piece : pieces_of(live))
    if (piece.size() < kSmallPiece)
      add_seeds(live, piece, kAllEdges, oracle, tolerance, seeds);
    else
      add_seeds(live, thinned(live, piece, distance), 1, oracle, tolerance, seeds);
  return seeds;
}

std::vector<SurfaceSeed> missed_seeds(const IndexedMesh& live, const IndexedMesh& refined, const LabelOracle& oracle,
                                      double tolerance) {
  std::set<Cube> near;
  for (const Eigen::Vector3f& p : refined.positions) {
    const Cube c = cube_of(p, 1);
    for (int i = 0; i < 27; ++i) near.insert({c[0] + i % 3 - 1, c[1] + i / 3 % 3 - 1, c[2] + i / 9 - 1});
  }
  std::vector<std::size_t> missed;
  for (std::size_t t = 0; t < live.triangles.size(); ++t)
    if (!near.contains(cube_of(live.positions[live.triangles[t][0]], 1))) missed.push_back(t);
  std::vector<SurfaceSeed> seeds;
  add_seeds(live, missed, kAllEdges, oracle, tolerance, seeds);
  return seeds;
}

}  // namespace sonoloft
