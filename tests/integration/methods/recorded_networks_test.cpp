#include <doctest/doctest.h>

#include <cmath>

#include "core/methods/medial_axis/medial_axis.h"
#include "core/methods/straight_skeleton/straight_skeleton.h"
#include "tests/support/mesh/contour_section.h"
#include "tests/support/recorded_slices.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

/// Of each slice the half on one side of a line through the middle of the data, the lines in all directions.
void see_halves(std::vector<TrackedSlice>& slices) {
  Eigen::AlignedBox3d data;
  for (const TrackedSlice& s : slices)
    for (const Eigen::Vector2d& p : s.points) data.extend(s.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0));
  const double reach = 0.6 * data.diagonal().norm();
  double angle = 0.7;
  for (TrackedSlice& s : slices) {
    const Eigen::Vector3d middle = s.image_to_reference.inverse(Eigen::Isometry) * data.center();
    const Eigen::Vector2d m = middle.head<2>(), d = reach * Eigen::Vector2d(std::cos(angle), std::sin(angle)),
                          e(-d.y(), d.x());
    s.field_of_view = {m - e, m + d - e, m + d + e, m + e};
    angle += 1.1;
  }
}

}  // namespace

TEST_CASE("methods: medial-axis keeps every recorded contour, closed around every label, and so does its fairing") {
  struct Set {
    std::string name;
    bool fairing;  ///< of the large ones it takes too long for a test
  };
  for (const Set& set : {Set{"contour/mousebrain.contour", true}, Set{"contour/ringc.contour", true},
                         Set{"csl/Heart-25-even-better.csl", true}, Set{"csl/Horsers.csl", false},
                         Set{"csl/Abdomen.csl", false}, Set{"csl/Vetebrae.csl", false}}) {
    const auto file = read_recorded_slices(set.name);
    if (!file) continue;
    const auto surfaces = medial_axis(file->slices, {set.fairing, 2});
    REQUIRE_MESSAGE(surfaces, surfaces.error().message);
    const ContourSection section = section_with(file->slices, *surfaces);
    MESSAGE(set.name, ": ", surfaces->triangles.size(), " triangles, ", section.text());
    CHECK(section.exact());
  }
}

TEST_CASE("methods: straight-skeleton keeps every recorded contour, of whole planes and of half planes, and closes") {
  for (const char* name : {"contour/mousebrain.contour", "contour/ringc.contour"}) {
    auto file = read_recorded_slices(name);
    if (!file) continue;
    const auto whole = straight_skeleton(file->slices, {false, 2}), axis = medial_axis(file->slices, {false, 2});
    REQUIRE(whole);
    REQUIRE(axis);
    CHECK(section_with(file->slices, *whole).exact());
    CHECK(whole->positions.size() == axis->positions.size());
    CHECK(whole->triangles.size() == axis->triangles.size());
    for (const auto& [label, volume] : volumes_mm3(*axis))
      CHECK(volumes_mm3(*whole).at(label) == doctest::Approx(volume).epsilon(1e-9));
    see_halves(file->slices);
    for (const bool fairing : {false, true}) {
      const auto halves = straight_skeleton(file->slices, {fairing, 2});
      REQUIRE_MESSAGE(halves, halves.error().message);
      const ContourSection section = section_with(file->slices, *halves);
      MESSAGE(name, ", halves: ", halves->triangles.size(), " triangles, ", section.text());
      CHECK(section.open_edges == 0);
      CHECK(section.crossings == 0);
      CHECK(section.strays == 0);
      CHECK(section.distance < 1e-9);
      CHECK(section.missing < 1e-8);  // where contours leave the view, the slice's grid moved their ends
    }
  }
}
