#include "core/mesh/surface_extractor.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>

#include "core/mesh/drawing/complex_cell.h"
#include "core/mesh/drawing/edge_quad.h"
#include "core/slice/parallel.h"
#include "core/slice/scratch_pool.h"

namespace sonoloft {
namespace {

constexpr std::size_t kBricksPerPiece = 16;
using ChunkPtr = std::shared_ptr<const MeshChunk>;

BrickCoord operator+(const BrickCoord& a, const BrickCoord& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
BrickCoord operator-(const BrickCoord& a) {
  return {-a.x, -a.y, -a.z};
}

/// In the order of the bits of mixed_faces().
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

/// Of these the ones below itself, which with those opposite are all that a brick is asked for.
constexpr std::size_t kBelow = 6;

/// The sides of a brick, as in BrickNet::changed_sides(), that the chunk at -d from it is drawn from.
unsigned sides_seen(const BrickCoord& d) {
  unsigned sides = 0;
  const std::array<std::int32_t, 3> offset = {d.x, d.y, d.z};
  for (unsigned axis = 0; axis < 3; ++axis)
    if (offset[axis] != 0) sides |= (offset[axis] < 0 ? 2u : 1u) << (2 * axis);
  return sides;
}

/// What is known of a brick with a mixed cell.
struct BrickState {
  BrickCoord coord{};
  BrickNet net;
  ChunkPtr chunk;  ///< null when no triangle
  std::uint32_t fans = 0;
  std::uint32_t collapsed_triangles = 0;
  std::array<BrickState*, 27> around{};  ///< [NetGrid::index()] null where there is none or none is asked for
  std::uint32_t listed_in = 0;           ///< the last list that it was put on

  [[nodiscard]] BrickState* beside(const BrickCoord& d) const { return around[NetGrid::index(d.x, d.y, d.z)]; }
};
using BrickList = std::vector<BrickState*>;

bool relax(BrickState& state) {
  std::array<const BrickNet*, 6> beside{};
  for (std::size_t face = 0; face < 6; ++face)
    if (const BrickState* there = state.beside(kBeside[face])) beside[face] = &there->net;
  return state.net.relax(beside);
}

/// Draws a chunk from finished nets. True if it comes out different from what it was.
bool draw(BrickState& state, const LatticeFrame& frame, ChunkBuffer& buffer) {
  NetGrid nets{};
  for (const BrickCoord& d : kDrawnFrom)
    if (const BrickState* there = state.beside(d)) nets.nets[NetGrid::index(d.x, d.y, d.z)] = &there->net;
  buffer.start(state.coord);
  state.fans = 0;
  const BrickCells& cells = state.net.cells();
  for (const MixedEdge& edge : cells.edges) state.fans += draw_edge(nets, edge, buffer);
  for (std::size_t i = 0; i < cells.complex_cells.size(); ++i)
    draw_complex_cell(cells.complex_samples[i], nets, local_point(cells.complex_cells[i]), buffer);
  const ChunkPtr before = std::exchange(state.chunk, buffer.finish(frame, state.chunk));
  state.collapsed_triangles = buffer.collapsed_triangles();
  return state.chunk != before;
}

/// Runs body(state, scratch) on bricks; returns those for which it said true, in their order.
template <class Scratch, class Body>
BrickList filter(const BrickList& list, int threads, ScratchPool<Scratch>& scratches, const Body& body) {
  std::vector<char> said(list.size());
  parallel_for(list.size(), kBricksPerPiece, threads, [&](std::size_t first, std::size_t last) {
    const auto scratch = scratches.take();
    for (std::size_t i = first; i < last; ++i) said[i] = body(*list[i], *scratch);
  });
  BrickList result;
  for (std::size_t i = 0; i < list.size(); ++i)
    if (said[i]) result.push_back(list[i]);
  return result;
}

}  // namespace

struct SurfaceExtractor::State {
  std::unordered_map<BrickCoord, BrickState, BrickCoordHash> bricks;  ///< those with a mixed cell
  std::map<BrickCoord, ChunkPtr> chunks;                              ///< those of `bricks` with a triangle
  std::size_t bricks_read = 0, chunks_rebuilt = 0;
  std::uint32_t lists = 0;  ///< made so far
  ScratchPool<ReadScratch> readers;
  ScratchPool<ChunkBuffer> buffers;

