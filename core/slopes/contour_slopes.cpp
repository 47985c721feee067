#include "core/slopes/contour_slopes.h"

#include <algorithm>
#include <set>
#include <utility>

#include "core/slice/parallel.h"
#include "core/slice/scratch_pool.h"
#include "core/slopes/crossings.h"
#include "core/slopes/plane_slopes.h"
#include "core/slopes/slope_blend.h"

namespace sonoloft {
namespace {

/// Writes which cells have a piece of an edge between bends that changed.
void find_cells(const SliceContours& contours, const Section& section, std::span<const VertexBend> before,
                const CellComplex& cells, std::vector<CellId>& out) {
  const auto changed = [&](std::uint32_t point) { return contours.bends[point] != before[point]; };
  const auto lifted = [&](std::uint32_t point) {
    const Eigen::Vector2d& p = section.points[point];
    return Eigen::Vector3d(contours.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0));
  };
  for (std::size_t i = 0; i < section.edges.size(); ++i) {
    const SectionEdge& e = section.edges[i];
    if (!changed(e.a) && !changed(e.b)) continue;
    const auto& in = contours.edge_cells[i];
    for (const std::uint32_t cell : in)
      if (cell != kNoCell && cell != kSeveralCells) out.push_back(CellId{cell});
    if (in[0] == kSeveralCells || in[1] == kSeveralCells) cells.touching(lifted(e.a), lifted(e.b), out);
  }
}

}  // namespace

struct ContourSlopes::State {
  double feature_mm;
  std::vector<std::unique_ptr<SliceContours>> slices;  ///< [SliceId] none of those withdrawn
  std::set<SliceId> arrived;                           ///< since the last update
  std::vector<CellId> changed, removed;                ///< likewise; a changed cell may be removed since
  ScratchPool<PlaneSlopes> scratch;

  void measure_arrived(const CellComplex& cells, int threads) {
    const std::vector<SliceId> ids(arrived.begin(), arrived.end());
    parallel_for(ids.size(), 1, threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i)
        slices[static_cast<std::size_t>(ids[i])] = std::make_unique<SliceContours>(cells.section(ids[i]), feature_mm);
    });
  }

  void forget_removed(const CellComplex& cells) {
    if (removed.empty()) return;
    std::vector<bool> is_removed(cells.cell_bound(), false);
    for (const CellId cell : removed) is_removed[static_cast<std::size_t>(cell)] = true;
    removed.clear();
    for (const auto& slice : slices)
      if (slice) slice->forget(is_removed);
  }

  void sum_planes(const CellComplex& cells, int threads) {
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    constexpr std::size_t kGrain = 8;
    parallel_for(changed.size(), kGrain, threads, [&](std::size_t first, std::size_t last) {
      const auto room = scratch.take();
      for (std::size_t i = first; i < last; ++i) room->renew(cells, changed[i], slices, feature_mm);
    });
    changed.clear();
  }

  /// Between all slices and those whose places on walls changed: where a slice cut nothing, it bends no other.
  void renew_crossings(int threads) {
    const std::vector<bool> all(slices.size(), true);
    std::vector<bool> has_changed = all;  // withdrawn ones, too
    std::vector<SliceId> on_walls;
    for (std::uint32_t i = 0; i < slices.size(); ++i) {
      if (!slices[i]) continue;
      has_changed[i] = std::exchange(slices[i]->walls_changed, std::uint8_t{0}) != 0;
      if (slices[i]->is_on_walls()) on_walls.push_back(SliceId{i});
    }
    for (std::size_t i = 0; i < slices.size(); ++i)
      if (slices[i]) slices[i]->drop_crossings(has_changed[i] ? all : has_changed);
    std::vector<std::pair<SliceId, SliceId>> pairs;
    for (const SliceId a : on_walls) {
      if (!has_changed[static_cast<std::size_t>(a)]) continue;
      for (const SliceId b : on_walls)
        if (b > a || (b < a && !has_changed[static_cast<std::size_t>(b)])) pairs.emplace_back(a, b);
    }
    find_crossings(pairs, threads);
  }

  void find_crossings(const std::vector<std::pair<SliceId, SliceId>>& pairs, int threads) {
    std::vector<std::pair<std::vector<Crossing>, std::vector<Crossing>>> found(pairs.size());
    constexpr std::size_t kGrain = 16;
    parallel_for(pairs.size(), kGrain, threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const auto [a, b] = pairs[i];
        found[i] = crossings_of(a, contours(a), b, contours(b), feature_mm);
      }
    });
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      contours(pairs[i].first).add_crossings(found[i].first);
      contours(pairs[i].second).add_crossings(found[i].second);
    }
  }

  /// @return the cells beside what changed, but for those that were noted
  [[nodiscard]] std::vector<CellId> blend_stale(const CellComplex& cells, int threads) {
    std::vector<SliceId> stale;
    for (std::uint32_t i = 0; i < slices.size(); ++i)
      if (slices[i] && slices[i]->is_stale()) stale.push_back(SliceId{i});
    std::vector<std::vector<CellId>> affected(stale.size());
    parallel_for(stale.size(), 1, threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const std::vector<VertexBend> before = contours(stale[i]).bends;
        blend(contours(stale[i]), feature_mm);
        if (!arrived.contains(stale[i]))
          find_cells(contours(stale[i]), cells.section(stale[i]), before, cells, affected[i]);
      }
    });
    std::vector<bool> is_affected(cells.cell_bound(), false);
    for (const auto& some : affected)
      for (const CellId cell : some) is_affected[static_cast<std::size_t>(cell)] = true;
    std::vector<CellId> all;
    for (std::uint32_t i = 0; i < is_affected.size(); ++i)
      if (is_affected[i]) all.push_back(CellId{i});
    return all;
  }

  [[nodiscard]] SliceContours& contours(SliceId slice) { return *slices[static_cast<std::size_t>(slice)]; }
};

