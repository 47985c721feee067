#include "core/cells/cell_complex.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/cells/cell_store.h"
#include "core/cells/slice_withdrawal.h"

namespace sonoloft {
namespace {

/// The parts of a piece below a plane and above it; either may be empty.
std::pair<RowPiece, RowPiece> divide(const RowPiece& piece, const PointRow& row, const Plane& plane) {
  const double start = plane.distance(row.first), climb = plane.normal.dot(row.step);
  const auto is_below = [&](std::uint32_t i) { return start + i * climb < 0.0; };
  const std::uint32_t last = piece.end - 1;
  const bool begins_below = is_below(piece.begin);
  std::uint32_t change = piece.end;  // the first point on the other side than the first one
  if (begins_below != is_below(last)) {
    const double at = begins_below ? std::ceil(-start / climb) : std::floor(-start / climb) + 1;
    change = static_cast<std::uint32_t>(std::clamp<double>(at, piece.begin + 1, last));
  }
  const RowPiece head = {piece.row, piece.begin, change}, tail = {piece.row, change, piece.end};
  return begins_below ? std::pair(head, tail) : std::pair(tail, head);
}

}  // namespace

CellComplex::CellComplex(const Eigen::AlignedBox3d& box, double min_gap_mm)
    : store_(std::make_unique<CellStore>(box, min_gap_mm)) {}
CellComplex::~CellComplex() = default;
CellComplex::CellComplex(CellComplex&&) noexcept = default;
CellComplex& CellComplex::operator=(CellComplex&&) noexcept = default;

Result<CellComplex::Delta> CellComplex::insert(Section section, const PartWidth& width) {
  return store_->insert(std::move(section), width);
}
CellComplex::Withdrawal CellComplex::withdraw(SliceId slice) {
  return sonoloft::withdraw(*store_, static_cast<std::uint32_t>(slice));
}
CellComplex::Delta CellComplex::insert_again(SliceId slice, const Withdrawal& where, const PartWidth& width) {
  return sonoloft::insert_again(*store_, static_cast<std::uint32_t>(slice), where, width);
}

std::vector<SliceId> CellComplex::slices() const {
  std::vector<SliceId> held;
  for (std::uint32_t i = 0; i < store_->slices.size(); ++i)
    if (!store_->slices[i].withdrawn) held.push_back(SliceId{i});
  return held;
}
const Section& CellComplex::section(SliceId slice) const {
  return store_->slices[static_cast<std::uint32_t>(slice)].section;
}
std::optional<SliceId> CellComplex::slice_of(PlaneId plane) const {
  const std::uint32_t slice = store_->plane_slices[static_cast<std::uint32_t>(plane)];
  return slice == kNone ? std::nullopt : std::optional(SliceId{slice});
}

std::size_t CellComplex::cell_count() const {
  return store_->cells.size() - store_->removed_cells;
}
std::size_t CellComplex::cell_bound() const {
  return store_->cells.size();
}
std::size_t CellComplex::face_count() const {
  return store_->walls.size() - store_->free_walls.size();
}
const Eigen::AlignedBox3d& CellComplex::box() const {
  return store_->box;
}

std::size_t CellComplex::edge_count() const {
  return std::accumulate(store_->walls.begin(), store_->walls.end(), std::size_t{0},
                         [](std::size_t sum, const Wall& w) { return sum + w.polygon.size(); });
}

void CellComplex::faces(CellId cell, std::vector<CellFace>& out) const {
  out.clear();
  for (const PolyFace& f : store_->cells[static_cast<std::uint32_t>(cell)].shape.faces) {
    const Wall& wall = store_->walls[f.polygon];
    out.push_back({&store_->frames[f.plane], PlaneId{f.plane}, f.above, wall.label, &wall.polygon});
  }
}

Eigen::AlignedBox3d CellComplex::bounds(CellId cell) const {
  Eigen::AlignedBox3d box;
  for (const PolyVertex& v : store_->cells[static_cast<std::uint32_t>(cell)].shape.vertices) box.extend(v.position);
  return box;
}

Eigen::Vector3d CellComplex::centre(CellId cell) const {
  return sonoloft::centre(store_->cells[static_cast<std::uint32_t>(cell)].shape);
}

double CellComplex::volume(CellId cell) const {
  return sonoloft::volume(store_->cells[static_cast<std::uint32_t>(cell)].shape);
}

CellId CellComplex::locate(const Eigen::Vector3d& point_mm) const {
  return store_->locate(point_mm);
}

void CellComplex::locate(const Eigen::AlignedBox3d& bounds, std::span<const Eigen::Vector3d> points,
                         std::vector<std::uint32_t>& order, std::vector<CellPoints>& groups) const {
  const Eigen::Vector3d middle = bounds.center();
  const Eigen::Vector3d reach = 0.5 * bounds.sizes() + Eigen::Vector3d::Constant(1e-9 * store_->scale);
  order.resize(points.size());
  std::iota(order.begin(), order.end(), 0u);
  groups.clear();
  const auto descend = [&](const auto& self, std::int32_t node, std::uint32_t first, std::uint32_t last) -> void {
    while (node >= 0 && first < last) {
      const TreeNode& n = store_->nodes[static_cast<std::size_t>(node)];
      const Plane& plane = store_->planes[n.plane];
      const double s = plane.distance(middle);
      const double r = plane.normal.cwiseAbs().dot(reach);
      if (s > r || s < -r) {
        node = n.child[s > 0.0 ? 1 : 0];
        continue;
      }
      std::uint32_t split_at = first;
      for (std::uint32_t i = first; i < last; ++i) {  // no branches: half of them would be mispredicted
        std::swap(order[i], order[split_at]);
        split_at += plane.distance(points[order[split_at]]) < 0.0 ? 1 : 0;
      }
      self(self, n.child[0], first, split_at);
      node = n.child[1];
      first = split_at;
    }
    if (first < last) groups.push_back({CellId{static_cast<std::uint32_t>(~node)}, first, last - first});
  };
  descend(descend, store_->root, 0, static_cast<std::uint32_t>(points.size()));
}

void CellComplex::locate_rows(std::span<const PointRow> rows, std::vector<RowPiece>& pieces,
                              std::vector<CellPieces>& groups) const {
  struct Job {
    std::int32_t node;
    std::size_t first;  ///< of `open`, up to the first of the job above it on the stack
  };
  std::vector<RowPiece> open = std::exchange(pieces, {}), above;
  std::vector<Job> stack{{store_->root, 0}};
  groups.clear();
  while (!stack.empty()) {
    const auto [node, first] = stack.back();
    stack.pop_back();
    if (first == open.size()) continue;
    if (node < 0) {
      groups.push_back({CellId{static_cast<std::uint32_t>(~node)}, static_cast<std::uint32_t>(pieces.size()),
                        static_cast<std::uint32_t>(open.size() - first)});
      pieces.insert(pieces.end(), open.begin() + static_cast<std::ptrdiff_t>(first), open.end());
      open.resize(first);
      continue;
    }
    const TreeNode& n = store_->nodes[static_cast<std::size_t>(node)];
    const Plane& plane = store_->planes[n.plane];
    above.clear();
    std::size_t below = first;
    for (std::size_t i = first; i < open.size(); ++i) {
      const RowPiece whole = open[i];
      const auto [lower, upper] = divide(whole, rows[whole.row], plane);
      if (lower.begin < lower.end) open[below++] = lower;
      if (upper.begin < upper.end) above.push_back(upper);
    }
    open.resize(below);
    stack.push_back({n.child[0], first});
    stack.push_back({n.child[1], below});
    open.insert(open.end(), above.begin(), above.end());
  }
}

void CellComplex::touching(const Eigen::Vector3d& a_mm, const Eigen::Vector3d& b_mm, std::vector<CellId>& out) const {
  struct Job {
    std::int32_t node;
    Eigen::Vector3d a, b;
  };
  const double near = 1e-9 * store_->scale;
  std::vector<Job> stack{{store_->root, a_mm, b_mm}};
  while (!stack.empty()) {
    const Job job = stack.back();
    stack.pop_back();
    if (job.node < 0) {
      out.push_back(CellId{static_cast<std::uint32_t>(~job.node)});
      continue;
    }
    const TreeNode& node = store_->nodes[static_cast<std::size_t>(job.node)];
    const double sa = store_->planes[node.plane].distance(job.a), sb = store_->planes[node.plane].distance(job.b);
    const bool crosses = std::min(sa, sb) < -near && std::max(sa, sb) > near;
    const Eigen::Vector3d cut = crosses ? Eigen::Vector3d(job.a + sa / (sa - sb) * (job.b - job.a)) : job.a;
    if (std::max(sa, sb) >= -near)
      stack.push_back({node.child[1], crosses && sa < 0.0 ? cut : job.a, crosses && sb < 0.0 ? cut : job.b});
    if (std::min(sa, sb) <= near)
      stack.push_back({node.child[0], crosses && sa > 0.0 ? cut : job.a, crosses && sb > 0.0 ? cut : job.b});
  }
}

std::string CellComplex::validate() const {
  return sonoloft::validate(*store_);
}

}  // namespace sonoloft
