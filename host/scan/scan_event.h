#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "host/device/delivered_slice.h"

namespace sonoloft {

enum class ScanEventKind : std::uint8_t {
  disconnected,           ///< the device went away: at most once a run, and the run's last callback
  device_fault,           ///< the device stopped by itself; the message says why
  slices_dropped,         ///< slices come faster than they are used: the oldest give way; once until it caught up
  callback_threw,         ///< an exception left on_mesh or on_slice; the message has its what()
  reconstruction_failed,  ///< the mesh cannot be brought up to date: the run ends with this callback
  end_of_data,            ///< the device's source has ended and the mesh of its last slice was delivered
  button,                 ///< a button of the probe; see ScanEvent::button
};

/// No mesh of a new slice follows in this run.
[[nodiscard]] constexpr bool ends_run(ScanEventKind kind) {
  return kind == ScanEventKind::disconnected || kind == ScanEventKind::device_fault ||
         kind == ScanEventKind::reconstruction_failed || kind == ScanEventKind::end_of_data;
}

struct ScanEvent {
  ScanEventKind kind;
  std::string message;                        ///< one line, cause and remedy
  std::optional<device::Button> button = {};  ///< iff kind is button
};

}  // namespace sonoloft
