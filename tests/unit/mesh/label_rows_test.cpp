#include "core/mesh/vertices/label_rows.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <set>

using namespace sonoloft;

namespace {

/// What a cell's corners say, one by one.
std::set<Label> labels_of(const BlockLabels& labels, LocalPoint cell) {
  std::set<Label> found;
  for (const int corner : BlockGrid::kCorner)
    found.insert(labels[static_cast<std::size_t>(BlockGrid::index(cell.x, cell.y, cell.z) + corner)]);
  return found;
}

BlockLabels random_labels(std::mt19937& rng, std::uint32_t kinds) {
  BlockLabels labels;
  for (Label& label : labels) {
    const auto kind = static_cast<std::uint32_t>(rng() % (5 * kinds));
    label = kind == 0 ? kNotSampled : static_cast<Label>(std::min(kind, kinds) * 300);
  }
  return labels;
}

}  // namespace

TEST_CASE("label rows: the cells visited, and what is said of them, are those found corner by corner") {
  std::mt19937 rng(4);
  std::size_t mixed_cells = 0;
  for (std::uint32_t round = 0; round < 60; ++round) {
    const BlockLabels labels = random_labels(rng, 1 + round % 5);
    LabelRows rows;
    rows.read(labels);
    std::set<int> visited, corners;
    CellSamples cell{};
    rows.for_mixed_cells(cell, [&](LocalPoint at) {
      visited.insert(sample_index(at.x, at.y, at.z));
      const std::set<Label> expected = labels_of(labels, at);
      REQUIRE(cell.label_count == static_cast<int>(expected.size()));
      CHECK(std::equal(expected.begin(), expected.end(), cell.label.begin()));
      for (unsigned c = 0; c < 8; ++c) {
        const auto owner = cell.owner[c];
        const int corner = BlockGrid::index(at.x, at.y, at.z) + BlockGrid::kCorner[c];
        CHECK(cell.label[owner] == labels[static_cast<std::size_t>(corner)]);
        CHECK((cell.corners[owner] >> c & 1) == 1);
        corners.insert(corner);
      }
    });
    for (int i = 0; i < kBrickSamples; ++i) {
      const std::set<Label> expected = labels_of(labels, local_point(i));
      CHECK(visited.contains(i) == (expected.size() > 1 && !expected.contains(kNotSampled)));
    }
    for (int point = 0; point < BlockGrid::kPoints; ++point)
      CHECK((rows.corners_of_mixed(point / BlockGrid::kSide) >> point % BlockGrid::kSide & 1) ==
            (corners.contains(point) ? 1u : 0u));
    mixed_cells += visited.size();
  }
  CHECK(mixed_cells > 5000);
}
