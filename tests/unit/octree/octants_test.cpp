#include "core/octree/octants.h"

#include <doctest/doctest.h>

using namespace sonoloft;

TEST_CASE("octants: an octant has 5 x 5 x 5 corners, those on its upper sides in the bricks above") {
  CHECK(corners_of_octant(0, 0, 0).count() == 125);
  CHECK(corners_of_octant(1, 0, 0).count() == 100);
  CHECK(corners_of_octant(1, 1, 1).count() == 64);
  CHECK(corners_of_octant(-1, 0, 0).count() == 25);
  CHECK(corners_of_octant(-1, -1, 1).count() == 4);
  CHECK(corners_of_octant(-1, -1, -1).count() == 1);
  CHECK(corners_of_octant(1, 0, 0).test(sample_index(4, 0, 4)));
  CHECK_FALSE(corners_of_octant(1, 0, 0).test(sample_index(3, 0, 0)));
}

TEST_CASE("octants: a face is mixed when its 25 corners are not all of one label, for both octants that share it") {
  std::array<Label, 729> labels{};
  CHECK(mixed_faces(labels) == std::array<std::uint8_t, 8>{});
  // One corner in the middle of the face between octants (0,0,0) and (1,0,0): x = 4, y = 2, z = 2.
  labels[4 + 9 * (2 + 9 * 2)] = 3;
  const auto faces = mixed_faces(labels);
  CHECK(faces[octant_index(0, 0, 0)] == 0b000010);
  CHECK(faces[octant_index(1, 0, 0)] == 0b000001);
  CHECK(faces[octant_index(0, 1, 0)] == 0);
  // The brick's outermost corner belongs to three faces of the last octant.
  labels.fill(0);
  labels[728] = 1;
  CHECK(mixed_faces(labels)[octant_index(1, 1, 1)] == 0b101010);
}

TEST_CASE("octants: neighbours across a brick's border lie in the next brick") {
  const Octant octant = Octant::of({-1, 0, 2}, octant_index(1, 0, 1));
  CHECK(octant.brick() == BrickCoord{-1, 0, 2});
  CHECK(octant.neighbour(1).brick() == BrickCoord{0, 0, 2});
  CHECK(octant.neighbour(1).index() == octant_index(0, 0, 1));
  CHECK(octant.neighbour(2).brick() == BrickCoord{-1, -1, 2});
  CHECK(octant.neighbour(5).brick() == BrickCoord{-1, 0, 3});
}
