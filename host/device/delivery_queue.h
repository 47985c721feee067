#pragma once
#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <variant>

#include "host/device/delivered_slice.h"

namespace sonoloft::device {

/// What waits for the dispatcher, in order. Only slices count against the capacity; of events whoever adds them sees to
/// it that they are few.
/// Threads: one at a time.
class DeliveryQueue {
 public:
  using Item = std::variant<std::shared_ptr<const DeliveredSlice>, Event>;

  /// @pre capacity >= 1
  explicit DeliveryQueue(std::size_t capacity) : capacity_(capacity) {}

  [[nodiscard]] bool empty() const { return items_.empty(); }
  [[nodiscard]] bool full() const { return slices_ >= capacity_; }
  [[nodiscard]] std::size_t slices() const { return slices_; }
  [[nodiscard]] std::size_t events() const { return items_.size() - slices_; }

  /// Adds a slice; of a full queue the oldest slice gives way. The first time since the queue was last empty an event
  /// says so. @return whether a slice was dropped
  bool push(std::shared_ptr<const DeliveredSlice> slice);
  void push(Event event) { items_.emplace_back(std::move(event)); }
  [[nodiscard]] std::optional<Item> pop();

 private:
  void drop_oldest_slice();

  std::size_t capacity_;
  std::deque<Item> items_;
  std::size_t slices_ = 0;
  bool overflow_told_ = false;
};

}  // namespace sonoloft::device
