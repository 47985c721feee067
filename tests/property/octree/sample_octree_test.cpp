#include "core/octree/sample_octree.h"

#include <doctest/doctest.h>

#include <map>
#include <random>

#include "core/cells/cell_complex.h"
#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

const Eigen::AlignedBox3d kBox(Eigen::Vector3d(-60, -60, -60), Eigen::Vector3d(60, 60, 60));
constexpr double kSpacing = 2.0;

/// Sections of two balls: label 1 around (-9,0,0), label 2 around (11,2,1), which do not touch.
Section balls(const Eigen::Isometry3d& frame) {
  std::vector<test::Disc> discs;
  const auto add = [&](const Eigen::Vector3d& centre, double radius, Label label) {
    const Eigen::Vector3d local = frame.inverse() * centre;
    const double r2 = radius * radius - local.z() * local.z();
    if (r2 > 0.25) discs.push_back({local.head<2>(), std::sqrt(r2), label});
  };
  add({-9, 0, 0}, 9.0, 1);
  add({11, 2, 1}, 8.0, 2);
  return test::section_of_discs(frame, discs);
}

struct Scan {
  CellComplex cells{kBox, 0.1};
  SampleOctree octree{kBox.min(), kSpacing};
  std::unique_ptr<FieldEvaluator> evaluator = make_cpu_evaluator(1);
  std::size_t evaluated = 0;

  void add(const Section& section) {
    const auto delta = cells.insert(section);
    if (delta) octree.note(cells, *delta);
  }
  SampleOctree::Change update(int threads) {
    auto change = octree.update(cells, nullptr, *evaluator, {}, threads);
    REQUIRE(change);
    evaluated += change->evaluated;
    return *change;
  }
};

std::vector<Section> slices(unsigned seed, int count) {
  std::mt19937 rng(seed);
  std::vector<Section> result;
  for (int i = 0; i < count; ++i) result.push_back(balls(test::random_frame(rng, 9)));
  return result;
}

/// Every brick of the box that has samples.
std::map<BrickCoord, const Brick*> all_bricks(const SampleOctree& octree) {
  std::map<BrickCoord, const Brick*> bricks;
  for (std::int32_t z = -2; z < 10; ++z)
    for (std::int32_t y = -2; y < 10; ++y)
      for (std::int32_t x = -2; x < 10; ++x)
        if (const Brick* brick = octree.find({x, y, z})) bricks[{x, y, z}] = brick;
  return bricks;
}

Label label_at(const SampleOctree& octree, int x, int y, int z) {
  const Brick* brick = octree.find({x >> 3, y >> 3, z >> 3});
  return brick == nullptr ? kNotSampled : brick->label[static_cast<std::size_t>(sample_index(x & 7, y & 7, z & 7))];
}

/// Differences in samples and shares; labels without a share may be missing from a palette.
std::size_t differences(const SampleOctree& a, const SampleOctree& b) {
  const auto left = all_bricks(a);
  const auto right = all_bricks(b);
  std::size_t count = left.size() == right.size() ? 0 : 1;
  for (const auto& [coord, brick] : left) {
    const auto other = right.find(coord);
    if (other == right.end() || brick->label != other->second->label) {
      ++count;
      continue;
    }
    for (int i = 0; i < kBrickSamples; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (brick->label[at] == kNotSampled) continue;
      std::map<Label, float> shares;
      for (std::size_t row = 0; row < brick->palette.size(); ++row)
        shares[brick->palette[row]] += brick->share[row * kBrickSamples + at];
      for (std::size_t row = 0; row < other->second->palette.size(); ++row)
        shares[other->second->palette[row]] -= other->second->share[row * kBrickSamples + at];
      for (const auto& [label, difference] : shares) count += difference != 0.0f;
    }
  }
  return count;
}

}  // namespace

TEST_CASE("octree: samples after single insertions equal those of one batch, to the last bit, with 1 or 2 threads") {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const auto sections = slices(seed, 14);
    Scan batch;
    Scan online;
    for (const Section& section : sections) {
      batch.add(section);
      online.add(section);
      online.update(2);
    }
    batch.update(1);
    CHECK(batch.octree.sample_count() == online.octree.sample_count());
    CHECK(differences(batch.octree, online.octree) == 0);
  }
}

