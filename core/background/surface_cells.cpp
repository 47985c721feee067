#include "core/background/surface_cells.h"

#include <map>
#include <utility>

namespace sonoloft {
namespace {

using Eigen::Vector3i;

/// The nodes of a brick that come first along an axis.
BackgroundMask first_layer(int axis) {
  BackgroundMask mask;
  for_each_in(nodes_of(Vector3i::Zero()), [&](const Vector3i& node) {
    if (node[axis] == 0) mask.set(node_index(node.x(), node.y(), node.z()));
  });
  return mask;
}

/// The cells that have a corner among these nodes, by their brick's place relative to the nodes'.
std::vector<std::pair<Vector3i, BackgroundMask>> cells_at(const BackgroundMask& nodes) {
  static const std::array<BackgroundMask, 3> kFirst{first_layer(0), first_layer(1), first_layer(2)};
  std::vector<std::pair<Vector3i, BackgroundMask>> cells{{Vector3i::Zero(), nodes}};
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t stride = std::size_t{1} << (3 * axis);
    const BackgroundMask& first = kFirst[static_cast<std::size_t>(axis)];
    for (std::size_t i = 0, count = cells.size(); i < count; ++i) {
      const BackgroundMask mask = cells[i].second;
      cells[i].second |= (mask & ~first) >> stride;
      const BackgroundMask before = (mask & first) << (7 * stride);
      if (before.any()) cells.emplace_back(cells[i].first - Vector3i::Unit(axis), before);
    }
  }
  return cells;
}

/// Which cells of a brick have corners of several labels.
BackgroundMask mixed_cells(const BrickTable<NodeShares>& shares, const Vector3i& brick) {
  std::array<Label, 9 * 9 * 9> corner{};
  bool any = false;
  for_each_in({brick, brick + Vector3i::Ones()}, [&](const Vector3i& b) {
    const NodeShares* there = shares.find(b);
    if (there == nullptr) return;
    any = true;
    const Eigen::AlignedBox3i corners(kBrickEdge * brick, (kBrickEdge * brick).array() + kBrickEdge);
    for_each_in(nodes_of(b).intersection(corners), [&](const Vector3i& node) {
      const Vector3i p = node - corners.min();
      corner[static_cast<std::size_t>(p.x() + 9 * (p.y() + 9 * p.z()))] =
          there->top[node_index(node.x(), node.y(), node.z())];
    });
  });
  BackgroundMask mixed;
  if (!any) return mixed;
  for_each_in(nodes_of(Vector3i::Zero()), [&](const Vector3i& cell) {
    const Label* low = &corner[static_cast<std::size_t>(cell.x() + 9 * (cell.y() + 9 * cell.z()))];
    for (const int upper : {1, 9, 10, 81, 82, 90, 91})
      if (low[upper] != low[0]) mixed.set(node_index(cell.x(), cell.y(), cell.z()));
  });
  return mixed;
}

}  // namespace

SurfaceCells::SurfaceCells(const Vector3i& nodes) : cells_(nodes.array() + kBrickEdge) {}

std::vector<BackgroundChange> SurfaceCells::update(const BrickTable<NodeShares>& shares,
                                                   const std::vector<RenewedNodes>& renewed) {
  std::map<std::size_t, BackgroundMask> changed;
  for (const RenewedNodes& r : renewed)
    for (const auto& [offset, mask] : cells_at(r.nodes))
      changed[cells_.index(shares.brick(r.brick) + offset + Vector3i::Ones())] |= mask;
  std::vector<BackgroundChange> changes;
  for (const auto& [index, mask] : changed) {
    const Vector3i brick = cells_.brick(index) - Vector3i::Ones();
    const BackgroundMask now = mixed_cells(shares, brick);
    const BackgroundMask before = cells_[index] ? *cells_[index] : BackgroundMask{};
    changes.push_back({brick, mask, now & ~before, before & ~now});
    cells_[index] = now.any() ? std::make_unique<BackgroundMask>(now) : nullptr;
  }
  return changes;
}

std::vector<BackgroundChange> SurfaceCells::all() const {
  std::vector<BackgroundChange> cells;
  for (std::size_t i = 0; i < cells_.capacity(); ++i)
    if (cells_[i]) cells.push_back({cells_.brick(i) - Vector3i::Ones(), {}, *cells_[i], {}});
  return cells;
}

}  // namespace sonoloft
