#include "core/octree/bricks/octant_growth.h"

#include <algorithm>
#include <utility>

#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

/// Index in WorkBrick::around of the brick across a face.
constexpr std::array<std::size_t, 6> kAcross = {beside(-1, 0, 0), beside(1, 0, 0),  beside(0, -1, 0),
                                                beside(0, 1, 0),  beside(0, 0, -1), beside(0, 0, 1)};

constexpr std::uint32_t kNoJob = 0xFFFFFFFF;

/// The octants of a brick that mixed faces join to some of them without leaving the brick.
OctantMask flood(const WorkBrick& brick, OctantMask octants) {
  for (OctantMask before = 0; octants != before;) {
    before = octants;
    for (int face = 0; face < 6; ++face)
      octants |= behind(octants & brick.mixed_faces[static_cast<std::size_t>(face)], face).own;
  }
  return octants;
}

}  // namespace

/// The samples of an octant lie in its brick and, on its upper sides, in the bricks above.
void OctantGrowth::disturb(std::uint32_t index, OctantMask octants) {
  const WorkBrick& brick = bricks_[index];
  for (int i = 0; i < 8; ++i) {
    OctantMask reaching = octants;
    for (int axis = 0; axis < 3; ++axis)
      if ((i >> axis & 1) != 0) reaching = behind(reaching, 2 * axis + 1).beside;
    if (reaching != 0) disturbed_.add(bricks_.find_or_add_beside(brick, i & 1, (i >> 1) & 1, i >> 2));
  }
}

void OctantGrowth::activate(std::uint32_t index, OctantMask octants) {
  WorkBrick& brick = bricks_[index];
  const OctantMask added = octants & ~brick.active;
  if (added == 0) return;
  brick.active |= added;
  disturb(index, added);
}

IndexSet OctantGrowth::take_disturbed() {
  return std::exchange(disturbed_, {});
}

SampleMask OctantGrowth::needed(const WorkBrick& brick) const {
  std::array<OctantMask, 8> octants;
  for (int i = 0; i < 8; ++i) {
    const std::uint32_t below = brick.around[beside(-(i & 1), -((i >> 1) & 1), -(i >> 2))];
    octants[static_cast<std::size_t>(i)] = below == kNoBrick ? 0 : bricks_[below].active;
  }
  return corners_of(octants);
}

/// Those of octants with corners that were taken; while none is active they wait.
void OctantGrowth::refresh_faces(WorkBrick& brick, const std::vector<SampleJob>& taken) const {
  static constexpr std::array<Label, kBrickSamples> kNothing = [] {
    std::array<Label, kBrickSamples> labels{};
    labels.fill(kNotSampled);
    return labels;
  }();
  static constexpr SampleMask kNone{};
  std::array<const Label*, 8> from;  // this brick and those above, of which only the lowest layer is wanted
  std::array<const SampleMask*, 8> renewed;
  for (int i = 0; i < 8; ++i) {
    const std::uint32_t index = brick.around[beside(i & 1, (i >> 1) & 1, i >> 2)];
    from[static_cast<std::size_t>(i)] = index == kNoBrick ? kNothing.data() : bricks_[index].label.data();
    const std::uint32_t job = index == kNoBrick ? kNoJob : job_of_[index];
    renewed[static_cast<std::size_t>(i)] = job == kNoJob ? &kNone : &taken[job].samples;
  }
  brick.stale_faces |= octants_at(renewed);
  if (brick.active == 0 || brick.stale_faces == 0) return;
  CornerLabels labels;
  for (int z = 0; z <= kBrickSize; ++z) {
    constexpr OctantMask kLayer = 0xFFFF;
    if ((brick.stale_faces & (kLayer << (8 * z & 48) | kLayer << (8 * (z - 1) & 48))) == 0) continue;
    Label* out = labels.data() + kCornerSide * kCornerSide * static_cast<std::size_t>(z);
    for (int y = 0; y <= kBrickSize; ++y) {
      const auto upper = static_cast<std::size_t>(2 * (y >> 3) + 4 * (z >> 3));
      const int row = sample_index(0, y & 7, z & 7);
      out = std::copy_n(from[upper] + row, kBrickSize, out);
      *out++ = from[upper + 1][row];
    }
  }
  const std::array<OctantMask, 6> mixed = mixed_faces(labels, brick.stale_faces);
  for (std::size_t face = 0; face < 6; ++face)
    brick.mixed_faces[face] = (brick.mixed_faces[face] & ~brick.stale_faces) | mixed[face];
  brick.stale_faces = 0;
}

