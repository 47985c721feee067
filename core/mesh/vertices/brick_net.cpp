#include "core/mesh/vertices/brick_net.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <utility>

#include "core/mesh/vertices/cell_vertex.h"

namespace sonoloft {
namespace {

using BlockLabels = std::array<Label, SampleBlock::kPoints>;

/// Calls visit(cell) for every cell that has all corners sampled and not all of one label.
template <class Visit>
void for_mixed_cells(const BlockLabels& labels, const Visit& visit) {
  static_assert(kNotSampled > kMaxLabel);
  // Along one axis after the other; the cells that stick out of the block cost less than leaving them out.
  BlockLabels lowest = labels, highest = labels;
  for (const int step : {1, SampleBlock::kSide, SampleBlock::kLayer})
    for (std::size_t i = 0; i + static_cast<std::size_t>(step) < labels.size(); ++i) {
      lowest[i] = std::min(lowest[i], lowest[i + static_cast<std::size_t>(step)]);
      highest[i] = std::max(highest[i], highest[i + static_cast<std::size_t>(step)]);
    }
  for (int z = 0; z < kBrickSize; ++z)
    for (int y = 0; y < kBrickSize; ++y)
      for (int x = 0; x < kBrickSize; ++x) {
        const auto i = static_cast<std::size_t>(SampleBlock::index(x, y, z));
        if (lowest[i] != highest[i] && highest[i] != kNotSampled) visit(LocalPoint{x, y, z});
      }
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

constexpr LabelPair kNoPair = {kNotSampled, kNotSampled};

/// Fills a scratch with the cells of its block.
class CellReader {
 public:
  explicit CellReader(ReadScratch& scratch) : block_(scratch.block), out_(scratch.cells), pairs_(scratch.pairs) {}

  void read(LocalPoint at) {
    const auto id = static_cast<std::uint16_t>(sample_index(at.x, at.y, at.z));
    block_.cell_labels(at, cell_);
    block_.cell_shares(at, cell_);
    const int equations = gaps_of(cell_, gaps_);
    for (std::uint16_t axis = 0; axis < 3; ++axis)
      if (const unsigned upper = 1u << axis; cell_.owner[0] != cell_.owner[upper])
        out_.edges.push_back({id, axis, cell_.label[cell_.owner[0]], cell_.label[cell_.owner[upper]],
                              to_fixed(crossing(cell_, gaps_, 0, upper))});
    if (is_simple(cell_))
      add_simple(id, equations);
    else
      add_complex(id);
  }

 private:
  void add_complex(std::uint16_t id) {
    CellSamples samples{};
    const auto count = static_cast<std::size_t>(cell_.label_count);
    samples.label_count = cell_.label_count;
    samples.owner = cell_.owner;
    samples.slice_steps = cell_.slice_steps;
    std::copy_n(cell_.label.begin(), count, samples.label.begin());
    std::copy_n(cell_.corners.begin(), count, samples.corners.begin());
    std::copy_n(cell_.share.begin(), count, samples.share.begin());
    out_.complex_cells.push_back(id);
    out_.complex_samples.push_back(samples);
  }

  void add_simple(std::uint16_t id, int equations) {
    // Two labels: along the surface. Three: along the line where they meet, or it would shrink. More: a junction,
    // fixed.
    const unsigned pull = equations == 0 ? 0 : faces_with_all_labels(cell_);
    out_.slot[id] = static_cast<std::uint16_t>(out_.simple_cells.size());
    out_.simple_cells.push_back(id);
    pairs_.push_back(cell_.label_count == 2 ? LabelPair{cell_.label[0], cell_.label[1]} : kNoPair);
    out_.placed.push_back(place_vertex(cell_, gaps_, equations));
    out_.pull.push_back(static_cast<std::uint8_t>(pull));
    out_.equations.push_back(static_cast<std::uint8_t>(equations));
    for (std::size_t k = 0; k < static_cast<std::size_t>(equations); ++k)
      out_.gaps.insert(out_.gaps.end(), gaps_[k].begin(), gaps_[k].end());
  }

  SampleBlock& block_;
  BrickCells& out_;
  std::vector<LabelPair>& pairs_;
  CellSamples cell_;
  Gaps gaps_;
};

}  // namespace

void BrickCells::clear() {
  slot.assign(kBrickSamples, kNoSlot);
  simple_cells.clear();
  complex_cells.clear();
  complex_samples.clear();
  edges.clear();
  placed.clear();
  pull.clear();
  equations.clear();
  gaps.clear();
  spans.clear();
}

bool BrickCells::same_as(const BrickCells& other) const {
  return same_bytes(simple_cells, other.simple_cells) && same_bytes(complex_cells, other.complex_cells) &&
         same_bytes(complex_samples, other.complex_samples) && edges == other.edges &&
         same_bytes(placed, other.placed) && same_bytes(pull, other.pull) && same_bytes(equations, other.equations) &&
         same_bytes(gaps, other.gaps) && same_bytes(spans, other.spans);
}

bool BrickNet::read(ReadScratch& scratch, const SampleLattice& lattice, const BrickCoord& coord) {
  BrickCells& cells = scratch.cells;
  cells.clear();
  scratch.pairs.clear();
  if (lattice.find(coord)) {
    scratch.block.select(lattice, coord);
    CellReader reader(scratch);
    for_mixed_cells(scratch.block.labels(), [&](LocalPoint cell) { reader.read(cell); });
  }
  if (cells.simple_cells.empty())
    cells.slot.clear();
  else
    spans_of(lattice.contours(coord), cells.slot, scratch.pairs, cells.spans);
  if (cells.same_as(cells_)) return false;
  cells_ = cells;
  return true;
}

bool BrickNet::mean_beside(std::size_t s, const std::array<const BrickNet*, 6>& beside, Eigen::Vector3f& mean) const {
  const int id = cells_.simple_cells[s];
  BrickPoint sum{};
  int count = 0;
  for (std::size_t face = 0; face < 6; ++face) {
    if ((cells_.pull[s] >> face & 1) == 0) continue;
    const std::size_t axis = face / 2;
    const int at = id >> (3 * axis) & 7, direction = face % 2 ? 1 : -1;
    const int stride = 1 << (3 * axis);
    const bool own = at + direction >= 0 && at + direction < kBrickSize;
    const BrickNet* net = own ? this : beside[face];
    if (!net) continue;
    const int other = own ? id + direction * stride : id - direction * stride * (kBrickSize - 1);
    const CellPoint* p = net->vertex_in(net->cells_.placed, static_cast<std::size_t>(other));
    if (!p) continue;
    for (std::size_t i = 0; i < 3; ++i) sum[i] += (*p)[i];
    sum[axis] += direction * kStep;
    ++count;
  }
  if (count == 0) return false;
  mean = Eigen::Vector3f(static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])) /
         static_cast<float>(count * kStep);
  return true;
}

