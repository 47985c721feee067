// Guiding patches: small slices drawn by the user, of any shape, that say what lies between the slices scanned. After
// section 7 of Barequet, Vaxman 2009.
#include <doctest/doctest.h>

#include "core/reconstructor/reconstructor.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/view_slices.h"

using namespace sonoloft;
using Eigen::Vector2d;

namespace {

TrackedSlice slice(std::uint64_t id, double height_mm, const std::vector<Vector2d>& disc) {
  TrackedSlice s;
  s.id = id;
  s.image_to_reference.translation().z() = height_mm;
  if (!disc.empty()) test::add_contour(s, disc, 1);
  return s;
}

/// Slices 10 mm apart of which two show a disc, the upper one `shift_mm` beside the lower.
std::vector<TrackedSlice> two_discs(double shift_mm) {
  return {slice(0, -10, {}), slice(1, 0, test::ring({-shift_mm / 2, 0}, 8, 48)),
          slice(2, 10, test::ring({shift_mm / 2, 0}, 8, 48)), slice(3, 20, {})};
}

Reconstructor reconstructor_of(std::span<const TrackedSlice> slices) {
  ReconstructorOptions options = options_for(slices, 6).value();
  Reconstructor reconstructor = Reconstructor::create(options).value();
  for (const TrackedSlice& s : slices) REQUIRE(reconstructor.add(s));
  return reconstructor;
}

std::size_t pieces(Reconstructor& reconstructor) {
  REQUIRE(reconstructor.update());
  test::MeshReport report = test::check_mesh(reconstructor.mesh().indexed());
  CHECK(report.closed_manifold());
  return report.labels[1].components;
}

}  // namespace

TEST_CASE("patch: a bridge drawn upright between two discs that do not overlap joins them; withdrawn, it does not") {
  const std::vector<TrackedSlice> scanned = two_discs(24);
  Reconstructor reconstructor = reconstructor_of(scanned);
  CHECK(pieces(reconstructor) == 2);

  TrackedSlice patch;
  patch.id = 7;
  patch.image_to_reference = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX());  // y is up
  // An S: from within one disc to within the other; all of it is material.
  patch.field_of_view = {{-18, -1}, {-6, -1}, {-6, 3}, {18, 3}, {18, 11}, {6, 11}, {6, 7}, {-18, 7}};
  test::add_contour(patch, patch.field_of_view, 1);
  REQUIRE(reconstructor.add(patch));
  CHECK(pieces(reconstructor) == 1);

  REQUIRE(reconstructor.withdraw(7));
  CHECK(pieces(reconstructor) == 2);
}

TEST_CASE("patch: a lid drawn between two discs that overlap parts them, whatever its shape") {
  const std::vector<TrackedSlice> scanned = two_discs(4);
  Reconstructor reconstructor = reconstructor_of(scanned);
  CHECK(pieces(reconstructor) == 1);
  TrackedSlice patch = slice(7, 5, {});
  for (int i = 0; i < 12; ++i)  // a star
    patch.field_of_view.push_back(test::ring({0, 0}, i % 2 == 0 ? 20 : 14, 12)[static_cast<std::size_t>(i)]);
  REQUIRE(reconstructor.add(patch));
  CHECK(pieces(reconstructor) == 2);
}
