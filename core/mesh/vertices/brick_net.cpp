#include "core/mesh/vertices/brick_net.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace sonoloft {
namespace {

constexpr float kRelaxation = 0.85F;
/// Beside a cell that is not simple a vertex keeps this far away from the sides of its own: nodes there are near the
/// middles of edges, and triangles to a vertex in a corner would be thin.
constexpr std::uint16_t kMarginBesideComplex = kStep * 35 / 100;

}  // namespace

bool BrickNet::read(ReadScratch& scratch, const SampleLattice& lattice, const BrickCoord& coord) {
  read_cells(scratch, lattice, coord);
  if (scratch.cells.same_as(cells_)) return false;
  cells_ = scratch.cells;
  return true;
}

void BrickNet::find_pulls(const SimpleCell& cell, const std::array<const BrickNet*, 6>& beside, std::size_t lane,
                          Pulls& pulls) const {
  std::int32_t x = 0, y = 0, z = 0, count = 0, beside_complex = 0;
  unsigned found = 0;
  for (unsigned rest = cell.pull; rest != 0; rest &= rest - 1) {
    const auto face = static_cast<unsigned>(std::countr_zero(rest)), shift = 3 * (face / 2);
    const bool upper = face % 2 != 0;
    const int id = cell.index, stride = upper ? 1 << shift : -(1 << shift);
    const bool own = (id >> shift & 7) != (upper ? kBrickSize - 1 : 0);
    const BrickNet* net = own ? this : beside[face];
    if (!net) continue;
    const BrickCells& cells = net->cells_;
    const std::uint16_t slot = cells.slot[static_cast<std::size_t>(own ? id + stride : id - stride * (kBrickSize - 1))];
    beside_complex |= slot == BrickCells::kComplex;
    if (slot >= BrickCells::kComplex) continue;
    const CellPoint& p = cells.simple[slot].placed;
    x += p[0];
    y += p[1];
    z += p[2];
    found |= 1u << face;
    ++count;
  }
  const auto above_less_below = [&](unsigned axis) {
    return static_cast<std::int32_t>(found >> (2 * axis + 1) & 1) - static_cast<std::int32_t>(found >> (2 * axis) & 1);
  };
  pulls.sum[0][lane] = x + above_less_below(0) * kStep;
  pulls.sum[1][lane] = y + above_less_below(1) * kStep;
  pulls.sum[2][lane] = z + above_less_below(2) * kStep;
  pulls.count[lane] = count;
  pulls.beside_complex[lane] = beside_complex;
}

void BrickNet::relax_lanes(std::size_t block, const std::array<const BrickNet*, 6>& beside,
                           std::span<const LineGaps>& lines) {
  const std::span cells = std::span(cells_.simple).subspan(block * kFour);
  const std::size_t count = std::min(cells.size(), kFour);
  Pulls pulls{};
  PointLanes p{};
  for (std::size_t i = 0; i < count; ++i) {
    find_pulls(cells[i], beside, i, pulls);
    for (std::size_t axis = 0; axis < 3; ++axis) p.axis[axis][i] = cells[i].placed[axis];
  }
  const Four steps = __builtin_convertvector(pulls.count > 0 ? pulls.count * kStep : FourInts{} + 1, Four);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Four at = p.axis[axis] / kStep, mean = __builtin_convertvector(pulls.sum[axis], Four) / steps;
    p.axis[axis] = at + kRelaxation * (mean - at);
  }
  const auto end = std::ranges::upper_bound(lines, block, {}, [](const LineGaps& line) { return line.slot / kFour; });
  const auto here = lines.first(static_cast<std::size_t>(end - lines.begin()));
  lines = lines.subspan(here.size());
  const auto stepped = step_to_surface(p, cells_.gaps[block], here);
  for (std::size_t i = 0; i < count; ++i) {
    CellPoint vertex = pulls.count[i] > 0 ? stepped[i] : cells[i].placed;
    if (pulls.beside_complex[i])
      for (std::uint16_t& x : vertex)
        x = std::clamp<std::uint16_t>(x, kMarginBesideComplex, kStep - kMarginBesideComplex);
    relaxed_.push_back({cells[i].index, vertex});
  }
}

void BrickNet::put_on_contours() {
  for (std::span<const ContourSpan> rest = cells_.spans; !rest.empty();) {
    const std::uint32_t slot = rest.front().slot;
    const auto end = std::ranges::find_if(rest, [&](const ContourSpan& span) { return span.slot != slot; });
    const auto here = rest.first(static_cast<std::size_t>(end - rest.begin()));
    Gap gap;
    for (std::size_t c = 0; c < 8; ++c) gap[c] = cells_.gaps[slot / kFour].corner[c][slot % kFour];
    relaxed_[slot].vertex = put_on_contour(here, relaxed_[slot].vertex, gap);
    rest = rest.subspan(here.size());
  }
}

bool BrickNet::relax(const std::array<const BrickNet*, 6>& beside) {
  const std::vector<RelaxedCell> before = std::exchange(relaxed_, {});
  relaxed_.reserve(cells_.simple.size());
  std::span<const LineGaps> lines = cells_.lines;
  for (std::size_t block = 0; block < cells_.gaps.size(); ++block) relax_lanes(block, beside, lines);
  put_on_contours();
  changed_sides_ = sides_of_change(before);
  return relaxed_ != before;
}

unsigned BrickNet::sides_of_change(const std::vector<RelaxedCell>& before) const {
  unsigned sides = 0;
  const auto add = [&](std::uint16_t cell) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      const int at = cell >> (3 * axis) & 7;
      if (at == 0) sides |= 1u << (2 * axis);
      if (at == kBrickSize - 1) sides |= 2u << (2 * axis);
    }
  };
  auto old = before.begin();
  for (const RelaxedCell& cell : relaxed_) {
    for (; old != before.end() && old->index < cell.index; ++old) add(old->index);
    const bool known = old != before.end() && old->index == cell.index;
    if (!known || *old != cell) add(cell.index);
    old += known ? 1 : 0;
  }
  for (; old != before.end(); ++old) add(old->index);
  return sides;
}

}  // namespace sonoloft
