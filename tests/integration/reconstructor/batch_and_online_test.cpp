#include <doctest/doctest.h>

#include <cstring>

#include "core/reconstructor/reconstructor.h"
#include "tests/support/recorded_slices.h"

using namespace sonoloft;

namespace {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_bytes(const IndexedMesh& a, const IndexedMesh& b) {
  return same_bytes(a.positions, b.positions) && same_bytes(a.triangles, b.triangles) &&
         same_bytes(a.label_front, b.label_front) && same_bytes(a.label_back, b.label_back);
}

IndexedMesh reconstruct(const std::vector<TrackedSlice>& slices, bool online, int threads, DeviceChoice device) {
  auto options = options_for(slices, 6);
  REQUIRE(options);
  options->device = device;
  options->threads = threads;
  auto reconstructor = Reconstructor::create(*options);
  REQUIRE(reconstructor);
  for (const TrackedSlice& slice : slices) {
    REQUIRE(reconstructor->add(slice));
    if (online) REQUIRE(reconstructor->update());
  }
  if (!online) REQUIRE(reconstructor->update());
  return reconstructor->mesh().indexed();
}

}  // namespace

TEST_CASE("reconstructor: slices inserted one by one end in the batch's mesh, byte for byte, with 1 or 2 threads") {
  for (const std::string name : test::kRecordedSlices) {
    const auto file = test::read_recorded_slices(name);
    if (!file) continue;
    CAPTURE(name);
    const IndexedMesh batch = reconstruct(file->slices, false, 1, DeviceChoice::cpu);
    CHECK(batch.triangles.size() > 1000);
    CHECK(same_bytes(batch, reconstruct(file->slices, true, 2, DeviceChoice::cpu)));
    CHECK(same_bytes(batch, reconstruct(file->slices, false, 2, DeviceChoice::cpu)));
  }
}
