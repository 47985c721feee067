#include "core/octree/octants.h"

#include <algorithm>

namespace sonoloft {
namespace {

using Masks = std::array<SampleMask, 27>;  ///< one for each (x, y, z), each -1, 0 or 1

constexpr std::size_t mask_index(int x, int y, int z) {
  return static_cast<std::size_t>((x + 1) + 3 * (y + 1) + 9 * (z + 1));
}

/// The samples for which inside(d, at) holds in every axis; d is x, y or z of the mask, `at` the sample's coordinate.
template <class Inside>
Masks make_masks(const Inside& inside) {
  Masks masks;
  for (int i = 0; i < 27; ++i)
    for (int z = 0; z < kBrickSize; ++z)
      for (int y = 0; y < kBrickSize; ++y)
        for (int x = 0; x < kBrickSize; ++x)
          if (inside(i % 3 - 1, x) && inside(i / 3 % 3 - 1, y) && inside(i / 9 - 1, z))
            masks[static_cast<std::size_t>(i)].set(sample_index(x, y, z));
  return masks;
}

}  // namespace

const SampleMask& corners_of_octant(int x, int y, int z) {
  static const Masks masks =
      make_masks([](int d, int at) { return at >= kOctantCells * d && at <= kOctantCells * (d + 1); });
  return masks[mask_index(x, y, z)];
}

const SampleMask& samples_near(int x, int y, int z) {
  static const Masks masks =
      make_masks([](int d, int at) { return d == 0 || (d < 0 ? at < 2 : at >= kBrickSize - 2); });
  return masks[mask_index(x, y, z)];
}

const SampleMask& corners_for_below(int x, int y, int z) {
  static const Masks masks = make_masks([](int d, int at) { return d == 0 || at == 0; });
  return masks[mask_index(x, y, z)];
}

std::array<std::uint8_t, 8> mixed_faces(const std::array<Label, 729>& labels) {
  constexpr int kStride[3] = {1, 9, 81};
  // Faces lie in the layers 0, 4 and 8 of an axis, in four quarters each: 36 in all, each shared by two octants.
  bool mixed[3][3][4];
  for (int axis = 0; axis < 3; ++axis)
    for (int layer = 0; layer < 3; ++layer)
      for (int quarter = 0; quarter < 4; ++quarter) {
        const int du = kStride[(axis + 1) % 3];
        const int dv = kStride[(axis + 2) % 3];
        const int base = kOctantCells * (layer * kStride[axis] + (quarter & 1) * du + (quarter >> 1) * dv);
        const Label first = labels[static_cast<std::size_t>(base)];
        bool differ = false;
        for (int v = 0; v <= kOctantCells; ++v)
          for (int u = 0; u <= kOctantCells; ++u)
            differ |= labels[static_cast<std::size_t>(base + u * du + v * dv)] != first;
        mixed[axis][layer][quarter] = differ;
      }
  std::array<std::uint8_t, 8> result{};
  for (int octant = 0; octant < 8; ++octant) {
    const int at[3] = {octant & 1, (octant >> 1) & 1, octant >> 2};
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        const int quarter = at[(axis + 1) % 3] + 2 * at[(axis + 2) % 3];
        if (mixed[axis][at[axis] + side][quarter])
          result[static_cast<std::size_t>(octant)] |= static_cast<std::uint8_t>(1u << (2 * axis + side));
      }
  }
  return result;
}

}  // namespace sonoloft
