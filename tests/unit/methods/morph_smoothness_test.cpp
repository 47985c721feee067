#include <doctest/doctest.h>

#include <numeric>

#include "core/methods/equal_importance/contour_blend.h"
#include "core/methods/metamorphosis/contour_morph.h"
#include "tests/support/stacks/slice_crease.h"
#include "tests/support/stacks/stack_slices.h"

using namespace sonoloft;
using namespace sonoloft::test;

TEST_CASE("metamorphosis: the surface runs through slices without a crease where the linear morph has one") {
  std::vector<TrackedSlice> slices;
  for (const double radius : {8.0, 13.0, 15.0, 12.0, 11.0, 16.0})
    slices.push_back(
        slice_at(7 * static_cast<double>(slices.size()), {ellipse({radius / 5, 0}, radius, 0.8 * radius)}));
  const auto stack = make_stack(slices, "test");
  const auto chart = chart_of(slices, "test");
  REQUIRE(stack);
  REQUIRE(chart);
  const auto mean = [&](const LayeredField& field) {
    const std::vector<double> creases = creases_deg(field, *stack);
    return std::accumulate(creases.begin(), creases.end(), 0.0) / static_cast<double>(creases.size());
  };
  const double smooth = mean(ContourMorph(*stack, {0.5, StackEnds::round, 1})),
               linear = mean(ContourBlend(*chart, {0.5}));
  MESSAGE("mean crease ", smooth, " degrees, of the linear morph ", linear);
  CHECK(smooth < 2);
  CHECK(linear > 10);
}
