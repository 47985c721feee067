// What a scan delivers: meshes, counts, reasons.
#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <set>

#include "core/reconstructor/reconstructor.h"
#include "host/scan/label_statistics.h"
#include "tests/support/ball_scan.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

constexpr std::uint32_t kSlices = 24;

double ball_ml(double radius_mm) {
  return 4.0 / 3.0 * std::numbers::pi * std::pow(radius_mm, 3) * 1e-3;
}

std::vector<std::shared_ptr<const MeshUpdate>> updates_of_ball(ScanOptions options = ball_scan_options()) {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
  ScanInbox inbox;
  const auto scan = open_scan(device.port(), options);
  REQUIRE(scan->start(inbox.callbacks()));
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  scan->stop();
  CHECK(scan->ledger().closed);
  return inbox.updates();
}

bool same_bytes(const IndexedMesh& a, const IndexedMesh& b) {
  return a.positions == b.positions && a.triangles == b.triangles && a.label_front == b.label_front &&
         a.label_back == b.label_back;
}

std::size_t total(const SliceCounts& c) {
  return c.inserted + c.explained + c.merged + c.refused + c.dropped;
}

/// The volume a mesh encloses of a label and its triangles, in one pass over the joined mesh.
LabelStatistics counted(const IndexedMesh& mesh, Label label) {
  LabelStatistics s{label, 0, 0};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.label_front[t] != label && mesh.label_back[t] != label) continue;
    Eigen::Matrix3d corners;
    for (int i = 0; i < 3; ++i)
      corners.col(i) = mesh.positions[mesh.triangles[t][static_cast<std::size_t>(i)]].cast<double>();
    s.triangles += 1;
    s.volume_ml += (mesh.label_back[t] == label ? 1 : -1) * corners.determinant() / 6000;
  }
  return s;
}

}  // namespace

TEST_CASE("scan: every slice is delivered in a mesh once, in order, and the counts add up") {
  const auto updates = updates_of_ball();
  REQUIRE(!updates.empty());
  std::uint64_t id = 0, skipped = 0;
  for (const auto& update : updates) {
    REQUIRE(!update->slices.empty());
    for (const SliceReport& slice : update->slices) {
      CHECK(slice.slice->slice.id == id++);
      CHECK(slice.fate == SliceFate::inserted);
      CHECK(slice.reason.empty());
      CHECK(slice.latency_ms > 0);
      CHECK(slice.insert_ms > 0);
    }
    skipped += update->slices.size() - 1;
    CHECK(update->revision == id);
    CHECK(update->skipped_revisions == skipped);
    CHECK(update->counts.inserted == id);
    CHECK(total(update->counts) <= update->counts.delivered);
  }
  CHECK(id == kSlices);
  CHECK(updates.back()->counts == SliceCounts{kSlices, kSlices, 0, 0, 0, 0});
  MESSAGE(updates.size(), " meshes of ", kSlices, " slices");
}

TEST_CASE("scan: with poses interpolated every slice is used once, but the last, which no later pose follows") {
  ScanOptions options = ball_scan_options();
  options.pose_offset = std::chrono::microseconds(500);  // the ball's slices are 1 ms apart
  const auto updates = updates_of_ball(options);
  REQUIRE(!updates.empty());
  std::uint64_t id = 0;
  for (const auto& update : updates) {
    for (const SliceReport& slice : update->slices) {
      CHECK(slice.slice->slice.id == id++);
      CAPTURE(slice.reason);
      CHECK((slice.fate == SliceFate::refused) == (id == kSlices));
      if (id < kSlices) CHECK(slice.slice->pose_time == slice.slice->slice.time + std::chrono::microseconds(500));
    }
  }
  CHECK(updates.back()->counts.refused == 1);
  CHECK(total(updates.back()->counts) == kSlices);
}

TEST_CASE("scan: the last mesh is the one that the same slices give without a scan") {
  const auto updates = updates_of_ball();
  auto batch = Reconstructor::create(ball_scan_options().reconstructor);
  REQUIRE(batch);
  for (const auto& update : updates)
    for (const SliceReport& slice : update->slices) REQUIRE(batch->add(slice.slice->slice));
  REQUIRE(batch->update());
  const IndexedMesh mesh = updates.back()->mesh.indexed();
  CHECK(mesh.triangles.size() > 1000);
  CHECK(same_bytes(mesh, batch->mesh().indexed()));
  CHECK(updates.back()->size.triangles == mesh.triangles.size());
}

