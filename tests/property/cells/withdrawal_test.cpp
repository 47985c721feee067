#include <doctest/doctest.h>

#include <random>

#include "core/cells/cell_complex.h"
#include "core/field/reference.h"
#include "tests/support/planes.h"

namespace sonoloft {
namespace {

const Eigen::AlignedBox3d kBox(Eigen::Vector3d::Constant(-60), Eigen::Vector3d::Constant(60));
constexpr double kGap_mm = 0.05;

/// Discs of two labels; every third slice sees nothing but them, every fourth nothing at all of them.
Section random_slice(std::mt19937& rng, int i) {
  std::uniform_real_distribution<double> uniform(-15, 15);
  std::vector<test::Disc> discs;
  if (i % 4 != 3) discs = {{{uniform(rng) - 16, uniform(rng)}, 9, 1}, {{uniform(rng) + 16, uniform(rng)}, 8, 2}};
  Section section = test::section_of_discs(test::random_frame(rng, 20), discs);
  if (i % 3 == 2 && !discs.empty()) test::bound_view(section);
  return section;
}

void take_back(CellComplex& cells, SliceId slice) {
  const CellComplex::Withdrawal where = cells.withdraw(slice);
  for (const SliceId held : cells.slices()) (void)cells.insert_again(held, where);
}

/// The largest difference of any share of two complexes at random points of the box.
double largest_difference(const CellComplex& a, const CellComplex& b, std::mt19937& rng, int points) {
  std::uniform_real_distribution<double> uniform(-40, 40);
  std::vector<CellFace> faces;
  double largest = 0;
  for (int i = 0; i < points; ++i) {
    const Eigen::Vector3d p(uniform(rng), uniform(rng), uniform(rng));
    ReferenceShares shares[2];
    for (int k = 0; k < 2; ++k) {
      const CellComplex& cells = k == 0 ? a : b;
      cells.faces(cells.locate(p), faces);
      shares[k] = reference_shares(faces, p, 1e-9);
    }
    for (const Label label : {Label{0}, Label{1}, Label{2}, kUnknown})
      largest = std::max(largest, std::abs(shares[0].share(label) - shares[1].share(label)));
  }
  return largest;
}

}  // namespace

TEST_CASE("cells: a slice withdrawn leaves the field of the same slices without it") {
  double largest = 0;
  std::size_t removed = 0;
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
    std::mt19937 rng(seed);
    std::vector<Section> sections;
    for (int i = 0; i < 16; ++i) sections.push_back(random_slice(rng, i));
    for (const std::uint32_t gone : {0u, 3u, 7u, 15u}) {
      CellComplex cells(kBox, kGap_mm), expected(kBox, kGap_mm);
      for (std::uint32_t i = 0; i < sections.size(); ++i) {
        REQUIRE(cells.insert(sections[i]));
        if (i != gone) REQUIRE(expected.insert(sections[i]));
      }
      const CellComplex::Withdrawal where = cells.withdraw(SliceId{gone});
      REQUIRE(cells.validate() == "");
      for (const SliceId held : cells.slices()) (void)cells.insert_again(held, where);
      removed += where.removed.size();
      CHECK(cells.slices().size() == sections.size() - 1);
      CHECK(cells.validate() == "");
      largest = std::max(largest, largest_difference(cells, expected, rng, 200));
    }
  }
  MESSAGE(removed << " cells made anew; shares differ by at most " << largest);
  CHECK(removed > 1000);
  CHECK(largest < 1e-6);
}

TEST_CASE("cells: withdrawing the last slice of a stack clips as many edges after 64 slices as after 8") {
  std::vector<std::uint32_t> clipped;
  for (const int count : {8, 64}) {
    CellComplex cells(kBox, kGap_mm);
    for (int i = 0; i < count; ++i)
      REQUIRE(cells.insert(test::section_of_discs(test::frame_at({0, 0, -40.0 + 80.0 * i / count}, {0, 0, 1}),
                                                  {{{-16, 0}, 9, 1}, {{16, 0}, 8, 2}})));
    clipped.push_back(cells.withdraw(cells.slices().back()).work.edges_clipped);
    CHECK(cells.validate() == "");
  }
  CHECK(clipped[0] > 0);
  CHECK(clipped[1] == clipped[0]);
}

TEST_CASE("cells: withdrawing every slice in any order leaves an empty box") {
  std::mt19937 rng(9);
  CellComplex cells(kBox, kGap_mm);
  for (int i = 0; i < 12; ++i) REQUIRE(cells.insert(random_slice(rng, i)));
  std::vector<SliceId> slices = cells.slices();
  std::shuffle(slices.begin(), slices.end(), rng);
  for (const SliceId slice : slices) {
    take_back(cells, slice);
    REQUIRE(cells.validate() == "");
  }
  CHECK(cells.cell_count() == 1);
  CHECK(cells.slices().empty());
}

TEST_CASE("cells: a withdrawal makes anew only cells that the slice had cut") {
  CellComplex cells(kBox, kGap_mm);
  REQUIRE(cells.insert(test::section_of_discs(test::frame_at({0, 0, 0}, {1, 0, 0}), {{{0, 0}, 10, 1}})));
  Section right = test::section_of_discs(test::frame_at({30, 0, 0}, {0, 0, 1}), {{{0, 0}, 8, 1}});
  test::bound_view(right);
  REQUIRE(cells.insert(right));
  Section left = test::section_of_discs(test::frame_at({-30, 0, 0}, {0, 1, 0}), {{{0, 0}, 8, 1}});
  test::bound_view(left);
  REQUIRE(cells.insert(left));
  REQUIRE(cells.cell_count() == 4);
  const CellId beside = cells.locate({-30, 5, 0});
  const CellComplex::Withdrawal where = cells.withdraw(SliceId{1});
  CHECK(where.removed.size() == 2);
  CHECK(where.regions.size() == 1);
  for (const SliceId held : cells.slices()) CHECK(cells.insert_again(held, where).lower.empty());
  CHECK(cells.cell_count() == 3);
  CHECK(cells.locate({-30, 5, 0}) == beside);
  CHECK(cells.validate() == "");
}

}  // namespace sonoloft
