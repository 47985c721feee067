#include "host/scan/pose_alignment.h"

#include <utility>

namespace sonoloft {
namespace {

constexpr std::size_t kMostWaiting = 256;  // when a tracker's clock stands still slices are not to pile up

}  // namespace

std::vector<PoseAlignment::Slice> PoseAlignment::push(Slice slice) {
  std::optional<Eigen::Isometry3d> probe;
  if (slice->pose_status == device::PoseStatus::ok) {
    probe = slice->slice.image_to_reference * image_to_probe_.inverse();
  }
  track_.add(slice->pose_time, std::move(probe));
  waiting_.push_back(std::move(slice));

  std::vector<Slice> ready;
  while (!waiting_.empty()) {
    const auto wanted = waiting_.front()->slice.time + offset_;
    if (wanted > track_.newest() && waiting_.size() <= kMostWaiting) break;
    ready.push_back(aligned(*waiting_.front()));
    waiting_.pop_front();
    track_.forget_before(wanted);
  }
  return ready;
}

std::vector<PoseAlignment::Slice> PoseAlignment::flush() {
  std::vector<Slice> rest;
  for (const Slice& slice : std::exchange(waiting_, {})) rest.push_back(aligned(*slice));
  return rest;
}

PoseAlignment::Slice PoseAlignment::aligned(const device::DeliveredSlice& slice) const {
  auto result = std::make_shared<device::DeliveredSlice>(slice);
  const auto wanted = slice.slice.time + offset_;
  if (const auto probe = track_.at(wanted)) {
    result->slice.image_to_reference = *probe * image_to_probe_;
    result->pose_status = device::PoseStatus::ok;
    result->pose_time = wanted;
  } else if (result->pose_status == device::PoseStatus::ok) {
    result->pose_status = device::PoseStatus::missing;
  }
  return result;
}

}  // namespace sonoloft
