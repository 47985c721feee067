#pragma once
#include <functional>
#include <memory>
#include <string>

#include "core/slice/result.h"

namespace sonoloft::device {

/// A probe that was plugged in or out.
struct UsbPlugEvent {
  bool arrived;
  std::string location;  ///< as in UsbDeviceInfo
};

/// Tells of probes that come and go, without opening them. Those that are there at the start are told, too.
/// Threads: the callback runs on a thread of the monitor's, one call at a time, and may call everything but the
/// monitor's destructor. A probe that has just arrived may need a moment until it may be opened.
class UsbMonitor {
 public:
  using Callback = std::function<void(const UsbPlugEvent&)>;

  /// @error io_failed (no USB here), not_available (this system does not tell)
  [[nodiscard]] static Result<std::unique_ptr<UsbMonitor>> start(Callback callback);
  /// Waits for a callback that runs; none runs afterwards.
  ~UsbMonitor();
  UsbMonitor(const UsbMonitor&) = delete;
  UsbMonitor& operator=(const UsbMonitor&) = delete;

 private:
  struct State;
  explicit UsbMonitor(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace sonoloft::device
