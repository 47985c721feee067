#include <doctest/doctest.h>

#include <numbers>

#include "core/slopes/contour_slopes.h"
#include "tests/support/planes.h"
#include "tests/support/slopes/sloped_slices.h"

namespace sonoloft {
namespace {

constexpr std::uint32_t kSpoke = 60, kRim = 80;  ///< edges

/// A disc of three sectors with labels 1, 2, 3 around point 0, moved by `shift`.
Section sectors(double height, const Eigen::Vector2d& shift) {
  Section section;
  section.image_to_reference = test::frame_at({0, 0, height}, {0, 0, 1});
  section.points.push_back(shift);
  const auto add = [&](std::uint32_t from, double radius, double angle, Label left, Label right) {
    const auto to = static_cast<std::uint32_t>(section.points.size());
    section.points.push_back(shift + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    section.edges.push_back({from, to, left, right});
    return to;
  };
  std::vector<std::uint32_t> tips;
  for (int k = 0; k < 3; ++k) {
    std::uint32_t at = 0;
    for (std::uint32_t i = 1; i <= kSpoke; ++i)
      at = add(at, 30.0 * i / kSpoke, 2 * std::numbers::pi * k / 3, static_cast<Label>(k + 1),
               static_cast<Label>((k + 2) % 3 + 1));
    tips.push_back(at);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    std::uint32_t at = tips[k];
    for (std::uint32_t i = 1; i < kRim; ++i)
      at = add(at, 30, 2 * std::numbers::pi * (static_cast<double>(k) + static_cast<double>(i) / kRim) / 3,
               static_cast<Label>(k + 1), kOutside);
    section.edges.push_back({at, tips[(k + 1) % 3], static_cast<Label>(k + 1), kOutside});
  }
  return section;
}

TEST_CASE("slopes: labels that lean together move alike on all their borders and where three of them meet") {
  const Eigen::Vector2d lean(0.2, -0.1);
  test::SlopedSlices s(0.9);
  s.add(sectors(-4, -4 * lean));
  const SliceId middle = s.add(sectors(0, {0, 0}));
  s.add(sectors(4, 4 * lean));
  (void)s.slopes.update(s.cells, 1);
  const Section& section = s.cells.section(middle);
  double worst = 0, worst_at_junction = 0;
  for (std::size_t i = 0; i < section.points.size(); ++i) {
    const VertexBend& bend = s.slopes.bends(middle)[i];
    const Eigen::Vector2d outward = bend.outward.cast<double>();
    const bool at_centre = i == 0, at_rim = i % kSpoke == 0 && i <= 3 * kSpoke && i > 0;
    if (at_centre || at_rim) {
      CHECK(bend.curvature_per_mm == 0);
      worst_at_junction = std::max(worst_at_junction, (bend.slope * outward - lean).norm());
    } else if (section.points[i].norm() > 5 && section.points[i].norm() < 25) {
      worst = std::max(worst, std::abs(bend.slope - outward.dot(lean)));
    }
  }
  MESSAGE("slopes off by ", worst, ", at junctions by ", worst_at_junction);
  CHECK(worst < 0.005);
  CHECK(worst_at_junction < 0.1);  // of 0.22: beside it the third label's depth is not that of a plane wall
}

TEST_CASE("slopes: swapping two labels moves nothing the other way") {
  const auto displacements = [](bool swapped) {
    test::SlopedSlices s(0.9);
    std::vector<SliceId> ids;
    for (const double height : {-4.0, 0.0, 4.0}) {
      Section section = sectors(height, {0.3 * height, 0});
      if (swapped)
        for (SectionEdge& e : section.edges)
          for (Label* label : {&e.left, &e.right})
            if (*label == 1 || *label == 2) *label = static_cast<Label>(3 - *label);
      ids.push_back(s.add(section));
    }
    (void)s.slopes.update(s.cells, 1);
    std::vector<Eigen::Vector2f> moves;
    for (const VertexBend& bend : s.slopes.bends(ids[1]))
      moves.push_back((bend.slope + bend.curvature_per_mm) * bend.outward);
    return moves;
  };
  const auto moves = displacements(false), swapped = displacements(true);
  for (std::size_t i = 0; i < moves.size(); ++i) CHECK((moves[i] - swapped[i]).norm() < 1e-3f);
}

TEST_CASE("slopes: a contour that ends at something unknown keeps its slope to its last point") {
  const auto half = [](double height) {  // the half disc below the x axis was not seen
    Section section =
        test::section_of_discs(test::frame_at({0, 0, height}, {0, 0, 1}), {{{0, 0}, 30 - height, 1}}, 200);
    for (std::uint32_t i = 100; i < 200; ++i) section.edges[i].right = kUnknown;
    section.edges.push_back({0, 100, kUnknown, 1});
    for (std::uint32_t i = 100; i < 200; ++i) section.edges[i].left = kOutside;
    return section;
  };
  test::SlopedSlices s(1.5);
  s.add(half(-5));
  const SliceId middle = s.add(half(0));
  s.add(half(5));
  (void)s.slopes.update(s.cells, 1);
  const auto bends = s.slopes.bends(middle);
  for (std::size_t i = 0; i <= 100; ++i) CHECK(bends[i].slope == doctest::Approx(-1).epsilon(0.02));
  for (std::size_t i = 101; i < 200; ++i) CHECK(bends[i] == VertexBend{});
}

}  // namespace
}  // namespace sonoloft