bool BrickNet::relax(const std::array<const BrickNet*, 6>& beside) {
  std::vector<CellPoint> relaxed = cells_.placed;
  const float* gaps = cells_.gaps.data();
  std::span<const ContourSpan> spans = cells_.spans;
  for (std::size_t s = 0; s < relaxed.size(); ++s) {
    const int equations = cells_.equations[s];
    Eigen::Vector3f mean;
    if (mean_beside(s, beside, mean)) relaxed[s] = relax_vertex(cells_.placed[s], mean, gaps, equations);
    std::size_t here = 0;
    while (here < spans.size() && spans[here].slot == s) ++here;
    if (here > 0) relaxed[s] = put_on_contour(spans.first(here), relaxed[s], gaps);
    spans = spans.subspan(here);
    gaps += 8 * equations;
  }
  changed_sides_ = sides_of_change(relaxed);
  const bool same = same_bytes(relaxed, relaxed_);
  relaxed_ = std::move(relaxed);
  relaxed_cells_ = cells_.simple_cells;
  return !same;
}

unsigned BrickNet::sides_of_change(const std::vector<CellPoint>& relaxed) const {
  unsigned sides = 0;
  const auto add = [&](std::uint16_t cell) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      const int at = cell >> (3 * axis) & 7;
      if (at == 0) sides |= 1u << (2 * axis);
      if (at == kBrickSize - 1) sides |= 2u << (2 * axis);
    }
  };
  std::size_t before = 0;
  for (std::size_t s = 0; s < relaxed.size(); ++s) {
    const std::uint16_t cell = cells_.simple_cells[s];
    for (; before < relaxed_cells_.size() && relaxed_cells_[before] < cell; ++before) add(relaxed_cells_[before]);
    const bool known = before < relaxed_cells_.size() && relaxed_cells_[before] == cell;
    if (!known || relaxed_[before] != relaxed[s]) add(cell);
    before += known ? 1 : 0;
  }
  for (; before < relaxed_cells_.size(); ++before) add(relaxed_cells_[before]);
  return sides;
}

}  // namespace sonoloft
