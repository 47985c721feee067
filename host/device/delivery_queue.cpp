#include "host/device/delivery_queue.h"

#include <algorithm>
#include <string>

namespace sonoloft::device {

bool DeliveryQueue::push(std::shared_ptr<const DeliveredSlice> slice) {
  const bool overflow = full();
  if (overflow) drop_oldest_slice();
  items_.emplace_back(std::move(slice));
  ++slices_;
  if (overflow && !overflow_told_) {
    overflow_told_ = true;
    push(Event{EventKind::slices_dropped, "the slice callback is too slow: more than " + std::to_string(capacity_) +
                                              " slices wait and the oldest are dropped; do less in the callback"});
  }
  return overflow;
}

void DeliveryQueue::drop_oldest_slice() {
  const auto oldest = std::find_if(items_.begin(), items_.end(), [](const Item& item) { return item.index() == 0; });
  items_.erase(oldest);
  --slices_;
}

std::optional<DeliveryQueue::Item> DeliveryQueue::pop() {
  if (items_.empty()) return std::nullopt;
  Item item = std::move(items_.front());
  items_.pop_front();
  if (item.index() == 0) --slices_;
  if (items_.empty()) overflow_told_ = false;
  return item;
}

}  // namespace sonoloft::device
