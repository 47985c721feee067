#include "core/completion/published_completion.h"

#include <algorithm>
#include <cassert>
#include <tuple>

#include "core/completion/cell_groups.h"
#include "core/completion/unknown_walls.h"
#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

constexpr double kMinHeight = 1e-6;  ///< spacings that points are held off planes

using NodeShares = std::vector<std::vector<double>>;  ///< [#L][node]

/// A corner in an unknown part.
struct Corner {
  std::pair<CellId, CellId> group;
  PlaneId plane;
  std::uint32_t node;
  Eigen::Vector3d point;
};

/// The linear function through a label's shares at the corners of a triangle.
LinearShare linear_share(const PlaneLattice& lattice, const std::array<std::uint32_t, 3>& nodes,
                         const std::vector<double>& share) {
  const Eigen::Vector2d p = lattice.point(nodes[0]);
  const Eigen::Vector2d e1 = lattice.point(nodes[1]) - p, e2 = lattice.point(nodes[2]) - p;
  const double rise1 = share[nodes[1]] - share[nodes[0]], rise2 = share[nodes[2]] - share[nodes[0]];
  const Eigen::Vector2d gradient = Eigen::Vector2d(rise1 * e2.y() - rise2 * e1.y(), rise2 * e1.x() - rise1 * e2.x()) /
                                   (e1.x() * e2.y() - e1.y() * e2.x());
  return {share[nodes[0]] - gradient.dot(p), gradient};
}

/// From unknown walls to patches.
struct Builder {
  const UnknownWalls& unknown;
  std::optional<int> hops;
  int threads;
  CellGroups groups;
  std::map<PlaneId, NodeShares> shares;

  Builder(const UnknownWalls& walls, std::optional<int> h, int t)
      : unknown(walls), hops(h), threads(t), groups(walls.cell_walls.size()) {}

  [[nodiscard]] std::vector<Corner> unknown_corners();
  void complete(std::span<const Corner> corners);
  void complete_group(std::span<const Corner> corners);
  [[nodiscard]] std::vector<PlaneRegions> patches() const;
};

/// Gives known corners their label. @return the others, with their groups
std::vector<Corner> Builder::unknown_corners() {
  for (const UnknownWall& wall : unknown.walls)
    for (const UnknownPiece& piece : wall.pieces) {
      Eigen::Vector2d middle = Eigen::Vector2d::Zero();
      for (const auto& [a, b] : piece.border) middle += a / static_cast<double>(piece.border.size());
      const auto [below, above] = unknown.beside(unknown.planes.at(wall.plane).frame, middle);
      groups.join(below, above);
    }
  std::vector<Corner> corners;
  for (const auto& [id, plane] : unknown.planes) {
    NodeShares& share = shares[id];
    share.assign(unknown.labels.size(), std::vector<double>(plane.lattice.x.size() * plane.lattice.y.size(), 0.0));
    for (const std::uint32_t node : plane.corners) {
      const Label label = label_at(*plane.section, plane.lattice.point(node));
      if (label != kUnknown) {
        const auto slot =
            std::lower_bound(unknown.labels.begin(), unknown.labels.end(), label) - unknown.labels.begin();
        share[static_cast<std::size_t>(slot)][node] = 1;
        continue;
      }
      const auto pair = unknown.beside(plane.frame, plane.lattice.point(node));
      groups.join(pair.first, pair.second);
      corners.push_back({pair, id, node, on_plane(plane.frame, plane.lattice.point(node))});
    }
  }
  groups.finish();
  for (Corner& corner : corners) corner.group = groups.key(corner.group.first, corner.group.second, hops);
  std::stable_sort(corners.begin(), corners.end(), [](const Corner& l, const Corner& r) {
    return std::tie(l.group, l.plane) < std::tie(r.group, r.plane);
  });
  return corners;
}

/// Corners that see the same cells.
void Builder::complete_group(std::span<const Corner> corners) {
  const GroupKnowledge known(unknown.cell_walls, groups.group(corners.front().group, hops), unknown.labels,
                             kMinHeight * unknown.spacing_mm);
  std::vector<std::size_t> blocks;  // where they begin; each of one plane
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (blocks.empty() || corners[i].plane != corners[blocks.back()].plane || i == blocks.back() + kPointLanes)
      blocks.push_back(i);
  blocks.push_back(corners.size());
  parallel_for(blocks.size() - 1, 4, threads, [&](std::size_t first, std::size_t last) {
    std::vector<PointLanes> weights(unknown.labels.size());
    for (std::size_t b = first; b < last; ++b) {
      const std::span<const Corner> block = corners.subspan(blocks[b], blocks[b + 1] - blocks[b]);
      std::vector<Eigen::Vector3d> points;
      for (const Corner& corner : block) points.push_back(corner.point);
      known.shares(block.front().plane, points, weights);
      NodeShares& share = shares.at(block.front().plane);
      for (std::size_t slot = 0; slot < unknown.labels.size(); ++slot)
        for (std::size_t i = 0; i < block.size(); ++i) share[slot][block[i].node] = weights[slot][i];
    }
  });
}

