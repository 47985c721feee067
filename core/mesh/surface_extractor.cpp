#include "core/mesh/surface_extractor.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <unordered_map>
#include <utility>

#include "core/mesh/complex_cell.h"
#include "core/mesh/edge_quad.h"
#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

constexpr std::size_t kBricksPerPiece = 16;
using ChunkPtr = std::shared_ptr<const MeshChunk>;

BrickCoord operator+(const BrickCoord& a, const BrickCoord& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
BrickCoord operator-(const BrickCoord& a, const BrickCoord& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

/// In the order of the bits of faces_with_labels().
constexpr std::array<BrickCoord, 6> kBeside = {{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};
/// Where the cells lie that a chunk is drawn from: those around the edges that it owns, and those beside its cells.
constexpr std::array<BrickCoord, 10> kDrawnFrom = {{{0, 0, 0},
                                                    {-1, 0, 0},
                                                    {0, -1, 0},
                                                    {0, 0, -1},
                                                    {-1, -1, 0},
                                                    {-1, 0, -1},
                                                    {0, -1, -1},
                                                    {1, 0, 0},
                                                    {0, 1, 0},
                                                    {0, 0, 1}}};

/// The sides of a brick, as in BrickNet::changed_sides(), that the chunk at -d from it is drawn from.
unsigned sides_seen(const BrickCoord& d) {
  unsigned sides = 0;
  const std::array<std::int32_t, 3> offset = {d.x, d.y, d.z};
  for (unsigned axis = 0; axis < 3; ++axis)
    if (offset[axis] != 0) sides |= (offset[axis] < 0 ? 2u : 1u) << (2 * axis);
  return sides;
}

void sort_unique(std::vector<BrickCoord>& bricks) {
  std::sort(bricks.begin(), bricks.end());
  bricks.erase(std::unique(bricks.begin(), bricks.end()), bricks.end());
}

struct BrickState {
  BrickNet net;
  ChunkPtr chunk;  ///< null when no triangle
  std::uint32_t fans = 0;
  std::uint32_t collapsed_triangles = 0;
};

/// Draws chunks from finished nets.
class ChunkDrawer {
 public:
  explicit ChunkDrawer(const LatticeFrame& frame) : frame_(frame) {}

  /// True if the chunk comes out different from what it was.
  bool draw(const BrickCoord& coord, const NetGrid& nets, BrickState& state) {
    buffer_.start(coord);
    state.fans = 0;
    for (const MixedEdge& edge : state.net.cells().edges) state.fans += draw_edge(nets, edge, buffer_);
    const BrickCells& cells = state.net.cells();
    for (std::size_t i = 0; i < cells.complex_cells.size(); ++i)
      draw_complex_cell(cells.complex_samples[i], nets, local_point(cells.complex_cells[i]), buffer_);
    const ChunkPtr before = std::exchange(state.chunk, buffer_.finish(frame_, state.chunk));
    state.collapsed_triangles = buffer_.collapsed_triangles();
    return state.chunk != before;
  }

 private:
  LatticeFrame frame_;
  ChunkBuffer buffer_;
};

}  // namespace

struct SurfaceExtractor::State {
  std::unordered_map<BrickCoord, BrickState, BrickCoordHash> bricks;  ///< those with a mixed cell
  std::map<BrickCoord, ChunkPtr> chunks;                              ///< those of `bricks` with a triangle
  std::size_t bricks_read = 0, chunks_rebuilt = 0;

  [[nodiscard]] const BrickNet* net(const BrickCoord& coord) const {
    const auto found = bricks.find(coord);
    return found == bricks.end() ? nullptr : &found->second.net;
  }

  /// Those of `coords` that are in `bricks`, ascending, once each.
  [[nodiscard]] std::vector<BrickCoord> present(std::vector<BrickCoord> coords) const {
    sort_unique(coords);
    std::erase_if(coords, [&](const BrickCoord& coord) { return !bricks.contains(coord); });
    return coords;
  }

  /// Runs body(coord, state, scratch) on bricks, all present; returns those for which it said true.
  template <class MakeScratch, class Body>
  std::vector<BrickCoord> for_each(const std::vector<BrickCoord>& coords, int threads, const MakeScratch& make_scratch,
                                   const Body& body) {
    std::vector<char> said(coords.size());
    parallel_for(coords.size(), kBricksPerPiece, threads, [&](std::size_t first, std::size_t last) {
      auto scratch = make_scratch();
      for (std::size_t i = first; i < last; ++i) said[i] = body(coords[i], bricks.find(coords[i])->second, scratch);
    });
    std::vector<BrickCoord> result;
    for (std::size_t i = 0; i < coords.size(); ++i)
      if (said[i]) result.push_back(coords[i]);
    return result;
  }

  /// Reads cells. Returns (bricks read, those of them that differ).
  std::pair<std::vector<BrickCoord>, std::vector<BrickCoord>> read(const SampleLattice& lattice,
                                                                   std::span<const BrickCoord> changed, int threads) {
    std::vector<BrickCoord> to_read(changed.begin(), changed.end());
    sort_unique(to_read);
    std::erase_if(to_read, [&](const BrickCoord& c) { return !lattice.find(c) && !bricks.contains(c); });
    for (const BrickCoord& coord : to_read) bricks.try_emplace(coord);
    auto differ = for_each(
        to_read, threads, [] { return ReadScratch(); },
        [&](const BrickCoord& coord, BrickState& state, ReadScratch& scratch) {
          return state.net.read(scratch, lattice, coord);
        });
    return {std::move(to_read), std::move(differ)};
  }

  /// Smooths the vertices of the bricks that differ and of those beside them. Returns those where a vertex moved.
  std::vector<BrickCoord> relax(const std::vector<BrickCoord>& differ, int threads) {
    std::vector<BrickCoord> reached = differ;
    for (const BrickCoord& coord : differ)
      for (const BrickCoord& side : kBeside) reached.push_back(coord + side);
    return for_each(
        present(std::move(reached)), threads, [] { return 0; },
        [&](const BrickCoord& coord, BrickState& state, int) {
          std::array<const BrickNet*, 6> beside;
          for (std::size_t face = 0; face < 6; ++face) beside[face] = net(coord + kBeside[face]);
          return state.net.relax(beside);
        });
  }

  /// Draws chunks again. Returns those that differ.
  std::vector<BrickCoord> draw(const LatticeFrame& frame, const std::vector<BrickCoord>& coords, int threads) {
    return for_each(
        coords, threads, [&] { return ChunkDrawer(frame); },
        [&](const BrickCoord& coord, BrickState& state, ChunkDrawer& drawer) {
          NetGrid nets{};
          for (const BrickCoord& d : kDrawnFrom) nets.nets[NetGrid::index(d.x, d.y, d.z)] = net(coord + d);
          return drawer.draw(coord, nets, state);
        });
  }
};

SurfaceExtractor::SurfaceExtractor() : state_(std::make_unique<State>()) {}
SurfaceExtractor::~SurfaceExtractor() = default;
SurfaceExtractor::SurfaceExtractor(SurfaceExtractor&&) noexcept = default;
SurfaceExtractor& SurfaceExtractor::operator=(SurfaceExtractor&&) noexcept = default;

std::vector<BrickCoord> SurfaceExtractor::update(const SampleLattice& lattice, std::span<const BrickCoord> changed,
                                                 int threads) {
  State& state = *state_;
  const auto [read, differ] = state.read(lattice, changed, threads);
  const std::vector<BrickCoord> moved = state.relax(differ, threads);

  // A chunk is a function of the nets around it.
  std::vector<BrickCoord> to_draw, net_changed;
  std::set_union(differ.begin(), differ.end(), moved.begin(), moved.end(), std::back_inserter(net_changed));
  for (const BrickCoord& coord : net_changed) {
    const unsigned sides = state.bricks.find(coord)->second.net.changed_sides();
    for (const BrickCoord& d : kDrawnFrom)
      if ((sides_seen(d) & ~sides) == 0) to_draw.push_back(coord - d);
  }
  to_draw = state.present(std::move(to_draw));
  std::vector<BrickCoord> redrawn = state.draw({lattice.origin_mm(), lattice.spacing_mm()}, to_draw, threads);

  for (const BrickCoord& coord : redrawn) {
    if (const ChunkPtr& chunk = state.bricks[coord].chunk)
      state.chunks[coord] = chunk;
    else
      state.chunks.erase(coord);
  }
  for (const BrickCoord& coord : read)
    if (const auto found = state.bricks.find(coord); found->second.net.empty()) state.bricks.erase(found);
  state.bricks_read = read.size();
  state.chunks_rebuilt = to_draw.size();
  return redrawn;
}

MeshSnapshot SurfaceExtractor::snapshot() const {
  MeshSnapshot snapshot;
  snapshot.chunks.reserve(state_->chunks.size());
  for (const auto& [coord, chunk] : state_->chunks) snapshot.chunks.push_back(chunk);
  return snapshot;
}

SurfaceExtractor::Counters SurfaceExtractor::counters() const {
  Counters counters;
  counters.bricks_read = state_->bricks_read;
  counters.chunks_rebuilt = state_->chunks_rebuilt;
  for (const auto& [coord, brick] : state_->bricks) {
    counters.leaves += brick.net.cells().simple_cells.size() + brick.net.cells().complex_cells.size();
    counters.complex_cells += brick.net.cells().complex_cells.size();
    counters.fans += brick.fans;
    counters.collapsed_triangles += brick.collapsed_triangles;
  }
  return counters;
}

}  // namespace sonoloft
