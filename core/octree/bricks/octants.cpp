#include "core/octree/bricks/octants.h"

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

/// A layer of octants, of the brick (0) and of those below it in x (1), in y (2) and in both (3).
using OctantLayers = std::array<unsigned, 4>;

OctantLayers octant_layers(const std::array<OctantMask, 8>& octants, std::size_t first, int z) {
  OctantLayers layers;
  for (std::size_t i = 0; i < 4; ++i) layers[i] = static_cast<unsigned>(octants[first + i] >> (16 * z) & 0xFFFF);
  return layers;
}

/// Bit 2 x + 16 y for each bit x + 4 y, 0..3 each.
std::uint64_t spread(std::uint64_t layer) {
  std::uint64_t m = (layer & 0xFF) | (layer & 0xFF00) << 24;
  m = (m & 0x0000000F0000000F) | (m & 0x000000F0000000F0) << 12;
  m = (m | m << 2) & 0x0033003300330033;
  return (m | m << 1) & 0x0055005500550055;
}

/// The corners that a layer of octants has in a layer of samples: those of the layers below on the lowest sides only.
std::uint64_t corners_in_layer(const OctantLayers& octants) {
  constexpr std::uint64_t kLowestX = 0x0101010101010101;
  const auto along_x = [&](unsigned own, unsigned below) {
    const std::uint64_t from = spread(own);
    return from | from << 1 | (from << 2 & ~kLowestX) | spread((below & 0x8888) >> 3);
  };
  const std::uint64_t from = along_x(octants[0], octants[1]);
  const std::uint64_t below = along_x(octants[2] >> 12, octants[3] >> 12);
  return from | from << 8 | from << 16 | (below & 0xFF);
}

/// What spread() was given.
std::uint64_t gather(std::uint64_t m) {
  m = (m | m >> 1) & 0x0033003300330033;
  m = (m | m >> 2) & 0x000F000F000F000F;
  m = (m | m >> 12) & 0x000000FF000000FF;
  return (m | m >> 24) & 0xFFFF;
}

/// The octants of a layer that have corners in it: of the brick (0) and of those above it in x (1), in y (2) and in
/// both (3).
std::uint64_t octants_in_layer(const std::array<std::uint64_t, 4>& corners) {
  constexpr std::uint64_t kLowestX = 0x0101010101010101, kUpToX5 = 0x3F3F3F3F3F3F3F3F;
  const auto along_x = [&](std::uint64_t own, std::uint64_t above) {
    return own | own >> 1 | (own >> 2 & kUpToX5) | (above & kLowestX) << 6;
  };
  const std::uint64_t own = along_x(corners[0], corners[1]), above = along_x(corners[2], corners[3]);
  return gather((own | own >> 8 | own >> 16 | above << 48) & 0x0055005500550055);
}

/// Three labels in a word, the first one lowest.
std::uint64_t row_of_labels(const Label* first) {
  return first[0] | std::uint32_t{first[1]} << 16 | std::uint64_t{first[2]} << 32;
}

constexpr std::uint64_t kFirstLabel = 0xFFFF;

/// A row of one label.
constexpr std::uint64_t same_labels(std::uint64_t row) {
  return (row & kFirstLabel) * 0x000100010001;
}

/// The faces of one octant that carry more than one label, 2 * axis + (1 for the upper side).
unsigned mixed_faces_of(const Label* lowest) {
  std::array<std::array<std::uint64_t, 3>, 3> row;  // [z][y]
  for (std::size_t z = 0; z < 3; ++z)
    for (std::size_t y = 0; y < 3; ++y) row[z][y] = row_of_labels(lowest + kCornerSide * (y + kCornerSide * z));
  const std::uint64_t same = same_labels(row[0][0]);
  std::uint64_t differing = 0, differing_x = 0;
  for (const auto& layer : row)
    for (const std::uint64_t r : layer) {
      differing |= r ^ same;
      differing_x |= r ^ row[0][0];
    }
  if (differing == 0) return 0;
  unsigned faces = (differing_x & kFirstLabel) != 0 ? 1u : 0u;
  faces |= differing_x >> 32 != 0 ? 2u : 0u;
  const auto differ = [&](std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    const std::uint64_t all = same_labels(a);
    return ((a ^ all) | (b ^ all) | (c ^ all)) != 0;
  };
  for (std::size_t side = 0; side < 2; ++side) {
    const std::size_t at = 2 * side;
    if (differ(row[0][at], row[1][at], row[2][at])) faces |= 4u << side;
    if (differ(row[at][0], row[at][1], row[at][2])) faces |= 16u << side;
  }
  return faces;
}

}  // namespace

const SampleMask& samples_near(int x, int y, int z) {
  static const Masks masks =
      make_masks([](int d, int at) { return d == 0 || (d < 0 ? at < 2 : at >= kBrickSize - 2); });
  return masks[mask_index(x, y, z)];
}

const SampleMask& corners_for_below(int x, int y, int z) {
  static const Masks masks = make_masks([](int d, int at) { return d == 0 || at == 0; });
  return masks[mask_index(x, y, z)];
}

SampleMask corners_of(const std::array<OctantMask, 8>& octants) {
  SampleMask mask;
  mask.layer[0] = corners_in_layer(octant_layers(octants, 4, kOctantSide - 1));
  for (int z = 0; z < kOctantSide; ++z) {
    const std::uint64_t corners = corners_in_layer(octant_layers(octants, 0, z));
    const auto lowest = static_cast<std::size_t>(kOctantCells * z);
    mask.layer[lowest] |= corners;
    mask.layer[lowest + 1] |= corners;
    if (z + 1 < kOctantSide) mask.layer[lowest + 2] |= corners;
  }
  return mask;
}

OctantMask octants_at(const std::array<const SampleMask*, 8>& samples) {
  OctantMask octants = 0;
  for (std::size_t z = 0; z < kOctantSide; ++z) {
    std::array<std::uint64_t, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto& layer = samples[i]->layer;
      const std::uint64_t upper = z + 1 < kOctantSide ? layer[kOctantCells * z + 2] : samples[i + 4]->layer[0];
      corners[i] = layer[kOctantCells * z] | layer[kOctantCells * z + 1] | upper;
    }
    octants |= octants_in_layer(corners) << (16 * z);
  }
  return octants;
}

std::array<OctantMask, 6> mixed_faces(const CornerLabels& labels, OctantMask octants) {
  std::array<OctantMask, 6> mixed{};
  for (; octants != 0; octants &= octants - 1) {
    const int i = std::countr_zero(octants);
    const auto x = static_cast<std::size_t>(i & 3), y = static_cast<std::size_t>(i >> 2 & 3);
    const auto z = static_cast<std::size_t>(i >> 4);
    const Label* lowest = labels.data() + kOctantCells * (x + kCornerSide * (y + kCornerSide * z));
    if (*lowest == kNotSampled) continue;
    const unsigned faces = mixed_faces_of(lowest);
    for (std::size_t face = 0; face < 6; ++face) mixed[face] |= OctantMask{faces >> face & 1} << i;
  }
  return mixed;
}

}  // namespace sonoloft
