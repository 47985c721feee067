#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <random>
#include <set>

#include "core/mesh/surface_extractor.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/mesh/synthetic_lattice.h"

namespace sonoloft::test {
namespace {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same(const MeshChunk& a, const MeshChunk& b) {
  return a.coord == b.coord && same_bytes(a.positions, b.positions) && same_bytes(a.vertex_keys, b.vertex_keys) &&
         same_bytes(a.triangles, b.triangles) && same_bytes(a.label_front, b.label_front) &&
         same_bytes(a.label_back, b.label_back);
}

bool same(const MeshSnapshot& a, const MeshSnapshot& b) {
  return std::equal(a.chunks.begin(), a.chunks.end(), b.chunks.begin(), b.chunks.end(),
                    [](const auto& x, const auto& y) { return same(*x, *y); });
}

/// Coordinates whose chunk is in only one of two snapshots or differs.
std::vector<BrickCoord> difference(const MeshSnapshot& a, const MeshSnapshot& b) {
  std::map<BrickCoord, std::pair<const MeshChunk*, const MeshChunk*>> chunks;
  for (const auto& chunk : a.chunks) chunks[chunk->coord].first = chunk.get();
  for (const auto& chunk : b.chunks) chunks[chunk->coord].second = chunk.get();
  std::vector<BrickCoord> result;
  for (const auto& [coord, pair] : chunks)
    if (!pair.first || !pair.second || !same(*pair.first, *pair.second)) result.push_back(coord);
  return result;
}

MeshSnapshot extract(const SyntheticLattice& lattice, int threads) {
  SurfaceExtractor extractor;
  extractor.update(lattice, lattice.bricks(), threads);
  return extractor.snapshot();
}

struct RandomEdits {
  std::mt19937 random;
  SyntheticLattice lattice;
  ShareField base;
  int size, labels;

  int number(int least, int most) { return std::uniform_int_distribution(least, most)(random); }

