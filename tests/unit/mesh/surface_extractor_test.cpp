#include "core/mesh/surface_extractor.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <set>

#include "tests/support/mesh/mesh_check.h"
#include "tests/support/mesh/synthetic_lattice.h"

namespace sonoloft::test {
namespace {

SurfaceExtractor extracted(const SampleLattice& lattice, const std::vector<BrickCoord>& bricks) {
  SurfaceExtractor extractor;
  extractor.update(lattice, bricks, 1);
  return extractor;
}

/// Bricks put together by hand.
class HandLattice final : public SampleLattice {
 public:
  explicit HandLattice(std::vector<Brick> bricks) : bricks_(std::move(bricks)) {}
  [[nodiscard]] const Brick* find(BrickCoord coord) const override {
    const auto found = std::find_if(bricks_.begin(), bricks_.end(), [&](const Brick& b) { return b.coord == coord; });
    return found == bricks_.end() ? nullptr : &*found;
  }
  [[nodiscard]] std::span<const ContourPiece> contours(BrickCoord) const override { return contours_; }
  [[nodiscard]] Eigen::Vector3d origin_mm() const override { return Eigen::Vector3d::Zero(); }
  [[nodiscard]] double spacing_mm() const override { return 1; }

 private:
  std::vector<Brick> bricks_;
  std::vector<ContourPiece> contours_;
};

/// All outside but for one point; `share` is that of every label everywhere.
Brick one_point_brick(float share) {
  Brick brick{{0, 0, 0}, {}, {0, 1}, std::vector<float>(2 * kBrickSamples, share), {}, {}};
  brick.label.fill(kOutside);
  brick.label[sample_index(4, 4, 4)] = 1;
  return brick;
}

TEST_CASE("mesh: every vertex of a sphere is near the sphere, and every normal points out of it") {
  const Eigen::Vector3d centre(16.2, 15.7, 16.1), origin(100, -200, 50);
  const double radius = 12.3, spacing = 0.5;
  const SyntheticLattice lattice(32, 2, sphere_field(centre, radius), origin, spacing);
  const auto extractor = extracted(lattice, lattice.bricks());
  const IndexedMesh mesh = extractor.snapshot().indexed();
  std::vector<double> error;
  for (const auto& p : mesh.positions)
    error.push_back(std::abs(((p.cast<double>() - origin) / spacing - centre).norm() - radius));
  std::sort(error.begin(), error.end());
  MESSAGE("distance to the sphere in steps: median ", error[error.size() / 2], " 95 % ", error[error.size() * 19 / 20],
          " largest ", error.back());
  const double interpolated = 1 / (4 * radius);  // what trilinear samples of a distance may be off by
  const double clamped = 0.06;  // a vertex keeps away from the sides of its cell, even where the sphere
                                // only cuts off a corner of it
  CHECK(error[error.size() * 19 / 20] < 1.2 * interpolated);
  CHECK(error.back() < interpolated + clamped);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corner = [&](std::size_t i) {
      return Eigen::Vector3d(mesh.positions[mesh.triangles[t][i]].cast<double>());
    };
    const Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    const Eigen::Vector3d out = ((corner(0) - origin) / spacing - centre).normalized();
    CHECK(normal.dot(out) > 0.9);
    CHECK(mesh.label_front[t] == 0);
    CHECK(mesh.label_back[t] == 1);
  }
}

TEST_CASE("mesh: the smaller label is always in front, and every label encloses a positive volume") {
  const SyntheticLattice lattice(24, 5, noise_field(9, 1));
  const auto extractor = extracted(lattice, lattice.bricks());
  const IndexedMesh mesh = extractor.snapshot().indexed();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) REQUIRE(mesh.label_front[t] < mesh.label_back[t]);
  const MeshReport report = check_mesh(mesh);
  double sum = 0;
  for (const auto& [label, r] : report.labels) {
    CHECK((label == 0 ? -r.volume_mm3 : r.volume_mm3) > 100);
    sum += r.volume_mm3;
  }
  CHECK(std::abs(sum) < 0.01);
}

TEST_CASE("mesh: three labels meet in a line where their shares are equal") {
  // Three sectors about the line x = 12.3, y = 12.4 inside of a ball.
  const Eigen::Vector2d axis(12.3, 12.4);
  const auto field = [&](Eigen::Vector3i p, std::span<float> shares) {
    const double inside = 9 - (p.cast<double>() - Eigen::Vector3d(12, 12, 12)).norm();
    for (std::size_t i = 0; i < 3; ++i) {
      const double angle = 2 * M_PI * static_cast<double>(i) / 3 + 0.3;
      const Eigen::Vector2d away = p.head<2>().cast<double>() - axis;
      const double sector = away.dot(Eigen::Vector2d(std::cos(angle), std::sin(angle)));
      shares[i + 1] = static_cast<float>(inside + 0.2 * sector);
    }
  };
  const SyntheticLattice lattice(24, 4, field);
  const auto extractor = extracted(lattice, lattice.bricks());
  const IndexedMesh mesh = extractor.snapshot().indexed();
  CHECK(check_mesh(mesh).closed_manifold());
  std::vector<std::set<Label>> labels(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) labels[v].insert({mesh.label_front[t], mesh.label_back[t]});
  std::size_t on_line = 0;
  double largest = 0;
  for (std::size_t v = 0; v < labels.size(); ++v) {
    if (labels[v] != std::set<Label>{1, 2, 3}) continue;
    ++on_line;
    largest = std::max(largest, (mesh.positions[v].head<2>().cast<double>() - axis).norm());
  }
  MESSAGE(on_line, " vertices on the line, largest distance ", largest, " steps");
  CHECK(on_line >= 12);
  CHECK(largest < 0.01);
}

