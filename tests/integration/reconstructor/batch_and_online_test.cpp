#include <doctest/doctest.h>

#include "core/reconstructor/reconstructor.h"
#include "tests/support/mesh/same_bytes.h"
#include "tests/support/recorded_slices.h"

using namespace sonoloft;
using test::same_bytes;

namespace {

Reconstructor make(const std::vector<TrackedSlice>& slices, int threads, DeviceChoice device) {
  auto options = options_for(slices, 6);
  REQUIRE(options);
  options->device = device;
  options->threads = threads;
  auto reconstructor = Reconstructor::create(*options);
  REQUIRE(reconstructor);
  return std::move(*reconstructor);
}

/// @param online  the mesh is updated after every slice, in the details given in turn
IndexedMesh reconstruct(const std::vector<TrackedSlice>& slices, const std::vector<Detail>& online, int threads,
                        DeviceChoice device, Detail last = Detail::full) {
  Reconstructor reconstructor = make(slices, threads, device);
  std::size_t n = 0;
  for (const TrackedSlice& slice : slices) {
    REQUIRE(reconstructor.add(slice));
    if (!online.empty()) REQUIRE(reconstructor.update(online[n++ % online.size()]));
  }
  REQUIRE(reconstructor.update(last));
  return reconstructor.mesh().indexed();
}

const std::vector<Detail> kBatch = {}, kOnline = {Detail::full}, kMixed = {Detail::coarse, Detail::draft, Detail::full};

}  // namespace

TEST_CASE("reconstructor: slices inserted one by one end in the batch's mesh, byte for byte, with 1 or 2 threads") {
  for (const std::string name : test::kRecordedSlices) {
    const auto file = test::read_recorded_slices(name);
    if (!file) continue;
    CAPTURE(name);
    const IndexedMesh batch = reconstruct(file->slices, kBatch, 1, DeviceChoice::cpu);
    CHECK(batch.triangles.size() > 1000);
    CHECK(same_bytes(batch, reconstruct(file->slices, kOnline, 2, DeviceChoice::cpu)));
    CHECK(same_bytes(batch, reconstruct(file->slices, kBatch, 2, DeviceChoice::cpu)));
  }
}

TEST_CASE("reconstructor: coarse meshes in between leave no trace in the full one, nor full ones in the coarse one") {
  for (const std::string name : {"csl/Vetebrae.csl", "contour/mousebrain.contour"}) {
    const auto file = test::read_recorded_slices(name);
    if (!file) continue;
    CAPTURE(name);
    const IndexedMesh full = reconstruct(file->slices, kBatch, 1, DeviceChoice::cpu);
    const IndexedMesh coarse = reconstruct(file->slices, kBatch, 1, DeviceChoice::cpu, Detail::coarse);
    CHECK(same_bytes(full, reconstruct(file->slices, kMixed, 2, DeviceChoice::cpu)));
    CHECK(same_bytes(coarse, reconstruct(file->slices, kMixed, 2, DeviceChoice::cpu, Detail::coarse)));
    MESSAGE(name, ": ", full.triangles.size(), " triangles in full, ", coarse.triangles.size(), " coarse");
    CHECK(coarse.triangles.size() < full.triangles.size() / 3);
    CHECK(coarse.triangles.size() > full.triangles.size() / 6);
  }
}
