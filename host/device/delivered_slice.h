#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/slice/tracked_slice.h"
#include "host/device/clock/clock_map.h"
#include "protocol/slice.h"

namespace sonoloft::device {

using protocol::PoseStatus;

/// A slice as it came from a device, in mm. `slice.id` is the record's sequence number. Three clocks' times: that of
/// the device (`slice.time`, `pose_time`), that of the host (`arrival`), and the device's mapped to the host's.
struct DeliveredSlice {
  TrackedSlice slice;
  PoseStatus pose_status = PoseStatus::ok;  ///< anything but ok: image_to_reference is not to be used for geometry
  float pose_error_mm = 0;                  ///< the tracker's estimate, rms; 0: none
  std::chrono::nanoseconds pose_time{0};    ///< device clock, when the tracker measured
  std::chrono::steady_clock::time_point arrival;  ///< host clock, when the transfer was complete
  std::optional<HostTime> host_time;              ///< slice.time on the host's clock; empty while that is unknown
};

enum class EventKind : std::uint8_t {
  disconnected,    ///< the device went away: at most once a run, and the run's last callback
  slices_dropped,  ///< the slice callback is too slow: the oldest waiting slices are dropped; once until it caught up
  callback_threw,  ///< an exception left a callback; the message is its what()
  device_fault,    ///< the device stopped by itself; the message says why
  end_of_data,     ///< the device's source has ended and every slice of it was delivered or counted
  button,          ///< a button of the probe; see Event::button
};

/// No slice follows in this run.
[[nodiscard]] constexpr bool ends_run(EventKind kind) {
  return kind == EventKind::disconnected || kind == EventKind::device_fault || kind == EventKind::end_of_data;
}

/// A button of the probe was pressed or let go.
struct Button {
  std::uint16_t number = 0;  ///< from 0
  bool pressed = false;
  std::chrono::nanoseconds time{0};   ///< device clock
  std::optional<HostTime> host_time;  ///< the same on the host's clock; empty while that is unknown
};

struct Event {
  EventKind kind;
  std::string message;                ///< one line, cause and remedy
  std::optional<Button> button = {};  ///< iff kind is button
};

/// What a run calls. Both run on the run's dispatcher thread only, one at a time, with no lock held; every member of
/// Session may be called from them. An exception that leaves one becomes a callback_threw event. Either may be empty.
struct Callbacks {
  std::function<void(std::shared_ptr<const DeliveredSlice>)> on_slice;  ///< keep the slice as long as you like
  std::function<void(const Event&)> on_event;
};

}  // namespace sonoloft::device
