#include "core/octree/octant_growth.h"

#include <algorithm>
#include <utility>

#include "core/slice/parallel.h"

namespace sonoloft {

/// The samples of the octant lie in its brick and, on its upper sides, in the bricks above.
void OctantGrowth::disturb(Octant octant) {
  const WorkBrick& brick = bricks_[bricks_.find_or_add(octant.brick())];
  const int upper = octant.index();
  for (int i = 0; i < 8; ++i)
    if ((upper & i) == i) disturbed_.add(bricks_.find_or_add_beside(brick, i & 1, (i >> 1) & 1, i >> 2));
}

void OctantGrowth::activate(Octant octant) {
  WorkBrick& brick = bricks_[bricks_.find_or_add(octant.brick())];
  if ((brick.active & octant.bit()) != 0) return;
  brick.active |= octant.bit();
  disturb(octant);
}

IndexSet OctantGrowth::take_disturbed() {
  return std::exchange(disturbed_, {});
}

SampleMask OctantGrowth::needed(const WorkBrick& brick) const {
  SampleMask mask;
  for (int i = 0; i < 8; ++i) {
    const std::uint32_t index = brick.around[beside(-(i & 1), -((i >> 1) & 1), -(i >> 2))];
    if (index == kNoBrick) continue;
    for (int octant = 0; octant < 8; ++octant) {
      // Of the bricks below only the octants next to this one reach here.
      if ((bricks_[index].active >> octant & 1) == 0 || (octant & i) != i) continue;
      const auto at = [&](int axis) { return (i >> axis & 1) != 0 ? -1 : octant >> axis & 1; };
      mask = mask | corners_of_octant(at(0), at(1), at(2));
    }
  }
  return mask;
}

void OctantGrowth::refresh_faces(WorkBrick& brick) const {
  static constexpr std::array<Label, kBrickSamples> kNothing = [] {
    std::array<Label, kBrickSamples> labels{};
    labels.fill(kNotSampled);
    return labels;
  }();
  std::array<const Label*, 8> from;  // this brick and those above, of which only the lowest layer is wanted
  for (int i = 0; i < 8; ++i) {
    const std::uint32_t index = brick.around[beside(i & 1, (i >> 1) & 1, i >> 2)];
    from[static_cast<std::size_t>(i)] = index == kNoBrick ? kNothing.data() : bricks_[index].label.data();
  }
  std::array<Label, 729> labels;
  auto out = labels.begin();
  for (int z = 0; z <= kBrickSize; ++z)
    for (int y = 0; y <= kBrickSize; ++y) {
      const auto upper = static_cast<std::size_t>(2 * (y >> 3) + 4 * (z >> 3));
      const int row = sample_index(0, y & 7, z & 7);
      out = std::copy_n(from[upper] + row, kBrickSize, out);
      *out++ = from[upper + 1][row];
    }
  brick.mixed_faces = mixed_faces(labels);
}

void OctantGrowth::follow(const std::vector<std::uint32_t>& resampled, int threads) {
  IndexSet bricks;
  for (const std::uint32_t index : resampled) {
    for (int i = 0; i < 8; ++i) {
      const std::uint32_t below = bricks_[index].around[beside(-(i & 1), -((i >> 1) & 1), -(i >> 2))];
      if (below != kNoBrick && bricks_[below].active != 0) bricks.add(below);
    }
  }
  const auto& items = bricks.items();
  parallel_for(items.size(), 32, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t n = first; n < last; ++n) refresh_faces(bricks_[items[n]]);
  });
  std::vector<Octant> behind;  // activated when all are known: the faces of octants without samples mean nothing
  for (const std::uint32_t index : items) {
    faces_changed_.add(index);
    const WorkBrick& brick = bricks_[index];
    for (int octant = 0; octant < 8; ++octant)
      for (int face = 0; face < 6; ++face)
        if ((brick.active >> octant & 1) != 0 && (brick.mixed_faces[static_cast<std::size_t>(octant)] >> face & 1) != 0)
          behind.push_back(Octant::of(brick.coord, octant).neighbour(face));
  }
  for (const Octant octant : behind) activate(octant);
}

/// The active octants that mixed faces join to `start`, as far as the nearest seed.
std::vector<Octant> OctantGrowth::chain(Octant start, bool& reaches_seed) const {
  std::vector<Octant> found{start};
  std::unordered_set<Octant, OctantHash> visited{start};
  reaches_seed = false;
  for (std::size_t n = 0; n < found.size() && !reaches_seed; ++n) {
    const Octant octant = found[n];
    const WorkBrick& brick = bricks_[bricks_.find(octant.brick())];
    reaches_seed = (brick.seeds() & octant.bit()) != 0 || joined_.contains(octant);
    for (int face = 0; face < 6; ++face)
      if ((brick.mixed_faces[static_cast<std::size_t>(octant.index())] >> face & 1) != 0 &&
          visited.insert(octant.neighbour(face)).second)
        found.push_back(octant.neighbour(face));
  }
  return found;
}

void OctantGrowth::prune() {
  // A chain that broke has a face that changed on either side of the break, so every loose piece is met here.
  for (const std::uint32_t index : faces_changed_.items())
    for (int i = 0; i < 8; ++i) {
      const Octant start = Octant::of(bricks_[index].coord, i);
      if ((bricks_[index].active & start.bit()) == 0 || (bricks_[index].seeds() & start.bit()) != 0 ||
          joined_.contains(start))
        continue;
      bool reaches_seed = false;
      const std::vector<Octant> found = chain(start, reaches_seed);
      if (reaches_seed) {
        joined_.insert(found.begin(), found.end());
        continue;
      }
      for (const Octant& octant : found) {
        bricks_[bricks_.find(octant.brick())].active &= static_cast<std::uint8_t>(~octant.bit());
        disturb(octant);
      }
    }
}

}  // namespace sonoloft