  BrickState& find_or_add(const BrickCoord& coord) {
    const auto [it, added] = bricks.try_emplace(coord);
    BrickState& state = it->second;
    if (!added) return state;
    state.coord = coord;
    state.around[NetGrid::index(0, 0, 0)] = &state;
    for (const BrickCoord& below : std::span(kDrawnFrom).subspan(1, kBelow))
      for (const BrickCoord& d : {below, -below}) {
        const auto there = bricks.find(coord + d);
        if (there != bricks.end()) state.around[NetGrid::index(d.x, d.y, d.z)] = &there->second;
      }
    name_to_neighbours(state, &state);
    return state;
  }
  void remove(const BrickState& state) {
    name_to_neighbours(state, nullptr);
    bricks.erase(BrickCoord(state.coord));
  }
  static void name_to_neighbours(const BrickState& state, BrickState* name) {
    for (std::size_t i = 0; i < 27; ++i)  // seen from there it lies on the opposite side
      if (BrickState* there = state.around[i]) there->around[26 - i] = name;
  }

  /// Puts a brick on the list that was begun last, once; null is none.
  void put(BrickState* state, BrickList& list) const {
    if (state && std::exchange(state->listed_in, lists) != lists) list.push_back(state);
  }

  /// The bricks of `changed` that have a mixed cell, or had one.
  BrickList to_read(const SampleLattice& lattice, std::span<const BrickCoord> changed) {
    BrickList list;
    ++lists;
    for (const BrickCoord& coord : changed) {
      if (lattice.find(coord))
        put(&find_or_add(coord), list);
      else if (const auto known = bricks.find(coord); known != bricks.end())
        put(&known->second, list);
    }
    return list;
  }

  /// The bricks that differ and those beside them.
  BrickList to_relax(const BrickList& differ) {
    BrickList list;
    ++lists;
    for (BrickState* state : differ) {
      put(state, list);
      for (const BrickCoord& side : kBeside) put(state->beside(side), list);
    }
    return list;
  }

  /// The chunks that are drawn from a net that differs or of which a vertex moved: a chunk is a function of the nets
  /// around it.
  BrickList to_draw(const BrickList& differ, const BrickList& moved) {
    BrickList list;
    ++lists;
    for (const BrickList* changed : {&differ, &moved})
      for (BrickState* state : *changed) {
        const unsigned sides = state->net.changed_sides();
        for (const BrickCoord& d : kDrawnFrom)
          if ((sides_seen(d) & ~sides) == 0) put(state->beside(-d), list);
      }
    return list;
  }
};

SurfaceExtractor::SurfaceExtractor() : state_(std::make_unique<State>()) {}
SurfaceExtractor::~SurfaceExtractor() = default;
SurfaceExtractor::SurfaceExtractor(SurfaceExtractor&&) noexcept = default;
SurfaceExtractor& SurfaceExtractor::operator=(SurfaceExtractor&&) noexcept = default;

std::vector<BrickCoord> SurfaceExtractor::update(const SampleLattice& lattice, std::span<const BrickCoord> changed,
                                                 int threads) {
  State& state = *state_;
  const BrickList read = state.to_read(lattice, changed);
  const BrickList differ = filter(read, threads, state.readers, [&](BrickState& brick, ReadScratch& scratch) {
    return brick.net.read(scratch, lattice, brick.coord);
  });
  const BrickList moved = filter(state.to_relax(differ), threads, state.readers,
                                 [](BrickState& brick, ReadScratch&) { return relax(brick); });
  const BrickList to_draw = state.to_draw(differ, moved);
  const LatticeFrame frame{lattice.origin_mm(), lattice.spacing_mm()};
  const BrickList redrawn = filter(to_draw, threads, state.buffers,
                                   [&](BrickState& brick, ChunkBuffer& buffer) { return draw(brick, frame, buffer); });

  std::vector<BrickCoord> result;
  for (const BrickState* brick : redrawn) {
    result.push_back(brick->coord);
    if (brick->chunk)
      state.chunks[brick->coord] = brick->chunk;
    else
      state.chunks.erase(brick->coord);
  }
  state.bricks_read = read.size();
  state.chunks_rebuilt = to_draw.size();
  for (const BrickState* brick : read)
    if (brick->net.empty()) state.remove(*brick);
  std::sort(result.begin(), result.end());
  return result;
}

MeshSnapshot SurfaceExtractor::snapshot() const {
  MeshSnapshot snapshot;
  snapshot.chunks.reserve(state_->chunks.size());
  for (const auto& [coord, chunk] : state_->chunks) snapshot.chunks.push_back(chunk);
  return snapshot;
}

std::size_t SurfaceExtractor::chunks_rebuilt() const {
  return state_->chunks_rebuilt;
}

SurfaceExtractor::Counters SurfaceExtractor::counters() const {
  Counters counters;
  counters.bricks_read = state_->bricks_read;
  for (const auto& [coord, brick] : state_->bricks) {
    counters.leaves += brick.net.cells().simple.size() + brick.net.cells().complex_cells.size();
    counters.complex_cells += brick.net.cells().complex_cells.size();
    counters.fans += brick.fans;
    counters.collapsed_triangles += brick.collapsed_triangles;
  }
  return counters;
}

}  // namespace sonoloft
