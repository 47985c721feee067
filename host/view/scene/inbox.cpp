#include "host/view/scene/inbox.h"

#include <utility>

namespace sonoloft::view {

bool Inbox::put(std::shared_ptr<const MeshUpdate> mesh) {
  const std::lock_guard lock(mutex_);
  news_.mesh = std::move(mesh);
  return std::exchange(empty_, false);
}

bool Inbox::put(std::shared_ptr<const device::DeliveredSlice> slice) {
  const std::lock_guard lock(mutex_);
  if (news_.path.size() < News::kMaxSteps)
    news_.path.push_back(slice->slice.image_to_reference.translation().cast<float>());
  news_.slice = std::move(slice);
  return std::exchange(empty_, false);
}

bool Inbox::put(ScanState state) {
  const std::lock_guard lock(mutex_);
  news_.state = std::move(state);
  return std::exchange(empty_, false);
}

bool Inbox::put(ViewRecording recording) {
  const std::lock_guard lock(mutex_);
  news_.recording = std::move(recording);
  return std::exchange(empty_, false);
}

News Inbox::take() {
  const std::lock_guard lock(mutex_);
  empty_ = true;
  return std::exchange(news_, {});
}

}  // namespace sonoloft::view
