#pragma once
#include <array>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "device_sim/port/usb/descriptors.h"
#include "device_sim/port/usb/in_endpoint.h"
#include "device_sim/port/usb/out_endpoint.h"
#include "device_sim/port/usb/urb.h"
#include "protocol/command.h"
#include "protocol/port.h"

// firmware -> port -> [USB DEVICE] -> URBs -> USB/IP, or whatever reaches a host's USB stack

namespace sonoloft::device_sim::usb {

struct UsbIdentity {
  std::string serial;          ///< 1 to 39 printable characters, those of the firmware
  std::size_t max_record = 0;  ///< of the firmware
};

/// The device as a USB host sees it, whichever way the transfers take: descriptors, standard requests, commands over
/// endpoint 0, records, events and blocks over an endpoint each. The firmware behind the port knows nothing of USB.
///
/// Threads: one for control transfers, one for each endpoint, on which the port is called; no member waits for the port
/// but the destructor.
class UsbDevice {
 public:
  /// @pre `port` outlives the device and is used by nobody else
  UsbDevice(protocol::Port& port, const UsbIdentity& identity, const UrbSink& done);
  ~UsbDevice();
  UsbDevice(const UsbDevice&) = delete;
  UsbDevice& operator=(const UsbDevice&) = delete;

  /// Completes through the sink, some time.
  void submit(Urb urb);
  /// @return whether it was under way: then it completes never. Else its completion has been called.
  bool unlink(std::uint64_t id);
  /// What a bus reset, or the end of the host, does: URBs under way are forgotten, the device is unconfigured.
  void reset();

  [[nodiscard]] const Descriptors& descriptors() const { return descriptors_; }

 private:
  struct Answer {
    UrbStatus status;
    std::span<const std::byte> data = {};
    bool never = false;  ///< the device is silent: the transfer waits until the host gives up
  };

  void serve_control();
  Answer answer(const Urb& urb);
  Answer answer_standard(const SetupPacket& setup);
  Answer answer_vendor(const Urb& urb);
  Answer feature(const SetupPacket& setup, bool set);
  Answer status_of(const SetupPacket& setup);
  [[nodiscard]] bool halted(std::uint16_t endpoint) const;
  void halt(std::uint16_t endpoint);
  void clear_halt(std::uint16_t endpoint);
  void clear_halts();
  Answer short_answer(std::uint16_t number, std::size_t len);

  protocol::Port& port_;
  const Descriptors descriptors_;
  const UrbSink done_;
  InEndpoint stream_, events_;
  OutEndpoint blobs_;

  // The control thread's.
  std::array<std::byte, protocol::kMaxRequestLen> reply_;
  std::size_t reply_len_ = 0;  ///< 0: nothing was asked
  std::array<std::byte, 2> number_;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Urb> control_;
  std::optional<std::uint64_t> serving_;  ///< empty too when it was unlinked meanwhile
  std::vector<std::uint64_t> unanswered_;
  std::uint8_t configuration_ = 0;
  bool closing_ = false;
  std::jthread control_thread_;
};

}  // namespace sonoloft::device_sim::usb