TEST_CASE("scan: label statistics are those of the joined mesh, and the volumes those of the balls") {
  const auto updates = updates_of_ball();
  for (const auto& update : updates) {
    const IndexedMesh mesh = update->mesh.indexed();
    for (const LabelStatistics& s : update->labels) {
      const LabelStatistics expected = counted(mesh, s.label);
      CHECK(s.triangles == expected.triangles);
      CHECK(s.volume_ml == doctest::Approx(expected.volume_ml).epsilon(1e-6));
    }
  }
  const auto& labels = updates.back()->labels;
  REQUIRE(labels.size() == 2);
  CHECK(labels[0].label == 1);
  CHECK(labels[1].label == 2);
  const double shell_ml = ball_ml(kBallRadius_mm) - ball_ml(kCoreRadius_mm);
  MESSAGE("shell ", labels[0].volume_ml, " of ", shell_ml, " ml, core ", labels[1].volume_ml, " of ",
          ball_ml(kCoreRadius_mm));
  CHECK(labels[0].volume_ml == doctest::Approx(shell_ml).epsilon(0.05));
  CHECK(labels[1].volume_ml == doctest::Approx(ball_ml(kCoreRadius_mm)).epsilon(0.1));
}

TEST_CASE("scan: chunks that are not named as changed are those of the mesh before") {
  const auto updates = updates_of_ball();
  std::size_t kept = 0;
  for (std::size_t i = 1; i < updates.size(); ++i) {
    std::set<BrickCoord> changed(updates[i]->changed_chunks.begin(), updates[i]->changed_chunks.end());
    std::set<std::shared_ptr<const MeshChunk>> before(updates[i - 1]->mesh.chunks.begin(),
                                                      updates[i - 1]->mesh.chunks.end());
    for (const auto& chunk : updates[i]->mesh.chunks) {
      if (changed.contains(chunk->coord)) continue;
      CHECK(before.contains(chunk));
      ++kept;
    }
  }
  CHECK(kept > 0);
  MESSAGE(kept, " chunks were shared in ", updates.size(), " meshes");
}

TEST_CASE("scan: a mesh that is kept stays as it was, after all later ones and after the scan is gone") {
  std::vector<IndexedMesh> copies;
  ScanInbox inbox([&](const MeshUpdate& update) { copies.push_back(update.mesh.indexed()); });
  {
    device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
    const auto scan = open_scan(device.port());
    REQUIRE(scan->start(inbox.callbacks()));
    REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  }
  const auto updates = inbox.updates();
  REQUIRE(updates.size() == copies.size());
  for (std::size_t i = 0; i < copies.size(); ++i) CHECK(same_bytes(updates[i]->mesh.indexed(), copies[i]));
}

TEST_CASE("scan: a slice that shows what is known already is explained, and changes nothing") {
  const auto change = [](std::uint32_t i, OwnedWireSlice& slice) {
    if (i % 3 != 0) return;
    slice.contours.clear();  // nothing but outside, far from the ball
    slice.points.clear();
    slice.slice.pose = ball_slice(0, kSlices).slice.pose;
    slice.slice.pose.tz_mm = 40 + i;
  };
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices, false, change));
  ScanInbox inbox;
  const auto scan = open_scan(device.port());
  REQUIRE(scan->start(inbox.callbacks()));
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  scan->stop();
  CHECK(scan->counts().explained == 7);  // of ids 0, 3 ... 21 all but that at 61 mm, outside of the box
  CHECK(scan->counts().refused == 1);
  CHECK(scan->counts().inserted == kSlices - 8);
  for (const auto& update : inbox.updates())
    for (const SliceReport& slice : update->slices)
      CHECK((slice.fate == SliceFate::inserted) == (slice.slice->slice.id % 3 != 0));
}

TEST_CASE("scan: slices without a sound pose and slices without sense are refused, with the reason") {
  const auto change = [](std::uint32_t i, OwnedWireSlice& slice) {
    if (i == 1) slice.slice.pose.status = protocol::PoseStatus::missing;
    if (i == 2) slice.slice.pose.status = protocol::PoseStatus::out_of_view;
    if (i == 3) slice.slice.pose.status = protocol::PoseStatus::out_of_volume;
    if (i == 4) slice.slice.pose.status = protocol::PoseStatus::high_error;
    if (i == 5) slice.slice.pose.status = protocol::PoseStatus::invalid;
    if (i == 6) slice.slice.pose.tz_mm = 1000;   // not in the box
    if (i == 8) slice = ball_slice(0, kSlices);  // once more
  };
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices, false, change));
  ScanInbox inbox;
  const auto scan = open_scan(device.port());
  REQUIRE(scan->start(inbox.callbacks()));
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  scan->stop();

  CHECK(scan->counts() == SliceCounts{kSlices, kSlices - 7, 0, 1, 6, 0});
  std::set<std::string> reasons;
  for (const auto& update : inbox.updates()) {
    for (const SliceReport& slice : update->slices) {
      CHECK(slice.reason.empty() == (slice.fate != SliceFate::refused));
      if (slice.fate == SliceFate::refused) reasons.insert(slice.reason);
      if (slice.slice->slice.id == 8) CHECK(slice.fate == SliceFate::merged);
    }
  }
  CHECK(reasons.size() == 6);
  for (const std::string& reason : reasons) MESSAGE(reason);
}

