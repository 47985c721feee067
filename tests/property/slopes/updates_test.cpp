#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <random>

#include "core/slopes/contour_slopes.h"
#include "tests/support/planes.h"
#include "tests/support/slopes/ellipsoid.h"

namespace sonoloft {
namespace {

constexpr double kFeature = 1.7;

/// A slice of a body of two labels, or one that saw discs only.
Section random_section(std::mt19937& rng) {
  const Eigen::Isometry3d frame = test::random_frame(rng, 25);
  const auto kind = std::uniform_int_distribution<int>(0, 5)(rng);
  if (kind > 1) return test::Ellipsoid{{50, 35, 25}}.cut(frame, 120);
  Section discs = test::section_of_discs(frame, {{{-8, 3}, 14, 1}, {{20, 0}, 10, 2}}, 40);
  if (kind == 1) test::bound_view(discs);
  return discs;
}

/// Cells and who follows them, some after every step and one at the end only.
struct Followed {
  CellComplex cells{{Eigen::Vector3d::Constant(-120), Eigen::Vector3d::Constant(120)}, 0.05};
  ContourSlopes always{kFeature}, sometimes{kFeature}, at_end{kFeature};
  std::vector<CellId> noted;  ///< since the last update

  void note(const CellComplex::Delta& delta) {
    for (ContourSlopes* slopes : {&always, &sometimes, &at_end}) slopes->note(delta);
    noted.insert(noted.end(), delta.divided.begin(), delta.divided.end());
    noted.insert(noted.end(), delta.upper.begin(), delta.upper.end());
  }
  /// Not every cell is cut, as when slices have nothing new to say.
  [[nodiscard]] CellComplex::PartWidth width(std::uint64_t seed) const {
    return
        [seed](CellId cell) { return (static_cast<std::uint64_t>(cell) * 2654435761u + seed) % 7u == 0 ? 1e9 : 0.0; };
  }
  void insert(std::mt19937& rng) {
    const auto delta = cells.insert(random_section(rng), width(rng()));
    if (delta) note(*delta);
  }
  void withdraw(std::mt19937& rng) {
    const std::vector<SliceId> held = cells.slices();
    const SliceId slice = held[std::uniform_int_distribution<std::size_t>(0, held.size() - 1)(rng)];
    const CellComplex::Withdrawal withdrawal = cells.withdraw(slice);
    for (ContourSlopes* slopes : {&always, &sometimes, &at_end}) slopes->note(slice, withdrawal);
    for (const auto& region : withdrawal.regions) noted.push_back(region.restored);
    const std::uint64_t seed = rng();
    for (const SliceId other : cells.slices()) note(cells.insert_again(other, withdrawal, width(seed)));
  }
};

void check_same(const Followed& f, const ContourSlopes& a, const ContourSlopes& b) {
  for (const SliceId slice : f.cells.slices()) {
    REQUIRE(a.bends(slice).size() == f.cells.section(slice).points.size());
    CHECK(std::equal(a.bends(slice).begin(), a.bends(slice).end(), b.bends(slice).begin(), b.bends(slice).end()));
  }
}

TEST_CASE("slopes: they do not depend on when they were brought up to date, nor on threads") {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    std::mt19937 rng(seed);
    Followed f;
    for (int step = 0; step < 26; ++step) {
      if (step > 8 && step % 4 == 0)
        f.withdraw(rng);
      else
        f.insert(rng);
      (void)f.always.update(f.cells, 1);
      if (step % 5 == 2) (void)f.sometimes.update(f.cells, 2);
    }
    (void)f.sometimes.update(f.cells, 2);
    (void)f.at_end.update(f.cells, 1);
    check_same(f, f.always, f.sometimes);
    check_same(f, f.always, f.at_end);
  }
}

/// [#slices] bends of those held.
std::vector<std::vector<VertexBend>> all_bends(const Followed& f) {
  std::vector<std::vector<VertexBend>> all;
  for (const SliceId slice : f.cells.slices()) {
    const auto bends = f.always.bends(slice);
    all.resize(static_cast<std::size_t>(slice) + 1);
    all.back().assign(bends.begin(), bends.end());
  }
  return all;
}

/// Whether a cell has a piece of an edge on its walls one of whose bends is not what it was.
bool has_changed_wall(const Followed& f, CellId cell, const std::vector<std::vector<VertexBend>>& before) {
  std::vector<CellFace> faces;
  f.cells.faces(cell, faces);
  return std::any_of(faces.begin(), faces.end(), [&](const CellFace& face) {
    const auto slice = f.cells.slice_of(face.plane);
    if (!slice || static_cast<std::size_t>(*slice) >= before.size()) return false;
    const auto& was = before[static_cast<std::size_t>(*slice)];
    const auto& edges = f.cells.section(*slice).edges;
    if (was.empty()) return false;
    const auto now = f.always.bends(*slice);
    return std::any_of(face.polygon->begin(), face.polygon->end(), [&](const FaceEdge& e) {
      if (e.source == kNoSource) return false;
      const SectionEdge& edge = edges[e.source];
      return now[edge.a] != was[edge.a] || now[edge.b] != was[edge.b];
    });
  });
}

TEST_CASE("slopes: every cell with a wall whose bends changed is told, and not nearly all cells") {
  std::size_t told = 0, there = 0, changed_beside = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    std::mt19937 rng(100 + seed);
    Followed f;
    for (int step = 0; step < 30; ++step) {
      const auto before = all_bends(f);
      f.noted.clear();
      if (step > 8 && step % 5 == 0)
        f.withdraw(rng);
      else
        f.insert(rng);
      const std::vector<CellId> affected = f.always.update(f.cells, 1);
      CHECK(std::is_sorted(affected.begin(), affected.end()));
      std::sort(f.noted.begin(), f.noted.end());
      for (std::uint32_t cell = 0; cell < f.cells.cell_bound(); ++cell) {
        if (std::binary_search(f.noted.begin(), f.noted.end(), CellId{cell})) continue;
        const bool is_told = std::binary_search(affected.begin(), affected.end(), CellId{cell});
        const bool has_changed = has_changed_wall(f, CellId{cell}, before);
        changed_beside += has_changed ? 1 : 0;
        CHECK((is_told || !has_changed));
      }
      if (step > 20) {
        told += affected.size();
        there += f.cells.cell_count();
      }
    }
  }
  MESSAGE(changed_beside, " walls changed beside cells that were cut; ", told, " told of ", there);
  CHECK(changed_beside > 100);
  CHECK(told < there / 2);
}

}  // namespace
}  // namespace sonoloft