  /// A box of new noise, of the field as it was, of one label or of outside; sometimes one point, sometimes nothing
  /// new.
  std::vector<BrickCoord> edit() {
    const Eigen::Vector3i lower(number(1, size - 2), number(1, size - 2), number(1, size - 2));
    const Eigen::Vector3i upper = lower + Eigen::Vector3i(number(0, 8), number(0, 8), number(0, 8));
    const int kind = number(0, 3);
    if (kind == 0) return lattice.edit(lower, upper, noise_field(random(), number(0, 1)));
    if (kind == 1) return lattice.edit(lower, upper, base);
    const auto label = static_cast<std::size_t>(kind == 2 ? 0 : number(0, labels - 1));
    const float strength = static_cast<float>(number(1, 9));
    return lattice.edit(lower, upper, [=](Eigen::Vector3i, std::span<float> shares) { shares[label] = strength; });
  }
};

void check_edits(std::uint32_t seed, int size, int labels, const ShareField& base, int rounds) {
  RandomEdits edits{std::mt19937(seed), SyntheticLattice(size, labels, base), base, size, labels};
  SurfaceExtractor extractor;
  extractor.update(edits.lattice, edits.lattice.bricks(), 2);
  std::size_t shared = 0, kept_calls = 0;
  for (int round = 0; round < rounds; ++round) {
    const MeshSnapshot before = extractor.snapshot();
    const auto changed = edits.edit();
    const auto reported = extractor.update(edits.lattice, changed, 1 + round % 2);
    const MeshSnapshot after = extractor.snapshot();
    CHECK(same(after, extract(edits.lattice, 1)));
    CHECK(reported == difference(before, after));
    std::set<const MeshChunk*> old;
    for (const auto& chunk : before.chunks) old.insert(chunk.get());
    const auto kept = std::count_if(after.chunks.begin(), after.chunks.end(),
                                    [&](const auto& chunk) { return old.contains(chunk.get()); });
    std::size_t appeared_or_changed = 0;
    for (const auto& chunk : after.chunks)
      appeared_or_changed += std::binary_search(reported.begin(), reported.end(), chunk->coord);
    CHECK(static_cast<std::size_t>(kept) + appeared_or_changed == after.chunks.size());
    shared += static_cast<std::size_t>(kept);
    kept_calls += after.chunks.size();
  }
  MESSAGE("seed ", seed, ": ", shared, " of ", kept_calls, " chunks shared with the snapshot before");
  CHECK(shared > 0);
}

TEST_CASE("mesh: 50 local edits of noise end in the bytes of one full extraction, and name exactly what changed") {
  check_edits(11, 32, 5, noise_field(5, 1), 50);
}

TEST_CASE("mesh: 50 local edits of spheres end in the bytes of one full extraction, and name exactly what changed") {
  check_edits(12, 40, 3, spheres_field({{{17, 20, 20}, 12.5}, {{27.5, 21, 19}, 9.3}}), 50);
}

TEST_CASE("mesh: emptying the lattice empties the mesh, and filling it again brings the same bytes back") {
  const ShareField field = sphere_field({12, 12, 12}, 8.5);
  SyntheticLattice lattice(24, 2, field);
  SurfaceExtractor extractor;
  extractor.update(lattice, lattice.bricks(), 1);
  const MeshSnapshot before = extractor.snapshot();
  const Eigen::Vector3i lower = Eigen::Vector3i::Zero(), upper = Eigen::Vector3i::Constant(24);
  const auto gone = extractor.update(lattice, lattice.edit(lower, upper, [](auto, auto shares) { shares[0] = 1; }), 2);
  CHECK(gone.size() == before.chunks.size());
  CHECK(extractor.snapshot().chunks.empty());
  CHECK(extractor.counters().leaves == 0);
  extractor.update(lattice, lattice.edit(lower, upper, field), 2);
  CHECK(same(before, extractor.snapshot()));
}

TEST_CASE("mesh: one thread and two give the same bytes") {
  const SyntheticLattice lattice(40, 5, noise_field(21, 1));
  CHECK(same(extract(lattice, 1), extract(lattice, 2)));
}

TEST_CASE("mesh: a vertex has one key and one position in all chunks, and no other vertex has its key") {
  const Eigen::Vector3d origin(-312.7, 1049.1, 77.3);
  const SyntheticLattice lattice(32, 5, noise_field(31, 1), origin, 0.37);
  std::map<std::uint64_t, Eigen::Vector3f> position_of;
  std::size_t repeated = 0;
  const MeshSnapshot snapshot = extract(lattice, 1);
  for (const auto& chunk : snapshot.chunks) {
    std::set<std::uint64_t> keys(chunk->vertex_keys.begin(), chunk->vertex_keys.end());
    CHECK(keys.size() == chunk->vertex_keys.size());
    for (std::size_t i = 0; i < chunk->positions.size(); ++i) {
      const auto [at, fresh] = position_of.try_emplace(chunk->vertex_keys[i], chunk->positions[i]);
      repeated += !fresh;
      REQUIRE(std::memcmp(at->second.data(), chunk->positions[i].data(), sizeof(Eigen::Vector3f)) == 0);
    }
  }
  MESSAGE(position_of.size(), " vertices, repeated ", repeated, " times");
  CHECK(repeated > position_of.size() / 20);
  CHECK(snapshot.indexed().positions.size() == position_of.size());
}

TEST_CASE("mesh: a small edit costs what it touches") {
  SyntheticLattice lattice(64, 2, sphere_field({32, 32, 32}, 27.3));
  SurfaceExtractor extractor;
  extractor.update(lattice, lattice.bricks(), 1);
  const std::size_t full = extractor.chunks_rebuilt();
  const Eigen::Vector3i point(32, 32, 59);  // on the sphere's top
  const auto changed = lattice.edit(point, point, [](Eigen::Vector3i, std::span<float> shares) { shares[1] = 0.2F; });
  REQUIRE(changed.size() == 8);  // SyntheticLattice does not look where in its brick a sample lies
  const auto reported = extractor.update(lattice, changed, 1);
  const std::size_t local = extractor.chunks_rebuilt();
  MESSAGE("full ", full, " chunks, local ", local, ", of them different ", reported.size());
  CHECK(extractor.counters().bricks_read <= 8);
  CHECK(local <= 20);
  CHECK(full > 200);
}

}  // namespace
}  // namespace sonoloft::test
