#include "core/methods/network/fairing/fairing.h"

#include <Eigen/SparseCholesky>
#include <algorithm>

namespace sonoloft::network {
namespace {

/// A vertex keeps this share of its distance from a wall at least.
constexpr double kKept = 0.1;

using Matrix = Eigen::SparseMatrix<double>;

/// [#V] vertices joined to each by an edge.
std::vector<std::vector<std::uint32_t>> neighbours_of(const ContourSurfaces& s) {
  std::vector<std::vector<std::uint32_t>> all(s.positions.size());
  for (const auto& t : s.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      all[t[i]].push_back(t[(i + 1) % 3]);
      all[t[i]].push_back(t[(i + 2) % 3]);
    }
  for (std::vector<std::uint32_t>& list : all) {
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return all;
}

/// [#V] cells that triangles at each are of.
std::vector<std::vector<std::uint32_t>> cells_of(const JoinedCells& cells) {
  std::vector<std::vector<std::uint32_t>> all(cells.surfaces.positions.size());
  for (std::size_t t = 0; t < cells.surfaces.triangles.size(); ++t)
    for (const std::uint32_t v : cells.surfaces.triangles[t])
      if (std::ranges::count(all[v], cells.cell_of[t]) == 0) all[v].push_back(cells.cell_of[t]);
  return all;
}

/// How far each vertex is from the mean of its neighbours, as a matrix over the free vertices and a part that is given.
struct Laplacian {
  explicit Laplacian(const ContourSurfaces& s)
      : free(static_cast<Eigen::Index>(s.positions.size()),
             static_cast<Eigen::Index>(s.positions.size() - s.on_slices)),
        fixed(Eigen::MatrixXd::Zero(free.rows(), 3)) {
    const auto neighbours = neighbours_of(s);
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t v = 0; v < neighbours.size(); ++v) {
      const auto row = static_cast<Eigen::Index>(v);
      const auto add = [&](std::size_t column, double weight) {
        if (column >= s.on_slices)
          entries.emplace_back(static_cast<int>(row), static_cast<int>(column - s.on_slices), weight);
        else
          fixed.row(row) += weight * s.positions[column].transpose();
      };
      add(v, 1);
      for (const std::uint32_t n : neighbours[v]) add(n, -1 / static_cast<double>(neighbours[v].size()));
    }
    free.setFromTriplets(entries.begin(), entries.end());
  }
  Matrix free;            ///< [#V, #free]
  Eigen::MatrixXd fixed;  ///< [#V, 3]
};

/// The share of a way that keeps off all walls.
double share_within(const std::vector<Eigen::Hyperplane<double, 3>>& walls, const Eigen::Vector3d& from,
                    const Eigen::Vector3d& to) {
  double share = 1;
  for (const auto& wall : walls) {
    const double before_mm = wall.signedDistance(from), after_mm = wall.signedDistance(to);
    if (after_mm < kKept * before_mm) share = std::min(share, (1 - kKept) * before_mm / (before_mm - after_mm));
  }
  return std::max(share, 0.0);
}

}  // namespace

bool fair(JoinedCells& cells) {
  ContourSurfaces& s = cells.surfaces;
  const Laplacian laplacian(s);
  const Matrix transposed = laplacian.free.transpose();
  const Eigen::SimplicialLDLT<Matrix> solver(transposed * laplacian.free);
  if (solver.info() != Eigen::Success) return false;
  const Eigen::MatrixXd smooth = solver.solve(-(transposed * laplacian.fixed));
  if (!smooth.allFinite()) return false;
  const std::vector<std::vector<std::uint32_t>> cells_at = cells_of(cells);
  for (std::size_t v = s.on_slices; v < s.positions.size(); ++v) {
    const Eigen::Vector3d to = smooth.row(static_cast<Eigen::Index>(v - s.on_slices));
    double share = 1;
    for (const std::uint32_t cell : cells_at[v])
      share = std::min(share, share_within(cells.walls[cell], s.positions[v], to));
    s.positions[v] += share * (to - s.positions[v]);
  }
  return true;
}

}  // namespace sonoloft::network