ContourSlopes::ContourSlopes(double feature_mm) : state_(std::make_unique<State>()) {
  state_->feature_mm = feature_mm;
}
ContourSlopes::~ContourSlopes() = default;
ContourSlopes::ContourSlopes(ContourSlopes&&) noexcept = default;
ContourSlopes& ContourSlopes::operator=(ContourSlopes&&) noexcept = default;

void ContourSlopes::note(const CellComplex::Delta& delta) {
  State& s = *state_;
  const auto slice = static_cast<std::size_t>(delta.slice);
  if (s.slices.size() <= slice) s.slices.resize(slice + 1);
  if (!s.slices[slice]) s.arrived.insert(delta.slice);
  s.changed.insert(s.changed.end(), delta.divided.begin(), delta.divided.end());
  s.changed.insert(s.changed.end(), delta.upper.begin(), delta.upper.end());
}

void ContourSlopes::note(SliceId withdrawn, const CellComplex::Withdrawal& withdrawal) {
  State& s = *state_;
  s.arrived.erase(withdrawn);
  s.slices[static_cast<std::size_t>(withdrawn)].reset();
  s.removed.insert(s.removed.end(), withdrawal.removed.begin(), withdrawal.removed.end());
  for (const auto& region : withdrawal.regions) s.changed.push_back(region.restored);
}

std::vector<CellId> ContourSlopes::update(const CellComplex& cells, int threads) {
  State& s = *state_;
  s.measure_arrived(cells, threads);
  s.forget_removed(cells);
  s.sum_planes(cells, threads);
  s.renew_crossings(threads);
  auto affected = s.blend_stale(cells, threads);
  s.arrived.clear();
  return affected;
}

std::span<const VertexBend> ContourSlopes::bends(SliceId slice) const {
  const auto index = static_cast<std::size_t>(slice);
  const auto& slices = state_->slices;
  return index < slices.size() && slices[index] ? std::span<const VertexBend>(slices[index]->bends)
                                                : std::span<const VertexBend>();
}

}  // namespace sonoloft