TEST_CASE("mesh: shares that are not numbers move vertices, but open nothing") {
  for (const float share : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 0.0F,
                            std::numeric_limits<float>::max()}) {
    const HandLattice lattice({one_point_brick(share)});
    const IndexedMesh mesh = extracted(lattice, {{0, 0, 0}}).snapshot().indexed();
    CHECK(mesh.triangles.size() == 12);
    CHECK(check_mesh(mesh).closed_manifold());
    CHECK(count_self_intersections(mesh) == 0);
    for (const auto& p : mesh.positions) CHECK((p - Eigen::Vector3f(4, 4, 4)).cwiseAbs().maxCoeff() < 1);
  }
}

TEST_CASE("mesh: cells with a corner that was not sampled do not count") {
  Brick brick = one_point_brick(0);
  brick.label[sample_index(3, 3, 3)] = kNotSampled;
  const auto open = extracted(HandLattice({brick}), {{0, 0, 0}});
  CHECK(open.counters().leaves == 7);
  CHECK(check_mesh(open.snapshot().indexed()).labels.at(1).boundary_edges == 6);
  brick.label.fill(kNotSampled);
  brick.label[sample_index(4, 4, 4)] = 1;
  const auto none = extracted(HandLattice({brick}), {{0, 0, 0}});
  CHECK(none.counters().leaves == 0);
  CHECK(none.snapshot().chunks.empty());
  CHECK(none.snapshot().indexed().positions.empty());
}

TEST_CASE("mesh: nothing changed, nothing done; bricks that do not exist are no news") {
  const SyntheticLattice lattice(24, 2, sphere_field({12, 12, 12}, 8.2));
  auto extractor = extracted(lattice, lattice.bricks());
  const MeshSnapshot before = extractor.snapshot();
  CHECK(extractor.update(lattice, {}, 2).empty());
  CHECK(extractor.counters().bricks_read == 0);
  CHECK(extractor.update(lattice, std::vector<BrickCoord>{{500, 0, 0}, {-7, 3, 1}}, 2).empty());
  CHECK(extractor.update(lattice, lattice.bricks(), 2).empty());
  CHECK(extractor.snapshot().chunks == before.chunks);  // the very same chunks
}

TEST_CASE("mesh: chunks are ascending, not empty, and a snapshot outlives its extractor") {
  MeshSnapshot snapshot;
  {
    const SyntheticLattice lattice(24, 3, waves_field(2));
    snapshot = extracted(lattice, lattice.bricks()).snapshot();
  }
  REQUIRE(snapshot.chunks.size() > 20);
  for (std::size_t i = 0; i < snapshot.chunks.size(); ++i) {
    const MeshChunk& chunk = *snapshot.chunks[i];
    CHECK(!chunk.triangles.empty());
    CHECK(chunk.label_front.size() == chunk.triangles.size());
    CHECK(chunk.label_back.size() == chunk.triangles.size());
    CHECK(chunk.vertex_keys.size() == chunk.positions.size());
    if (i > 0) CHECK(snapshot.chunks[i - 1]->coord < chunk.coord);
  }
  CHECK(check_mesh(snapshot.indexed()).closed_manifold());
}

TEST_CASE("mesh: far from 0 mm vertices stay apart, or the counters say that they do not") {
  const auto far = [](double origin_mm, double spacing_mm) {
    const SyntheticLattice lattice(24, 2, sphere_field({12.1, 11.9, 12.2}, 8.2),
                                   Eigen::Vector3d(origin_mm, -origin_mm, origin_mm), spacing_mm);
    const auto extractor = extracted(lattice, lattice.bricks());
    const IndexedMesh mesh = extractor.snapshot().indexed();
    const MeshReport report = check_mesh(mesh);
    CHECK(report.labels.at(1).closed_manifold());  // by index, always
    MESSAGE("origin ", origin_mm, " spacing ", spacing_mm, ": collapsed ", extractor.counters().collapsed_triangles,
            " degenerate ", report.degenerate_triangles);
    CHECK(extractor.counters().collapsed_triangles <= report.degenerate_triangles);
    return extractor.counters().collapsed_triangles;
  };
  CHECK(far(1e6, 1000) == 0);
  CHECK(far(1e6, 1) == 0);
  CHECK(far(1e4, 0.1) == 0);
  CHECK(far(1e6, 0.1) > 0);
}

TEST_CASE("mesh: bricks at negative coordinates are drawn like any others") {
  // The same ball moved by whole bricks: the same mesh but for the position.
  Brick brick = one_point_brick(0);
  const IndexedMesh here = extracted(HandLattice({brick}), {brick.coord}).snapshot().indexed();
  brick.coord = {-3, -1, -32768};
  const IndexedMesh there = extracted(HandLattice({brick}), {brick.coord}).snapshot().indexed();
  CHECK(here.triangles == there.triangles);
  REQUIRE(here.positions.size() == there.positions.size());
  for (std::size_t i = 0; i < here.positions.size(); ++i)
    CHECK((there.positions[i] - here.positions[i] - Eigen::Vector3f(-24, -8, -262144)).norm() < 0.02);
}

}  // namespace
}  // namespace sonoloft::test
