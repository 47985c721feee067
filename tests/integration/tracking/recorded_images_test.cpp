#include <doctest/doctest.h>

#include <string>

#include "core/reconstructor/reconstructor.h"
#include "core/segmentation/sequence_slices.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/recorded_sets.h"

using namespace sonoloft;
using sonoloft::test::recorded_set;

namespace {

/// Around the corners of all images.
Eigen::AlignedBox3d swept(const std::vector<TrackedSlice>& slices) {
  Eigen::AlignedBox3d box;
  for (const TrackedSlice& slice : slices)
    for (const Eigen::Vector2d& p : slice.field_of_view)
      box.extend(slice.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0));
  return box;
}

IndexedMesh reconstructed(const std::vector<TrackedSlice>& slices) {
  const auto options = options_for(slices, 6);
  REQUIRE(options);
  auto reconstructor = Reconstructor::create(*options);
  REQUIRE(reconstructor);
  for (const TrackedSlice& slice : slices) CHECK(reconstructor->add(slice));
  REQUIRE(reconstructor->update());
  return reconstructor->mesh().indexed();
}

void check_set(const std::string& name) {
  const auto images = recorded_set("tracked/" + name + ".igs.mha");
  const auto config = recorded_set("tracked/" + name + "_config.xml");
  if (!images || !config) return;
  const auto sequence = read_tracked_sequence(*images);
  REQUIRE(sequence);
  const auto calibration = read_plus_config(*config);
  REQUIRE(calibration);
  CHECK(guess_meaning(sequence->images) == PixelMeaning::bmode);
  SequenceReading reading;
  reading.meaning = PixelMeaning::bmode;
  const auto read = slices_of(*sequence, *calibration, reading);
  REQUIRE(read);
  CHECK(read->slices.size() == 21);
  CHECK(read->without_image + read->without_pose == 0);

  const IndexedMesh mesh = reconstructed(read->slices);
  const test::MeshReport report = test::check_mesh(mesh);
  MESSAGE(name << ": " << mesh.triangles.size() << " triangles\n" << report.text());
  CHECK(report.closed_manifold());
  REQUIRE(report.labels.contains(1));
  CHECK(report.labels.at(1).volume_mm3 > 500);
  CHECK(report.labels.at(1).volume_mm3 < 30000);
  Eigen::AlignedBox3d around = swept(read->slices);
  around.min().array() -= 5;
  around.max().array() += 5;
  std::size_t outside = 0;
  for (const Eigen::Vector3f& p : mesh.positions) outside += around.contains(p.cast<double>()) ? 0 : 1;
  CHECK(outside < mesh.positions.size() / 50);
}

}  // namespace

TEST_CASE("tracked images: a bone is reconstructed from B-mode, closed") {
  check_set("BoneUltrasound_L14");
}

TEST_CASE("tracked images: so is a spine phantom") {
  check_set("SpinePhantomFreehand");
}