TEST_CASE("statistics: a chunk that vanishes takes its triangles and its volume with it") {
  const auto box_chunk = [](BrickCoord coord, float x, float size, Label label) {
    auto chunk = std::make_shared<MeshChunk>();
    chunk->coord = coord;
    chunk->positions = {{x, 0, 0}, {x + size, 0, 0}, {x, size, 0}, {x, 0, size}};
    chunk->triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    chunk->label_front.assign(4, kOutside);
    chunk->label_back.assign(4, label);
    return chunk;
  };
  const auto a = box_chunk({0, 0, 0}, 0, 30, 1), b = box_chunk({1, 0, 0}, 500, 60, 7);
  LabelStatisticsKeeper keeper({1000, -2000, 300});
  const BrickCoord both[] = {{0, 0, 0}, {1, 0, 0}};
  auto labels = keeper.update({{a, b}}, both);
  REQUIRE(labels.size() == 2);
  CHECK(labels[0].volume_ml == doctest::Approx(4.5));
  CHECK(labels[1].volume_ml == doctest::Approx(36));
  labels = keeper.update({{a}}, std::span(both).subspan(1));
  REQUIRE(labels.size() == 1);
  CHECK(labels[0].label == 1);
  CHECK(labels[0].triangles == 4);
  labels = keeper.update({{box_chunk({0, 0, 0}, 0, 30, 3)}}, std::span(both).first(1));
  REQUIRE(labels.size() == 1);
  CHECK(labels[0].label == 3);
}

TEST_CASE("scan: slices that come faster than full meshes get coarser ones, and a full one when they pause") {
  auto options = ball_scan_options();
  options.reconstructor.spacing_mm = 0.5;  // a full mesh takes longer than the millisecond between two slices
  options.stream.mode = device::StreamMode::live;
  auto device_options = ball_device_options();
  device_options.rate_hz = 1000;
  std::atomic<bool> paused = false;
  const auto pause = [&](std::uint32_t, OwnedWireSlice&) { paused.wait(true); };
  device_sim::LoopbackDevice device(device_options, ball_source(kSlices, true, pause));
  ScanInbox inbox;
  const auto scan = open_scan(device.port(), options);
  REQUIRE(scan->start(inbox.callbacks()));
  CHECK(inbox.wait_for_full(false));
  paused = true;
  CHECK(inbox.wait_for_full(true));
  paused = false;
  paused.notify_all();
  scan->stop();

  const auto updates = inbox.updates();
  std::size_t coarse = 0;
  for (std::size_t i = 1; i < updates.size(); ++i) {
    coarse += updates[i]->detail != Detail::full ? 1 : 0;
    CHECK(updates[i]->revision == updates[i - 1]->revision + updates[i]->slices.size());
    if (updates[i]->detail == updates[i - 1]->detail) continue;
    std::set<BrickCoord> all;
    for (const auto& update : {updates[i - 1], updates[i]})
      for (const auto& chunk : update->mesh.chunks) all.insert(chunk->coord);
    CHECK(std::vector<BrickCoord>(all.begin(), all.end()) == updates[i]->changed_chunks);
  }
  CHECK(coarse > 0);
}

TEST_CASE("scan: a live scan ends with a full mesh of all its slices") {
  auto options = ball_scan_options();
  options.stream.mode = device::StreamMode::live;
  options.queue_capacity = kSlices;
  auto device_options = ball_device_options();
  device_options.rate_hz = 1000;
  device_sim::LoopbackDevice device(device_options, ball_source(kSlices));
  ScanInbox inbox;
  const auto scan = open_scan(device.port(), options);
  REQUIRE(scan->start(inbox.callbacks()));
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  scan->stop();
  CHECK(inbox.updates().back()->detail == Detail::full);
  CHECK(inbox.updates().back()->revision == scan->counts().delivered - scan->counts().dropped);
}
