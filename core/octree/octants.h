#pragma once
#include <array>
#include <bit>
#include <cstdint>

#include "core/octree/brick.h"

// A brick is eight octants of 4 x 4 x 4 finest cells. Octants are what is switched on and off: an active octant has all
// of its 5 x 5 x 5 corners sampled, of which it shares those on its upper sides with the octants there.
namespace sonoloft {

inline constexpr int kOctantCells = kBrickSize / 2;
/// Bit of octant (x, y, z), each 0 or 1, in a mask of a brick's octants.
constexpr int octant_index(int x, int y, int z) {
  return x + 2 * y + 4 * z;
}

/// An octant by its place in the grid of all octants.
struct Octant {
  std::int32_t x, y, z;

  [[nodiscard]] static Octant of(BrickCoord brick, int index) {
    return {2 * brick.x + (index & 1), 2 * brick.y + ((index >> 1) & 1), 2 * brick.z + (index >> 2)};
  }
  [[nodiscard]] BrickCoord brick() const { return {x >> 1, y >> 1, z >> 1}; }
  [[nodiscard]] int index() const { return octant_index(x & 1, y & 1, z & 1); }
  [[nodiscard]] std::uint8_t bit() const { return static_cast<std::uint8_t>(1u << index()); }
  /// Across face 2 * axis + (1 for the upper side).
  [[nodiscard]] Octant neighbour(int face) const {
    const int step = face % 2 == 0 ? -1 : 1;
    return {x + (face / 2 == 0 ? step : 0), y + (face / 2 == 1 ? step : 0), z + (face / 2 == 2 ? step : 0)};
  }
  friend bool operator==(const Octant&, const Octant&) = default;
};

struct OctantHash {
  std::size_t operator()(const Octant& o) const { return BrickCoordHash{}({o.x, o.y, o.z}); }
};

/// One bit per sample of a brick.
struct SampleMask {
  std::array<std::uint64_t, kBrickSize> layer{};  ///< [z], bit x + 8 y

  [[nodiscard]] bool test(int index) const {
    return (layer[static_cast<std::size_t>(index >> 6)] >> (index & 63)) & 1u;
  }
  void set(int index) { layer[static_cast<std::size_t>(index >> 6)] |= std::uint64_t{1} << (index & 63); }
  void reset(int index) { layer[static_cast<std::size_t>(index >> 6)] &= ~(std::uint64_t{1} << (index & 63)); }
  [[nodiscard]] int count() const {
    int n = 0;
    for (std::uint64_t l : layer) n += std::popcount(l);
    return n;
  }
  [[nodiscard]] bool any() const { return *this != SampleMask{}; }
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

/// The samples of a brick that are corners of the octant at (x, y, z), each -1 (in the brick below), 0 or 1.
[[nodiscard]] const SampleMask& corners_of_octant(int x, int y, int z);

/// For every octant of a brick which of its six faces carry more than one label: bit 2 * axis + (1 for the upper side).
/// @param labels  the 9 x 9 x 9 corners of the brick's cells, x fastest; octants with unsampled corners get garbage
[[nodiscard]] std::array<std::uint8_t, 8> mixed_faces(const std::array<Label, 729>& labels);

}  // namespace sonoloft
