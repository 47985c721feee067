#include "host/scan/pose_alignment.h"

#include <doctest/doctest.h>

using namespace sonoloft;
using namespace std::chrono_literals;
using device::DeliveredSlice;
using device::PoseStatus;

namespace {

const Eigen::Isometry3d kImageToProbe(Eigen::Translation3d(10, -40, 12) *
                                      Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()));

/// A probe that goes 1 mm and turns 0.01 rad a millisecond.
Eigen::Isometry3d probe_at(std::chrono::nanoseconds t) {
  const double ms = static_cast<double>(t.count()) * 1e-6;
  return Eigen::Translation3d(ms, 0, 5) * Eigen::AngleAxisd(0.01 * ms, Eigen::Vector3d(1, 2, 2) / 3);
}

PoseAlignment::Slice slice_of(std::uint64_t id, std::chrono::nanoseconds image, std::chrono::nanoseconds pose,
                              PoseStatus status = PoseStatus::ok) {
  auto slice = std::make_shared<DeliveredSlice>();
  slice->slice.id = id;
  slice->slice.time = image;
  slice->pose_time = pose;
  slice->pose_status = status;
  slice->slice.image_to_reference = probe_at(pose) * kImageToProbe;
  return slice;
}

void check_at(const DeliveredSlice& slice, std::chrono::nanoseconds time) {
  CHECK(slice.pose_status == PoseStatus::ok);
  CHECK((slice.slice.image_to_reference.matrix() - (probe_at(time) * kImageToProbe).matrix()).cwiseAbs().maxCoeff() <
        1e-9);
}

}  // namespace

TEST_CASE("alignment: an image gets the pose of its own time, once the tracker has gone past it") {
  PoseAlignment alignment(0ms, kImageToProbe);
  CHECK(alignment.push(slice_of(0, 3ms, 0ms)).empty());
  const auto ready = alignment.push(slice_of(1, 19ms, 16ms));
  REQUIRE(ready.size() == 1);
  CHECK(ready[0]->slice.id == 0);
  check_at(*ready[0], 3ms);
  CHECK(alignment.waiting() == 1);
}

TEST_CASE("alignment: the offset is the pose's time less the image's") {
  PoseAlignment alignment(-65ms, kImageToProbe);
  std::vector<PoseAlignment::Slice> ready;
  for (int i = 0; i < 10; ++i) {
    for (auto& s : alignment.push(slice_of(static_cast<std::uint64_t>(i), i * 20ms, i * 20ms))) ready.push_back(s);
  }
  REQUIRE(ready.size() == 10);  // the poses are there long before
  for (std::size_t i = 0; i < 4; ++i) CHECK(ready[i]->pose_status == PoseStatus::missing);  // before the first pose
  for (std::size_t i = 4; i < 10; ++i) check_at(*ready[i], static_cast<int>(i) * 20ms - 65ms);
}

TEST_CASE("alignment: nothing is invented across a dropout, nor after the last pose") {
  PoseAlignment alignment(5ms, kImageToProbe);
  std::vector<PoseAlignment::Slice> ready;
  for (int i = 0; i < 6; ++i) {
    const auto status = i == 2 ? PoseStatus::out_of_view : PoseStatus::ok;
    for (auto& s : alignment.push(slice_of(static_cast<std::uint64_t>(i), i * 20ms, i * 20ms, status)))
      ready.push_back(s);
  }
  for (auto& s : alignment.flush()) ready.push_back(s);
  REQUIRE(ready.size() == 6);
  CHECK(alignment.waiting() == 0);
  for (const std::size_t i : {0u, 3u, 4u}) check_at(*ready[i], static_cast<int>(i) * 20ms + 5ms);
  for (const std::size_t i : {1u, 2u, 5u}) CHECK(ready[i]->pose_status != PoseStatus::ok);
}

TEST_CASE("alignment: of a tracker whose clock stands still slices do not pile up") {
  PoseAlignment alignment(0ms, kImageToProbe);
  std::size_t ready = 0;
  for (int i = 0; i < 1000; ++i)
    ready += alignment.push(slice_of(static_cast<std::uint64_t>(i), i * 20ms, -1ms)).size();
  CHECK(alignment.waiting() <= 256);
  CHECK(ready + alignment.waiting() == 1000);
}
