#pragma once
#include <atomic>
#include <memory>
#include <optional>
#include <thread>

#include "tests/support/wire/loopback_bench.h"

namespace sonoloft::test {

/// Slices that tell by their time which they are, and small ones: make_numbered(n) is the n-th.
inline OwnedWireSlice make_numbered(std::uint64_t number) {
  OwnedWireSlice slice = make_wire_slice(static_cast<std::uint32_t>(number), 2, 12);
  slice.slice.time_ns = number;
  return slice;
}

/// A source of `count` of them.
inline device_sim::SliceSource numbered_small_slices(std::uint64_t count) {
  auto current = std::make_shared<OwnedWireSlice>();
  return [current, count, next = std::uint64_t{0}]() mutable -> const device_sim::AcquiredSlice* {
    if (next == count) return nullptr;
    *current = make_numbered(next++);
    return &current->view();
  };
}

/// The same; from the `first`-th on they wait for `open`.
inline device_sim::SliceSource gated_slices(std::uint64_t count, std::uint64_t first,
                                            std::shared_ptr<const std::atomic<bool>> open) {
  return [=, next = std::uint64_t{0}, slices = numbered_small_slices(count)]() mutable {
    while (next >= first && !*open) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ++next;
    return slices();
  };
}

inline bool same(const device::DeliveredSlice& a, const device::DeliveredSlice& b) {
  const auto same_contour = [](const Contour& c, const Contour& d) {
    return c.first == d.first && c.count == d.count && c.label == d.label && c.hole == d.hole;
  };
  return a.slice.points == b.slice.points && a.slice.field_of_view == b.slice.field_of_view &&
         std::equal(a.slice.contours.begin(), a.slice.contours.end(), b.slice.contours.begin(), b.slice.contours.end(),
                    same_contour) &&
         a.slice.image_to_reference.matrix() == b.slice.image_to_reference.matrix() && a.slice.time == b.slice.time &&
         a.pose_status == b.pose_status && a.pose_time == b.pose_time && a.pose_error_mm == b.pose_error_mm;
}

/// Compares every delivered slice with the one that was sent, on the thread that delivers. Read it when stopped.
class Witness {
 public:
  explicit Witness(const device::Calibration& calibration) : calibration_(calibration) {}

  device::Callbacks callbacks() {
    return {[this](auto slice) { look_at(*slice); }, [this](const device::Event& event) { look_at(event); }};
  }

  std::atomic<std::uint64_t> delivered = 0;
  std::uint64_t wrong = 0;                      ///< altered, never sent, or out of order
  std::atomic<std::uint64_t> disconnected = 0;  ///< events
  std::uint64_t after_the_end = 0;              ///< callbacks after disconnected

 private:
  void look_at(const device::DeliveredSlice& slice) {
    ++delivered;
    after_the_end += disconnected;
    const auto number = static_cast<std::uint64_t>(slice.slice.time.count());
    auto sent = make_numbered(number);
    const auto expected = device::to_delivered(sent.view(), slice.slice.id, calibration_, slice.arrival);
    const bool in_order = (!last_id_ || slice.slice.id > *last_id_) && (!last_number_ || number > *last_number_);
    wrong += !in_order || !same(slice, expected);
    last_id_ = slice.slice.id;
    last_number_ = number;
  }
  void look_at(const device::Event& event) { disconnected += event.kind == device::EventKind::disconnected; }

  device::Calibration calibration_;
  std::optional<std::uint64_t> last_id_, last_number_;
};

}  // namespace sonoloft::test