TEST_CASE(
    "octree: around every mixed lattice edge the four cells are sampled, and no surface of a dense grid is missed") {
  for (unsigned seed = 10; seed < 14; ++seed) {
    Scan scan;
    for (const Section& section : slices(seed, 12)) scan.add(section);
    scan.update(2);
    // The dense grid: every lattice point of the box, without smoothing.
    std::vector<CellFace> faces;
    FieldBatch batch;
    std::map<std::uint32_t, std::uint32_t> packed;
    constexpr int kSide = 61;
    std::vector<Label> dense(kSide * kSide * kSide);
    for (int i = 0; i < kSide * kSide * kSide; ++i) {
      const Eigen::Vector3d p =
          kBox.min() + kSpacing * Eigen::Vector3d(i % kSide, i / kSide % kSide, i / (kSide * kSide));
      const CellId cell = scan.cells.locate(p);
      const auto id = static_cast<std::uint32_t>(cell);
      if (!packed.contains(id)) {
        scan.cells.faces(cell, faces);
        packed[id] = batch.cells.add(faces, scan.cells.centre(cell));
      }
      dense[static_cast<std::size_t>(i)] = batch.cells.labels(packed[id])[0];
      if (batch.cells.constant(packed[id])) continue;
      batch.clear_points();
      const std::uint32_t block = batch.add_points(packed[id], {&p, 1});
      REQUIRE(scan.evaluator->evaluate(batch));
      float best = -1;
      for (std::uint32_t slot = 0; slot < batch.cells.labels(packed[id]).size(); ++slot)
        if (batch.row(block, slot)[0] > best) {
          best = batch.row(block, slot)[0];
          dense[static_cast<std::size_t>(i)] = batch.cells.labels(packed[id])[slot];
        }
    }
    std::size_t missed = 0;
    std::size_t mixed = 0;
    std::size_t open = 0;
    for (int z = 1; z + 2 < kSide; ++z)
      for (int y = 1; y + 2 < kSide; ++y)
        for (int x = 1; x + 2 < kSide; ++x)
          for (int axis = 0; axis < 3; ++axis) {
            const int step[3] = {axis == 0, axis == 1, axis == 2};
            const auto at = static_cast<std::size_t>(x + kSide * (y + kSide * z));
            const auto next = static_cast<std::size_t>(x + step[0] + kSide * (y + step[1] + kSide * (z + step[2])));
            const Label a = label_at(scan.octree, x, y, z);
            const Label b = label_at(scan.octree, x + step[0], y + step[1], z + step[2]);
            if (dense[at] != dense[next]) {
              ++mixed;
              missed += a == kNotSampled || b == kNotSampled;
            }
            if (a == b || a == kNotSampled || b == kNotSampled) continue;
            // The eight corners beside either end of the edge.
            for (int v = -1; v <= 1; ++v)
              for (int u = -1; u <= 1; ++u) {
                const int o[3] = {axis == 0 ? 0 : u, axis == 1 ? 0 : (axis == 0 ? u : v), axis == 2 ? 0 : v};
                open += label_at(scan.octree, x + o[0], y + o[1], z + o[2]) == kNotSampled;
                open +=
                    label_at(scan.octree, x + step[0] + o[0], y + step[1] + o[1], z + step[2] + o[2]) == kNotSampled;
              }
          }
    MESSAGE(mixed << " mixed edges, " << scan.octree.sample_count() << " of " << kSide * kSide * kSide << " samples");
    CHECK(missed == 0);
    CHECK(open == 0);
    CHECK(scan.octree.sample_count() < kSide * kSide * kSide / 2);
  }
}

TEST_CASE("octree: a slice through one ball takes no new samples of the other") {
  Scan scan;
  for (const Section& section : slices(3, 12)) scan.add(section);
  scan.update(1);
  const std::size_t before = scan.octree.sample_count();
  // Separates the balls: the last plane's cells left of x = 0 are not touched by what is right of x = 4.
  scan.add(balls(test::frame_at({1, 0, 0}, {1, 0, 0})));
  scan.update(1);
  Section right = balls(test::frame_at({11, 2, 1}, {0.1, 0.2, 1}));
  std::erase_if(right.edges, [](const SectionEdge& e) { return e.left != 2; });
  for (SectionEdge& e : right.edges) e.right = kUnknown;  // seen: the inside of ball 2 and nothing else
  right.border = kUnknown;
  scan.add(right);
  const auto change = scan.update(1);
  CHECK(change.evaluated < before / 2);
  for (const BrickCoord& brick : change.bricks) CHECK(kBox.min().x() + kSpacing * kBrickSize * (brick.x + 1) > 0.0);
}