OctantGrowth::Behind OctantGrowth::behind_faces(const WorkBrick& brick) {
  Behind all{brick.active != 0, 0, {}};
  for (int face = 0; face < 6; ++face) {
    const auto f = static_cast<std::size_t>(face);
    const BesideMasks next = behind(brick.active & brick.mixed_faces[f], face);
    all.own |= next.own & ~brick.active;
    all.beside[f] = next.beside;
  }
  return all;
}

// Bricks are large and far from each other: what needs them runs on all threads, the rest gets by with their indices.
void OctantGrowth::follow(const std::vector<SampleJob>& taken, int threads) {
  job_of_.assign(bricks_.capacity(), kNoJob);
  for (std::uint32_t j = 0; j < taken.size(); ++j) job_of_[taken[j].brick] = j;
  std::vector<std::array<std::uint32_t, 8>> below(taken.size());
  parallel_for(taken.size(), 64, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t n = first; n < last; ++n)
      for (int i = 0; i < 8; ++i)
        below[n][static_cast<std::size_t>(i)] =
            bricks_[taken[n].brick].around[beside(-(i & 1), -((i >> 1) & 1), -(i >> 2))];
  });
  IndexSet bricks;
  for (const auto& around : below)
    for (const std::uint32_t index : around)
      if (index != kNoBrick) bricks.add(index);
  const auto& items = bricks.items();
  std::vector<Behind> found(items.size());
  parallel_for(items.size(), 32, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t n = first; n < last; ++n) {
      refresh_faces(bricks_[items[n]], taken);
      found[n] = behind_faces(bricks_[items[n]]);
    }
  });
  // Activated when all are known: the faces of octants without samples mean nothing.
  for (std::size_t n = 0; n < items.size(); ++n) {
    if (!found[n].active) continue;
    faces_changed_.add(items[n]);
    if (found[n].own != 0) activate(items[n], found[n].own);
    for (std::size_t face = 0; face < 6; ++face) {
      if (found[n].beside[face] == 0) continue;
      const auto d = static_cast<int>(kAcross[face]);
      const std::uint32_t there = bricks_.find_or_add_beside(bricks_[items[n]], d % 3 - 1, d / 3 % 3 - 1, d / 9 - 1);
      activate(there, found[n].beside[face]);
    }
  }
}

/// Seeks the octants that mixed faces join to `start`, until one is met that is joined to a seed: then true, and all
/// that were met are.
bool OctantGrowth::find_chain(std::uint32_t first, OctantMask start) {
  for (const std::uint32_t index : chain_) chained_[index] = 0;
  chain_.clear();
  std::vector<std::uint32_t> to_flood;  // the nearest first
  const auto meet = [&](std::uint32_t index, OctantMask octants) {
    if ((octants & ~chained_[index]) == 0) return;
    if (chained_[index] == 0) chain_.push_back(index);
    chained_[index] |= octants;
    to_flood.push_back(index);
  };
  meet(first, start);
  for (std::size_t n = 0; n < to_flood.size(); ++n) {
    const std::uint32_t index = to_flood[n];
    const WorkBrick& brick = bricks_[index];
    chained_[index] = flood(brick, chained_[index]);
    if ((chained_[index] & (brick.seeds() | joined_[index])) != 0) return true;
    for (int face = 0; face < 6; ++face) {
      const auto f = static_cast<std::size_t>(face);
      if (const OctantMask next = behind(chained_[index] & brick.mixed_faces[f], face).beside; next != 0)
        meet(brick.around[kAcross[f]], next);
    }
  }
  return false;
}

void OctantGrowth::prune() {
  joined_.assign(bricks_.capacity(), 0);
  chained_.assign(bricks_.capacity(), 0);
  // A chain that broke has a face that changed on either side of the break, so every loose piece is met here.
  for (const std::uint32_t index : faces_changed_.items()) {
    const WorkBrick& brick = bricks_[index];
    joined_[index] = flood(brick, brick.seeds() | joined_[index]);
    while (const OctantMask loose = brick.active & ~joined_[index]) {
      const bool reaches_seed = find_chain(index, loose & (0 - loose));
      for (const std::uint32_t met : chain_) {
        if (reaches_seed) {
          joined_[met] |= chained_[met];
        } else {
          bricks_[met].active &= ~chained_[met];
          disturb(met, chained_[met]);
        }
      }
    }
  }
}

}  // namespace sonoloft
