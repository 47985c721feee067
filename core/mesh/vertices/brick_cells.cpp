#include "core/mesh/vertices/brick_cells.h"

#include <algorithm>
#include <cstring>

#include "core/mesh/vertices/cell_vertex.h"

namespace sonoloft {
namespace {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

constexpr LabelPair kNoPair = {kNotSampled, kNotSampled};

/// Fills a scratch with the cells of its block.
class CellReader {
 public:
  explicit CellReader(ReadScratch& scratch) : block_(scratch.block), out_(scratch.cells), pairs_(scratch.pairs) {}

  void read() {
    block_.rows().for_mixed_cells(cell_, [&](LocalPoint at) { read(at); });
    if (out_.simple.size() % kFour != 0) place_vertices();
  }

 private:
  void read(LocalPoint at) {
    const auto id = static_cast<std::uint16_t>(sample_index(at.x, at.y, at.z));
    const bool simple = is_simple(cell_), pair = cell_.label_count == 2;
    const float* gap = pair ? gap_between(at, 0, 1) : nullptr;
    if (!simple || !pair) block_.find_shares(at, cell_);
    for (std::uint16_t axis = 0; axis < 3; ++axis) {
      mixed_[axis] = mixed_edges(cell_, axis);
      if ((mixed_[axis] & 1) == 0) continue;
      const unsigned upper = 1u << axis;
      const float t = pair ? zero_between(gap[0], gap[BlockGrid::kCorner[upper]]) : crossing(cell_, 0, upper);
      out_.edges.push_back({id, axis, cell_.label[cell_.owner[0]], cell_.label[cell_.owner[upper]], to_fixed(t)});
    }
    if (simple)
      add_simple(at, id, gap);
    else
      add_complex(id);
  }

  /// The ways to the border between two labels of the cell; BlockGrid::kCorner tells where those of its corners are.
  const float* gap_between(LocalPoint at, std::size_t i, std::size_t j) {
    return block_.gap_plane({cell_.label[i], cell_.label[j]}) + BlockGrid::index(at.x, at.y, at.z);
  }

  void add_complex(std::uint16_t id) {
    CellSamples samples{};
    const auto count = static_cast<std::size_t>(cell_.label_count);
    samples.label_count = cell_.label_count;
    samples.owner = cell_.owner;
    samples.slice_steps = cell_.slice_steps;
    std::copy_n(cell_.label.begin(), count, samples.label.begin());
    std::copy_n(cell_.corners.begin(), count, samples.corners.begin());
    std::copy_n(cell_.share.begin(), count, samples.share.begin());
    out_.slot[id] = BrickCells::kComplex;
    out_.complex_cells.push_back(id);
    out_.complex_samples.push_back(samples);
  }

  void add_simple(LocalPoint at, std::uint16_t id, const float* gap) {
    const std::size_t slot = out_.simple.size(), lane = slot % kFour;
    if (lane == 0) {
      out_.gaps.emplace_back();
      crossings_ = CrossingLanes{};
      lines_placed_ = out_.lines.size();
    }
    for (std::size_t axis = 0; axis < 3; ++axis) crossings_.mixed[axis][lane] = static_cast<std::int32_t>(mixed_[axis]);
    if (gap)
      for (std::size_t c = 0; c < 8; ++c) out_.gaps.back().corner[c][lane] = gap[BlockGrid::kCorner[c]];
    else
      add_crossings(lane);
    if (cell_.label_count == 3) add_line(at, static_cast<std::uint32_t>(slot));
    // Two labels: along the surface. Three: along the line where they meet, or it would shrink. More: a junction,
    // fixed.
    const unsigned pull = cell_.label_count > 3 ? 0 : faces_with_all_labels(cell_);
    out_.slot[id] = static_cast<std::uint16_t>(slot);
    out_.simple.push_back({id, static_cast<std::uint16_t>(pull), {}});
    pairs_.push_back(gap ? LabelPair{cell_.label[0], cell_.label[1]} : kNoPair);
    if (lane == kFour - 1) place_vertices();
  }

  void add_crossings(std::size_t lane) {
    crossings_.known[lane] = -1;
    for (unsigned axis = 0; axis < 3; ++axis)
      for (std::size_t edge = 0; edge < 4; ++edge)
        if (const unsigned lower = kLowerEnds[axis][edge]; (mixed_[axis] >> lower & 1) != 0)
          crossings_.crossing[axis][edge][lane] = crossing(cell_, lower, lower | 1u << axis);
  }

  void add_line(LocalPoint at, std::uint32_t slot) {
    LineGaps line{slot, {}};
    for (std::size_t k = 0; k < 2; ++k) {
      const float* gap = gap_between(at, 0, k + 1);
      for (std::size_t c = 0; c < 8; ++c) line.gap[k][c] = gap[BlockGrid::kCorner[c]];
    }
    out_.lines.push_back(line);
  }

  /// Of the cells in the last lanes.
  void place_vertices() {
    const PointLanes mean = mean_of_crossings(crossings_, out_.gaps.back());
    const auto placed = step_to_surface(mean, out_.gaps.back(), std::span(out_.lines).subspan(lines_placed_));
    for (std::size_t slot = (out_.gaps.size() - 1) * kFour; slot < out_.simple.size(); ++slot)
      out_.simple[slot].placed = placed[slot % kFour];
  }

  SampleBlock& block_;
  BrickCells& out_;
  std::vector<LabelPair>& pairs_;
  CellSamples cell_;
  std::array<unsigned, 3> mixed_;  ///< [axis] edges of the cell
  CrossingLanes crossings_{};      ///< of the cells in the last lanes
  std::size_t lines_placed_ = 0;   ///< lines before those cells
};

}  // namespace

void BrickCells::clear() {
  slot.fill(kNoSlot);
  simple.clear();
  gaps.clear();
  lines.clear();
  complex_cells.clear();
  complex_samples.clear();
  edges.clear();
  spans.clear();
}

bool BrickCells::same_as(const BrickCells& other) const {
  return same_bytes(simple, other.simple) && same_bytes(gaps, other.gaps) && same_bytes(lines, other.lines) &&
         same_bytes(complex_cells, other.complex_cells) && same_bytes(complex_samples, other.complex_samples) &&
         same_bytes(edges, other.edges) && same_bytes(spans, other.spans);
}

void read_cells(ReadScratch& scratch, const SampleLattice& lattice, const BrickCoord& coord) {
  scratch.cells.clear();
  scratch.pairs.clear();
  if (!scratch.block.select(lattice, coord)) return;
  CellReader(scratch).read();
  if (!scratch.cells.simple.empty())
    spans_of(lattice.contours(coord), scratch.cells.slot, scratch.pairs, scratch.cells.spans);
}

}  // namespace sonoloft
