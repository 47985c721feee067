#include <doctest/doctest.h>

#include "core/methods/medial_axis/medial_axis.h"
#include "tests/support/mesh/contour_section.h"
#include "tests/support/recorded_slices.h"

using namespace sonoloft;
using namespace sonoloft::test;

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