void Builder::complete(std::span<const Corner> corners) {
  std::vector<std::size_t> first_of;  // group
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (i == 0 || corners[i].group != corners[i - 1].group) first_of.push_back(i);
  first_of.push_back(corners.size());
  parallel_for(first_of.size() - 1, 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t g = first; g < last; ++g)
      complete_group(corners.subspan(first_of[g], first_of[g + 1] - first_of[g]));
  });
}

std::vector<PlaneRegions> Builder::patches() const {
  std::vector<PlaneRegions> patches;
  for (const UnknownWall& wall : unknown.walls)
    patches.emplace_back(unknown.planes.at(wall.plane).frame, kMinHeight * unknown.spacing_mm);
  parallel_for(unknown.walls.size(), 8, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t w = first; w < last; ++w) {
      const UnknownWall& wall = unknown.walls[w];
      const PlaneLattice& lattice = unknown.planes.at(wall.plane).lattice;
      for (const UnknownPiece& piece : wall.pieces)
        for (std::uint32_t slot = 0; slot < unknown.labels.size(); ++slot) {
          const LinearShare share = linear_share(lattice, piece.nodes, shares.at(wall.plane)[slot]);
          if (share.value == 0.0 && share.gradient.isZero(0.0)) continue;
          for (const auto& [a, b] : piece.border) patches[w].add(a, b, slot, share);
        }
      patches[w].finish();
    }
  });
  return patches;
}

}  // namespace

struct PublishedCompletion::State {
  std::vector<Label> labels;
  std::vector<std::vector<std::uint32_t>> walls_of_cell;  ///< [cell]
  std::vector<PlaneRegions> patches;                      ///< [wall]
  std::vector<CellId> completed;
  std::size_t corner_count = 0;
};

PublishedCompletion::PublishedCompletion(const CellComplex& cells, std::optional<int> hops, double spacing_mm,
                                         int threads)
    : state_(std::make_unique<State>()) {
  assert((!hops || *hops >= 1) && spacing_mm > 0 && threads >= 1);
  UnknownWalls unknown(cells, spacing_mm, threads);
  Builder builder(unknown, hops, threads);
  const std::vector<Corner> corners = builder.unknown_corners();
  builder.complete(corners);
  state_->corner_count = corners.size();
  state_->patches = builder.patches();
  state_->labels = std::move(unknown.labels);
  state_->walls_of_cell = std::move(unknown.walls_of_cell);
  for (std::uint32_t cell = 0; cell < state_->walls_of_cell.size(); ++cell)
    if (!state_->walls_of_cell[cell].empty()) state_->completed.push_back(CellId{cell});
}

PublishedCompletion::~PublishedCompletion() = default;
PublishedCompletion::PublishedCompletion(PublishedCompletion&&) noexcept = default;
PublishedCompletion& PublishedCompletion::operator=(PublishedCompletion&&) noexcept = default;

void PublishedCompletion::shares(CellId cell, std::span<const Eigen::Vector3d> points_mm, PointShares& out) const {
  const State& s = *state_;
  out.labels = s.labels;
  out.share.assign(s.labels.size() * points_mm.size(), 0.0f);
  std::vector<PointLanes> sums(s.labels.size());
  for (std::size_t first = 0; first < points_mm.size(); first += kPointLanes) {
    const PointBlock block(points_mm, first);
    for (PointLanes& lanes : sums) lanes.fill(0);
    for (const std::uint32_t wall : s.walls_of_cell[static_cast<std::uint32_t>(cell)])
      s.patches[wall].weigh(block, sums);
    normalise(sums);
    for (std::size_t slot = 0; slot < sums.size(); ++slot)
      for (std::size_t i = first; i < std::min(first + kPointLanes, points_mm.size()); ++i)
        out.share[slot * points_mm.size() + i] = static_cast<float>(sums[slot][i - first]);
  }
}

std::span<const CellId> PublishedCompletion::cells() const {
  return state_->completed;
}
std::size_t PublishedCompletion::corner_count() const {
  return state_->corner_count;
}

}  // namespace sonoloft
