#include "core/octree/bricks/octants.h"

#include <doctest/doctest.h>

#include <random>

using namespace sonoloft;

namespace {

constexpr OctantMask kAllOctants = ~OctantMask{0};

SampleMask corners_of_octant(std::size_t brick, OctantMask octant) {
  std::array<OctantMask, 8> octants{};
  octants[brick] = octant;
  return corners_of(octants);
}

}  // namespace

TEST_CASE("octants: an octant has 3 x 3 x 3 corners, those on its upper sides in the bricks above") {
  CHECK(corners_of_octant(0, octant_bit(0, 0, 0)).count() == 27);
  CHECK(corners_of_octant(0, octant_bit(3, 0, 0)).count() == 18);
  CHECK(corners_of_octant(0, octant_bit(3, 3, 3)).count() == 8);
  CHECK(corners_of_octant(1, octant_bit(3, 1, 1)).count() == 9);
  CHECK(corners_of_octant(3, octant_bit(3, 3, 1)).count() == 3);
  CHECK(corners_of_octant(7, octant_bit(3, 3, 3)).count() == 1);
  CHECK(corners_of_octant(1, octant_bit(2, 1, 1)).count() == 0);
  CHECK(corners_of_octant(0, octant_bit(1, 0, 0)).test(sample_index(4, 0, 2)));
  CHECK_FALSE(corners_of_octant(0, octant_bit(1, 0, 0)).test(sample_index(5, 0, 0)));
}

TEST_CASE("octants: those at random samples are all that have one of them for a corner") {
  std::mt19937_64 rng(6);
  for (int round = 0; round < 50; ++round) {
    std::array<SampleMask, 8> samples;
    std::array<const SampleMask*, 8> named{};
    for (std::size_t i = 0; i < 8; ++i) {
      for (auto& layer : samples[i].layer) layer = rng() & rng() & rng() & rng();
      named[i] = &samples[i];
    }
    OctantMask expected = 0;
    for (OctantMask octant = 1; octant != 0; octant <<= 1)
      for (std::size_t i = 0; i < 8; ++i) {
        std::array<OctantMask, 8> below{};  // corners_of() looks from the brick above
        below[i] = octant;
        if ((corners_of(below) & samples[i]).any()) expected |= octant;
      }
    CHECK(octants_at(named) == expected);
  }
}

TEST_CASE("octants: the corners of a random set are those of its members, one by one") {
  std::mt19937_64 rng(5);
  for (int round = 0; round < 50; ++round) {
    std::array<OctantMask, 8> octants;
    for (OctantMask& mask : octants) mask = rng() & rng();
    SampleMask expected;
    for (int i = 0; i < 8; ++i)
      for (int octant = 0; octant < 64; ++octant) {
        if ((octants[static_cast<std::size_t>(i)] >> octant & 1) == 0) continue;
        for (int corner = 0; corner < 27; ++corner) {
          const int x = 2 * (octant & 3) + corner % 3 - ((i & 1) != 0 ? 8 : 0);
          const int y = 2 * (octant >> 2 & 3) + corner / 3 % 3 - ((i & 2) != 0 ? 8 : 0);
          const int z = 2 * (octant >> 4) + corner / 9 - ((i & 4) != 0 ? 8 : 0);
          if (std::min({x, y, z}) >= 0 && std::max({x, y, z}) < 8) expected.set(sample_index(x, y, z));
        }
      }
    CHECK(corners_of(octants) == expected);
  }
}

TEST_CASE("octants: a face is mixed when its 9 corners are not all of one label, for both octants that share it") {
  CornerLabels labels{};
  CHECK(mixed_faces(labels, kAllOctants) == std::array<OctantMask, 6>{});
  // One corner in the middle of the face between octants (0,0,0) and (1,0,0): x = 2, y = 1, z = 1.
  labels[2 + 9 * (1 + 9 * 1)] = 3;
  const auto faces = mixed_faces(labels, kAllOctants);
  CHECK(faces[1] == octant_bit(0, 0, 0));
  CHECK(faces[0] == octant_bit(1, 0, 0));
  CHECK((faces[2] | faces[3] | faces[4] | faces[5]) == 0);
  // The brick's outermost corner belongs to three faces of the last octant.
  labels.fill(0);
  labels[728] = 1;
  const OctantMask last = octant_bit(3, 3, 3);
  CHECK(mixed_faces(labels, kAllOctants) == std::array<OctantMask, 6>{0, last, 0, last, 0, last});
}

TEST_CASE("octants: faces of random labels are mixed where a comparison of all corners says so") {
  std::mt19937 rng(6);
  for (int round = 0; round < 50; ++round) {
    CornerLabels labels;
    for (Label& label : labels) label = rng() % 20 == 0 ? 7 : 4;
    const auto faces = mixed_faces(labels, kAllOctants);
    for (int octant = 0; octant < 64; ++octant)
      for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        std::array<int, 3> lowest = {2 * (octant & 3), 2 * (octant >> 2 & 3), 2 * (octant >> 4)};
        lowest[static_cast<std::size_t>(axis)] += 2 * (face % 2);
        constexpr std::array<int, 3> kStride = {1, 9, 81};
        const int base = lowest[0] + 9 * lowest[1] + 81 * lowest[2];
        int sevens = 0;
        for (int corner = 0; corner < 9; ++corner) {
          const int at = base + corner % 3 * kStride[static_cast<std::size_t>((axis + 1) % 3)] +
                         corner / 3 * kStride[static_cast<std::size_t>((axis + 2) % 3)];
          sevens += labels[static_cast<std::size_t>(at)] == 7;
        }
        const bool mixed = (faces[static_cast<std::size_t>(face)] >> octant & 1) != 0;
        CHECK(mixed == (sevens != 0 && sevens != 9));
      }
  }
}

TEST_CASE("octants: what lies behind a brick's own faces lies in the next brick, on the opposite side") {
  const OctantMask octants = octant_bit(1, 0, 2) | octant_bit(3, 0, 2);
  CHECK(behind(octants, 1).own == octant_bit(2, 0, 2));
  CHECK(behind(octants, 1).beside == octant_bit(0, 0, 2));
  CHECK(behind(octants, 0).own == (octant_bit(0, 0, 2) | octant_bit(2, 0, 2)));
  CHECK(behind(octants, 0).beside == 0);
  CHECK(behind(octants, 2).beside == (octant_bit(1, 3, 2) | octant_bit(3, 3, 2)));
  CHECK(behind(octants, 5).own == (octant_bit(1, 0, 3) | octant_bit(3, 0, 3)));
  CHECK(behind(octant_bit(2, 1, 3), 5).beside == octant_bit(2, 1, 0));
}
