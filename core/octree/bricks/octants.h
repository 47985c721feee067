#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/octree/brick.h"

// A brick is 4 x 4 x 4 octants of 2 x 2 x 2 finest cells. Octants are what is switched on and off: an active octant has
// all of its 3 x 3 x 3 corners sampled, of which it shares those on its upper sides with the octants there. Sets of
// octants, and of samples, are bits of words, so that a brick's are handled all at once.
namespace sonoloft {

inline constexpr int kOctantCells = 2;
inline constexpr int kOctantSide = kBrickSize / kOctantCells;

/// A set of octants of one brick.
using OctantMask = std::uint64_t;

/// The set of octant (x, y, z), each 0..3.
constexpr OctantMask octant_bit(int x, int y, int z) {
  return OctantMask{1} << (x + kOctantSide * (y + kOctantSide * z));
}

/// An octant by its place in the grid of all octants.
struct Octant {
  std::int32_t x, y, z;

  [[nodiscard]] BrickCoord brick() const { return {x >> 2, y >> 2, z >> 2}; }
  [[nodiscard]] OctantMask bit() const { return octant_bit(x & 3, y & 3, z & 3); }
  friend bool operator==(const Octant&, const Octant&) = default;
};

struct OctantHash {
  std::size_t operator()(const Octant& o) const { return BrickCoordHash{}({o.x, o.y, o.z}); }
};

/// A set of octants of a brick and of the brick beside it.
struct BesideMasks {
  OctantMask own, beside;
};

/// The octants behind face 2 * axis + (1 for the upper side) of each octant of a set.
constexpr BesideMasks behind(OctantMask octants, int face) {
  constexpr std::array<OctantMask, 3> kLowest = {0x1111111111111111, 0x000F000F000F000F, 0x000000000000FFFF};
  const auto axis = static_cast<std::size_t>(face / 2);
  const int step = 1 << (2 * axis), across = step * (kOctantSide - 1);
  if (face % 2 == 0) {
    const OctantMask leaving = octants & kLowest[axis];
    return {(octants ^ leaving) >> step, leaving << across};
  }
  const OctantMask leaving = octants & kLowest[axis] << across;
  return {(octants ^ leaving) << step, leaving >> across};
}

/// One bit per sample of a brick.
struct SampleMask {
  std::array<std::uint64_t, kBrickSize> layer{};  ///< [z], bit x + 8 y

  [[nodiscard]] bool test(int index) const {
    return (layer[static_cast<std::size_t>(index >> 6)] >> (index & 63)) & 1u;
  }
  void set(int index) { layer[static_cast<std::size_t>(index >> 6)] |= std::uint64_t{1} << (index & 63); }
  /// Bits x = 0..7 of a row.
  [[nodiscard]] unsigned row(int y, int z) const {
    return static_cast<unsigned>(layer[static_cast<std::size_t>(z)] >> (8 * y) & 0xFF);
  }
  [[nodiscard]] int count() const {
    int n = 0;
    for (std::uint64_t l : layer) n += std::popcount(l);
    return n;
  }
  [[nodiscard]] bool any() const {
    std::uint64_t all = 0;
    for (std::uint64_t l : layer) all |= l;
    return all != 0;
  }
  /// Calls visit(index) for every set bit, ascending.
  template <class Visit>
  void for_each(Visit visit) const {
    for (std::size_t z = 0; z < layer.size(); ++z)
      for (std::uint64_t bits = layer[z]; bits != 0; bits &= bits - 1)
        visit(static_cast<int>(64 * z) + std::countr_zero(bits));
  }
  friend bool operator==(const SampleMask&, const SampleMask&) = default;
  friend SampleMask operator|(SampleMask a, const SampleMask& b) {
    for (std::size_t z = 0; z < a.layer.size(); ++z) a.layer[z] |= b.layer[z];
    return a;
  }
  friend SampleMask operator&(SampleMask a, const SampleMask& b) {
    for (std::size_t z = 0; z < a.layer.size(); ++z) a.layer[z] &= b.layer[z];
    return a;
  }
  /// In a and not in b.
  friend SampleMask operator-(SampleMask a, const SampleMask& b) {
    for (std::size_t z = 0; z < a.layer.size(); ++z) a.layer[z] &= ~b.layer[z];
    return a;
  }
};

/// The samples of a brick that lie at most two steps from the brick beside it at (x, y, z), each -1, 0 or 1.
[[nodiscard]] const SampleMask& samples_near(int x, int y, int z);

/// The samples of a brick that are corners of cells of the brick below it, (x, y, z) each 0 or 1 brick away.
[[nodiscard]] const SampleMask& corners_for_below(int x, int y, int z);

/// The samples of a brick that are corners of octants.
/// @param octants  [i] the set in the brick that lies one brick below in x, y, z where bit 0, 1, 2 of i is set; [0] is
///                 the brick itself
[[nodiscard]] SampleMask corners_of(const std::array<OctantMask, 8>& octants);

/// The octants of a brick that have corners among some samples.
/// @param samples  [i] those in the brick that lies one brick above in x, y, z where bit 0, 1, 2 of i is set; [0]: in
///                 the brick itself
[[nodiscard]] OctantMask octants_at(const std::array<const SampleMask*, 8>& samples);

/// The labels of the 9 x 9 x 9 corners of a brick's cells, x fastest.
inline constexpr std::size_t kCornerSide = kBrickSize + 1;
using CornerLabels = std::array<Label, kCornerSide * kCornerSide * kCornerSide>;

/// For every face 2 * axis + (1 for the upper side) the octants, of some, that carry more than one label on it. Octants
/// with unsampled corners get garbage.
[[nodiscard]] std::array<OctantMask, 6> mixed_faces(const CornerLabels& labels, OctantMask octants);

}  // namespace sonoloft
