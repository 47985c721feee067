#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "core/cells/cell_complex.h"
#include "tests/support/planes.h"

namespace sonoloft {
namespace {

constexpr double kGap_mm = 0.01;

CellComplex make_complex() {
  return {Eigen::AlignedBox3d(Eigen::Vector3d::Constant(-100), Eigen::Vector3d::Constant(100)), kGap_mm};
}

bool is_constant(const std::vector<CellFace>& faces) {
  return faces.front().label != kBeyondFace &&
         std::all_of(faces.begin(), faces.end(), [&](const CellFace& f) { return f.label == faces.front().label; });
}

/// How far a cell reaches to either side of a plane; the smaller one.
double crossed_mm(const std::vector<CellFace>& faces, const Eigen::Isometry3d& plane) {
  const Eigen::Isometry3d to_plane = plane.inverse();
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const CellFace& face : faces)
    for (const FaceEdge& e : *face.polygon) {
      const double z = (to_plane * (*face.image_to_reference * Eigen::Vector3d(e.a.x(), e.a.y(), 0))).z();
      lowest = std::min(lowest, z);
      highest = std::max(highest, z);
    }
  return std::min(-lowest, highest);
}

}  // namespace

TEST_CASE("cells: slices that say nothing new cut nothing") {
  std::mt19937 rng(3);
  CellComplex complex = make_complex();
  for (int i = 0; i < 30; ++i) {
    const auto delta = complex.insert(test::section_of_discs(test::random_frame(rng, 40), {}));
    REQUIRE(delta);
    CHECK(delta->reached == 1);
    CHECK(delta->divided.empty());
    CHECK(delta->upper.empty());
  }
  CHECK(complex.cell_count() == 1);
  CHECK(complex.validate() == "");
}

TEST_CASE("cells: whatever the order, planes cut all cells of more than one label, and few others") {
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u}) {
    std::mt19937 rng(seed);
    std::vector<Section> sections;
    for (int i = 0; i < 40; ++i) {  // every other slice shows a disc
      std::vector<test::Disc> discs;
      if (i % 2 == 0) discs.push_back({{0, 0}, 12, 1});
      sections.push_back(test::section_of_discs(test::random_frame(rng, 20), discs));
    }
    std::shuffle(sections.begin(), sections.end(), rng);
    CellComplex complex = make_complex();
    for (const Section& section : sections) REQUIRE(complex.insert(section));
    REQUIRE(complex.validate() == "");
    std::size_t mixed = 0, crossed = 0;
    std::vector<CellFace> faces;
    for (std::uint32_t cell = 0; cell < complex.cell_count(); ++cell) {
      complex.faces(CellId{cell}, faces);
      if (is_constant(faces)) continue;
      ++mixed;
      for (const Section& section : sections) crossed += crossed_mm(faces, section.image_to_reference) > 1.01 * kGap_mm;
    }
    // 40 planes in general position cut space into about 40^3 / 6 cells.
    MESSAGE(complex.cell_count(), " cells, ", mixed, " of more than one label, ", crossed, " crossed by a plane");
    CHECK(crossed == 0);
    CHECK(mixed > 200);
    CHECK(complex.cell_count() < 40 * 40 * 40 / 6 / 2);
  }
}

}  // namespace sonoloft
