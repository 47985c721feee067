#include <doctest/doctest.h>

#include <atomic>

#include "tests/support/ball_scan.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

constexpr std::uint32_t kSlices = 20;

IndexedMesh mesh_without(const std::vector<std::shared_ptr<const MeshUpdate>>& updates, std::uint64_t gone) {
  auto batch = Reconstructor::create(ball_scan_options().reconstructor);
  REQUIRE(batch);
  for (const auto& update : updates)
    for (const SliceReport& slice : update->slices)
      if (slice.slice->slice.id != gone) REQUIRE(batch->add(slice.slice->slice));
  REQUIRE(batch->update());
  return batch->mesh().indexed();
}

}  // namespace

TEST_CASE("scan: a slice withdrawn after the last one came leaves the mesh without it, in an update of its own") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
  ScanInbox inbox;
  const auto scan = open_scan(device.port());
  REQUIRE(scan->start(inbox.callbacks()));
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  const std::size_t before = inbox.updates().size();
  REQUIRE(scan->withdraw(7));
  REQUIRE(inbox.wait_for_updates(before + 1));
  const auto unknown = scan->withdraw(7);
  REQUIRE(!unknown);
  CHECK(unknown.error().code == ErrorCode::invalid_argument);
  scan->stop();
  const auto updates = inbox.updates();
  CHECK(updates.size() == before + 1);
  CHECK(updates.back()->slices.empty());
  CHECK(updates.back()->revision == kSlices);
  const IndexedMesh mesh = updates.back()->mesh.indexed(), expected = mesh_without(updates, 7);
  CHECK(mesh.positions == expected.positions);
  CHECK(mesh.triangles == expected.triangles);
}

TEST_CASE("scan: coverage, confidence and withdraw may be called in callbacks and beside them") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
  std::atomic<int> sure{0}, vertices{0}, withdrawn{0};
  ScanSession* session = nullptr;
  ScanInbox inbox([&](const MeshUpdate& update) {
    for (const auto& chunk : update.mesh.chunks) {
      const Confidence confidence = session->confidence(chunk->positions);
      REQUIRE(confidence.measured.size() == chunk->positions.size());
      for (const float measured : confidence.measured) sure += measured > 0.999f;
      vertices += static_cast<int>(confidence.measured.size());
    }
    if (update.revision > 5 && withdrawn == 0) withdrawn += session->withdraw(3).has_value();
  });
  const auto scan = open_scan(device.port());
  session = scan.get();
  REQUIRE(scan->start(inbox.callbacks()));
  for (int i = 0; i < 5; ++i) (void)scan->coverage();
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  scan->stop();
  CHECK(withdrawn == 1);
  CHECK(vertices > 1000);
  CHECK(sure == vertices);  // every slice shows everything
  const Coverage coverage = scan->coverage();
  MESSAGE("seen " << coverage.seen_fraction() << " of " << coverage.volume_mm3 * 1e-3 << " ml");
  CHECK(coverage.seen_fraction() > 0.9);
  CHECK(coverage.volume_mm3 == doctest::Approx(33510).epsilon(0.1));  // the ball
}
